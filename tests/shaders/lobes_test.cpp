#include "estara/shaders/lobes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>

#include "estara/shaders/bump.h"
#include "reference.h"
#include "sampling.h"
#include "view.h"

namespace estara {
namespace {

constexpr glm::vec3 up{0.0f, 0.0f, 1.0f};

/// A unit vector `angle` radians away from up.
glm::vec3 tilted(float angle) { return {std::sin(angle), 0.0f, std::cos(angle)}; }

glm::vec3 highlight(const glm::vec3& N, const glm::vec3& V, const glm::vec3& L, float roughness) {
    const std::array light{Light{L, glm::vec3(1.0f, 0.5f, 0.25f)}};
    return specular(test::seen(N, V, light), roughness);
}

void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance);
}

TEST(Specular, IsTheCosineOfTheHalfVectorToThePowerEightByRoughness) {
    for (const float roughness : {0.01f, 0.1f, 0.3f, 1.0f}) {
        for (int i = 0; i < 12; ++i) {
            const float light = 0.1f * float(i), eye = -0.03f * float(i), half = (light + eye) / 2;
            const double lobe = std::pow(std::cos(double(half)), 8.0 / double(roughness));
            // A rounding of the cosine is amplified by the exponent, at most 800.
            const float tolerance = 2e-7f * 8.0f / roughness;
            expect_near(highlight(up, tilted(eye), tilted(light), roughness),
                        glm::vec3(1.0f, 0.5f, 0.25f) * float(lobe), tolerance);
        }
    }
}

TEST(Specular, IsFullWhereTheEyeLooksAlongTheReflectedLight) {
    expect_near(highlight(up, tilted(-0.7f), tilted(0.7f), 0.001f), {1.0f, 0.5f, 0.25f}, 2e-3f);
}

TEST(Specular, IsTheSameWhenEyeAndLightChangePlaces) {
    test::Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 N = random.direction(), V = random.direction(), L = random.direction();
        EXPECT_EQ(highlight(N, V, L, 0.2f), highlight(N, L, V, 0.2f));
    }
}

TEST(Specular, IsNothingForALightStraightBehindTheEye) {
    test::Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 V = random.direction();
        EXPECT_EQ(highlight(random.direction(), V, -V, 0.1f), glm::vec3(0.0f));
    }
}

TEST(Specular, IsFiniteForALightNearlyBehindTheEye) {
    test::Random random(3);
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 N = random.direction(), V = random.direction();
        const glm::vec3 away = -V + random.direction() * std::exp2(random.within(-30.0f, 0.0f));
        const glm::vec3 sum = highlight(N, V, away / std::sqrt(glm::dot(away, away)), 0.001f);
        ASSERT_TRUE(sum.x >= 0.0f && sum.x < 1.001f) << sum.x;
    }
}

TEST(Specular, IsNothingWhereTheHalfVectorPointsIntoTheSurface) {
    EXPECT_EQ(highlight(-up, tilted(0.2f), tilted(-0.1f), 0.5f), glm::vec3(0.0f));
}

TEST(Specular, AddsUpOverTheLights) {
    const std::array lights{Light{tilted(0.3f), glm::vec3(1.0f, 0.0f, 0.0f)},
                            Light{tilted(-0.2f), glm::vec3(0.0f, 1.0f, 0.5f)}};
    const std::span<const Light> both(lights);
    const glm::vec3 V = tilted(0.1f);
    EXPECT_EQ(specular(test::seen(up, V, both), 0.2f),
              specular(test::seen(up, V, both.first(1)), 0.2f) +
                  specular(test::seen(up, V, both.last(1)), 0.2f));
    EXPECT_EQ(specular(test::seen(up, V, {}), 0.2f), glm::vec3(0.0f));
}

TEST(Matte, IsTheColourTimesAmbientAndDiffuseLight) {
    const std::array light{Light{tilted(1.0f), glm::vec3(2.0f)}};
    const Seen seen = test::seen(up, up, light);
    const float cosine = std::cos(1.0f);
    expect_near(
        matte({0.5f, 0.2f, 0.1f}, 0.4f, 0.6f, seen),
        {0.5f * (0.4f * 0.3f + 0.6f * 2.0f * cosine), 0.2f * (0.4f * 0.2f + 0.6f * 2.0f * cosine),
         0.1f * (0.4f * 0.1f + 0.6f * 2.0f * cosine)},
        1e-6f);
}

TEST(PlasticClosing, IsMatteAndAHighlightOfItsOwnColour) {
    const std::array light{Light{tilted(0.3f), glm::vec3(1.0f)}};
    const Seen seen = test::seen(up, tilted(-0.2f), light);
    const glm::vec3 Cd(0.5f, 0.2f, 0.1f), specularcolor(0.9f, 0.8f, 0.7f);
    EXPECT_EQ(plastic(Cd, 0.1f, 0.6f, 0.4f, 0.1f, specularcolor, seen),
              matte(Cd, 0.1f, 0.6f, seen) + specularcolor * 0.4f * specular(seen, 0.1f));
    EXPECT_EQ(plastic(Cd, 0.1f, 0.6f, 0.0f, 0.1f, specularcolor, seen),
              matte(Cd, 0.1f, 0.6f, seen));
}

constexpr double pi = 3.14159265358979323846;

/// The mean of f over directions of the upper half sphere, or of the whole one.
template <class F>
double sphere_average(F f, double from_cosine) {
    const int rows = 400, columns = 400;
    double sum = 0;
    for (int i = 0; i < rows; ++i) {
        const double z = from_cosine + (1 - from_cosine) * (i + 0.5) / rows;
        const double r = std::sqrt(1 - z * z);
        for (int k = 0; k < columns; ++k) {
            const double phi = 2 * pi * (k + 0.5) / columns;
            sum += f(glm::vec3(r * std::cos(phi), r * std::sin(phi), z));
        }
    }
    return sum / (rows * columns);
}

/// A random unit vector on N's side.
glm::vec3 above(const glm::vec3& N, test::Random& random) {
    const glm::vec3 d = random.direction();
    return glm::dot(d, N) < 0.0f ? -d : d;
}

TEST(HalfVector, IsNothingBetweenOppositeVectors) {
    test::Random random(10);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 a = random.direction(), b = random.direction();
        EXPECT_EQ(half_vector(a, -a), glm::vec3(0.0f));
        expect_near(half_vector(a, b), glm::normalize(a + b), 1e-4f);
    }
}

TEST(FresnelTerm, IsTheReference) {
    test::Random random(11);
    for (int i = 0; i < 100000; ++i) {
        const glm::vec3 N = random.direction(), I = -above(N, random);
        const float eta = std::exp2(random.within(-2.0f, 2.0f));
        const reference::Fresnel exact = reference::fresnel(I, N, double(eta));
        const Fresnel f = fresnel(I, N, eta);
        // Near total reflection G is the root of a difference.
        const double c = -glm::dot(glm::dvec3(I), glm::dvec3(N));
        const double G2 = 1 / (double(eta) * eta) - 1 + c * c;
        if (std::abs(G2) < 1e-3) continue;
        ASSERT_NEAR(f.Kr, exact.Kr, 2e-5) << c << " " << eta;
        ASSERT_EQ(f.Kt, 1.0f - f.Kr);
        for (int k = 0; k < 3; ++k) ASSERT_NEAR(f.T[k], exact.T[k], 5e-5) << c << " " << eta;
    }
}

TEST(FresnelTerm, HasTheTextbooksAngles) {
    const glm::vec3 down(0.0f, 0.0f, -1.0f);
    for (const float n : {1.01f, 1.33f, 1.5f, 2.4f}) {
        const float straight = (n - 1) / (n + 1);
        EXPECT_NEAR(fresnel(down, up, 1 / n).Kr, straight * straight, 1e-6f);
        EXPECT_NEAR(fresnel(down, up, n).Kr, straight * straight, 1e-6f);
        EXPECT_NEAR(fresnel({1, 0, 0}, up, 1 / n).Kr, 1.0f, 1e-6f);  // along the surface
        // Of Brewster's angle, half of the light that is reflected is missing.
        const float brewster = std::atan(n), behind = std::asin(std::sin(brewster) / n);
        const float rs = std::sin(brewster - behind) / std::sin(brewster + behind);
        EXPECT_NEAR(fresnel(-tilted(brewster), up, 1 / n).Kr, rs * rs / 2, 1e-5f);
        // From inside, all of it beyond the critical angle.
        const float critical = std::asin(1 / n);
        const Fresnel total = fresnel(-tilted(critical + 0.01f), up, n);
        EXPECT_EQ(total.Kr, 1.0f);
        EXPECT_EQ(total.Kt, 0.0f);
        EXPECT_EQ(total.T, glm::vec3(0.0f));
        EXPECT_LT(fresnel(-tilted(critical - 0.01f), up, n).Kr, 1.0f);
    }
}

TEST(FresnelTerm, BendsBySnellsLawAndIsTheSameFromBehind) {
    test::Random random(12);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 N = random.direction(), I = -above(N, random);
        const float eta = random.within(0.3f, 1.0f);
        const Fresnel f = fresnel(I, N, eta);
        ASSERT_NEAR(glm::length(f.T), 1.0f, 1e-5f);
        ASSERT_LT(glm::dot(f.T, N), 0.0f);
        for (int c = 0; c < 3; ++c) {
            ASSERT_NEAR(glm::cross(f.T, N)[c], eta * glm::cross(I, N)[c], 1e-5f);
        }
        if (glm::dot(I, N) > -0.05f) continue;  // Kr is steep there
        ASSERT_NEAR(fresnel(-f.T, -N, 1 / eta).Kr, f.Kr, 1e-3f);
    }
}

TEST(FresnelTerm, IsFiniteAlongTheSurfaceAndWithoutABoundary) {
    test::Random random(13);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 N = random.direction();
        glm::vec3 I = random.direction();  // also from the wrong side
        if (i % 2 == 0) I = tangent_along(I, N);
        for (const float eta : {0.25f, 0.99f, 1.0f, 1.01f, 4.0f}) {
            const Fresnel f = fresnel(I, N, eta);
            ASSERT_TRUE(f.Kr >= 0.0f && f.Kr <= 1.0f) << f.Kr;
            ASSERT_TRUE(glm::length(f.T) < 10.0f);
        }
        EXPECT_NEAR(fresnel(I, N, 1.0f).Kr, 0.0f, 1e-6f);
    }
}

TEST(HenyeyGreenstein, IsTheReferenceWithMeanOneAndMeanCosineG) {
    for (const float g : {-0.7f, 0.0f, 0.3f, 0.8f}) {
        const double mean =
            sphere_average([&](const glm::vec3& d) { return henyey_greenstein(d.z, g); }, -1.0);
        const double cosine = sphere_average(
            [&](const glm::vec3& d) { return d.z * henyey_greenstein(d.z, g); }, -1.0);
        EXPECT_NEAR(mean, 1.0, 2e-3) << g;  // the midpoint rule misses as much of the peak
        EXPECT_NEAR(cosine, g, 2e-3) << g;
        for (int i = 0; i <= 200; ++i) {
            const float c = -1.0f + 0.01f * float(i);
            const double exact = reference::henyey_greenstein(std::min(1.0f, c), g);
            ASSERT_NEAR(henyey_greenstein(c, g), exact, 1e-5 * exact) << g << " " << c;
        }
    }
    EXPECT_EQ(henyey_greenstein(1.001f, 0.8f), henyey_greenstein(1.0f, 0.8f));
}

TEST(SingleScatter, IsTheReferenceAndTheSameBothWays) {
    test::Random random(14);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 N = random.direction();
        const glm::vec3 wi = -above(N, random), wo = -above(N, random);
        if (glm::dot(wi, N) > -1e-3f || glm::dot(wo, N) > -1e-3f) continue;
        const float g = random.within(-0.8f, 0.8f), d = std::exp2(random.within(-4.0f, 4.0f));
        const double exact = reference::single_scatter(wi, wo, N, double(g), 0.7, double(d));
        ASSERT_NEAR(single_scatter(wi, wo, N, g, 0.7f, d), exact, 1e-4 * exact + 1e-6);
        ASSERT_EQ(single_scatter(wi, wo, N, g, 0.7f, d), single_scatter(wo, wi, N, g, 0.7f, d));
    }
}

TEST(SingleScatter, HasTheLimitsOfThinAndThickLayers) {
    const glm::vec3 wi = -tilted(0.5f), wo = -tilted(-0.8f);
    const float i = std::cos(0.5f), o = std::cos(0.8f);
    const float phase = henyey_greenstein(-std::cos(1.3f), 0.3f);
    EXPECT_EQ(single_scatter(wi, wo, up, 0.3f, 0.5f, 0.0f), 0.0f);
    EXPECT_NEAR(single_scatter(wi, wo, up, 0.3f, 0.5f, 1e-3f) / 1e-3f, 0.5f * phase / (i * o),
                2e-3f * 0.5f * phase / (i * o));
    EXPECT_NEAR(single_scatter(wi, wo, up, 0.3f, 0.5f, 100.0f), 0.5f * phase / (i + o), 1e-6f);
}

TEST(SingleScatter, SendsBackNoMoreLightThanArrives) {
    for (const float angle : {0.0f, 0.7f, 1.3f, 1.55f}) {
        for (const float g : {-0.5f, 0.0f, 0.8f}) {
            // Light of 1 / (4 pi) of what falls on an area of cos(angle) leaves along wo.
            const double sent = sphere_average(
                [&](const glm::vec3& d) {
                    return d.z * single_scatter(-tilted(angle), -d, up, g, 1.0f, 100.0f);
                },
                0.0);
            EXPECT_LT(sent * 2 * pi / (4 * pi), 1.0) << angle << " " << g;
            EXPECT_GT(sent, 0.0);
        }
    }
}

TEST(SingleScatter, IsFiniteInTheLayersPlane) {
    const glm::vec3 along(1, 0, 0), none(0, 0, 0);
    for (const glm::vec3& w : {along, -along, none, tilted(1.57079f)}) {
        const float s = single_scatter(w, along, up, 0.8f, 0.8f, 100.0f);
        EXPECT_TRUE(s >= 0.0f && s < 1e6f) << s;
    }
}

glm::vec3 oil(const glm::vec3& V, const glm::vec3& L, float a_x, float a_y) {
    const std::array light{Light{L, glm::vec3(1.0f, 0.5f, 0.25f)}};
    return ward(test::seen(up, V, light), {1, 0, 0}, {0, 1, 0}, a_x, a_y);
}

TEST(Ward, IsThePublishedFormula) {
    test::Random random(15);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 V = above(up, random), L = above(up, random);
        const glm::dvec3 H = glm::normalize(glm::dvec3(L) + glm::dvec3(V));
        const double a_x = 0.3, a_y = 0.5, ci = L.z, cr = std::max(1e-4, double(V.z));
        const double lobe =
            std::exp(-2 * (H.x * H.x / (a_x * a_x) + H.y * H.y / (a_y * a_y)) / (1 + H.z));
        const double exact = ci * lobe / std::sqrt(ci * cr) / (4 * a_x * a_y);
        const glm::vec3 found = oil(V, L, 0.3f, 0.5f);
        ASSERT_NEAR(found.x, exact, 1e-5 * (1 + exact));
        ASSERT_EQ(found.y, 0.5f * found.x);
    }
}

TEST(Ward, ReflectsAllLightOfASmoothMirrorAndNotMore) {
    for (const auto& [a_x, a_y] : {std::pair{0.1f, 0.1f}, {0.05f, 0.2f}, {0.2f, 0.1f}}) {
        // The light from all around that goes to the eye, Cl being irradiance over pi.
        const double share =
            sphere_average([&](const glm::vec3& L) { return oil(up, L, a_x, a_y).x; }, 0.0) * 2;
        EXPECT_NEAR(share, 1.0, 0.06) << a_x << " " << a_y;
        EXPECT_LT(share, 1.0);
    }
}

TEST(Ward, IsReciprocal) {
    test::Random random(16);
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 V = above(up, random), L = above(up, random);
        if (V.z < 1e-3f || L.z < 1e-3f) continue;
        const float one = oil(V, L, 0.2f, 0.4f).x / L.z, other = oil(L, V, 0.2f, 0.4f).x / V.z;
        ASSERT_NEAR(one, other, 1e-5f * (1.0f + one));
    }
}

TEST(Ward, IsFiniteEverywhereAndNothingFromBehind) {
    test::Random random(17);
    for (int i = 0; i < 20000; ++i) {
        glm::vec3 V = random.direction(), L = random.direction();
        if (i % 4 == 1) L = -V;
        if (i % 4 == 2) V = tangent_along(V, up);
        if (i % 4 == 3) L = -V + 1e-6f * L, L /= glm::length(L);
        for (const float a : {0.01f, 1.0f}) {
            const glm::vec3 found = oil(V, L, a, a);
            ASSERT_TRUE(found.x >= 0.0f && found.x < 1e6f) << found.x;
            if (L.z <= 0.0f) {
                ASSERT_EQ(found, glm::vec3(0.0f));
            }
        }
    }
}

}  // namespace
}  // namespace estara
