#include "estara/shaders/lobes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

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

}  // namespace
}  // namespace estara
