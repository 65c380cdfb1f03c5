// Noise, cellnoise and turbulence against the double reference and their reference figures.
#include "estara/shaders/noise.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "reference.h"
#include "sampling.h"

namespace estara {
namespace {

constexpr int many = 200000;
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

// Float rounding of the offsets (2^-24), gradients up to 2 (slopes up to 8 in one dimension).
TEST(Noise, IsTheReferenceInAllDimensions) {
    test::Random random(1);
    for (int i = 0; i < 50000; ++i) {
        const glm::vec3 p = random.point(i % 2 == 0 ? 3.0f : 3000.0f);
        const std::uint32_t seed = i % 4;
        ASSERT_NEAR(snoise(p.x, seed), reference::snoise(p, 1, seed), 2e-6);
        ASSERT_NEAR(snoise(glm::vec2(p), seed), reference::snoise(p, 2, seed), 2e-6);
        ASSERT_NEAR(snoise(p, seed), reference::snoise(p, 3, seed), 2e-6);
    }
}

TEST(Noise, OfThreeDimensionsHasTheReferenceHistogram) {
    test::Random random(2);
    test::Sample sample;
    for (int i = 0; i < many; ++i) sample.add(noise(random.point(500.0f)));
    EXPECT_NEAR(sample.mean(), 0.500, 0.002);
    EXPECT_NEAR(sample.deviation(), 0.127, 0.001);
    EXPECT_NEAR(sample.quantile(0.01), 0.225, 0.003);
    EXPECT_NEAR(sample.quantile(0.99), 0.774, 0.003);
    EXPECT_NEAR(sample.above(0.6), 0.229, 0.004);
    EXPECT_GE(sample.quantile(0.0), 0.0);
    EXPECT_LE(sample.largest(), 1.0);
}

TEST(Noise, OfOneAndTwoDimensionsHasMeanHalfAndStaysInZeroToOne) {
    test::Random random(3);
    test::Sample one, two;
    for (int i = 0; i < many; ++i) {
        const glm::vec3 p = random.point(5000.0f);
        one.add(noise(p.x));
        two.add(noise(glm::vec2(p)));
    }
    for (test::Sample* sample : {&one, &two}) {
        EXPECT_NEAR(sample->mean(), 0.5, 0.005);  // 10,000 cells in one dimension
        EXPECT_GE(sample->quantile(0.0), 0.0);
        EXPECT_LE(sample->largest(), 1.0);
        EXPECT_GT(sample->deviation(), 0.1);
    }
}

TEST(Noise, IsHalfAtEveryLatticePoint) {
    for (int x = -9; x <= 9; ++x) {
        EXPECT_EQ(noise(float(x)), 0.5f);
        for (int y = -9; y <= 9; ++y) {
            EXPECT_EQ(noise(glm::vec2(x, y)), 0.5f);
            for (int z = -9; z <= 9; ++z) {
                EXPECT_EQ(noise(glm::vec3(x, y, z)), 0.5f);
                EXPECT_EQ(vnoise(glm::vec3(x, y, z)), glm::vec3(0.5f));
            }
        }
    }
}

// The slope of snoise is below 8 in every direction, so a step of 2e-4 may change it by 1.6e-3.
TEST(Noise, HasNoStepAcrossACell) {
    test::Random random(4);
    const float h = 1e-4f;
    for (int i = 0; i < 20000; ++i) {
        const float wall = float(int(random.within(-4.0f, 4.0f)));  // with the origin
        glm::vec3 below = random.point(4.0f), above = below;
        below[i % 3] = wall - h;
        above[i % 3] = wall + h;
        ASSERT_NEAR(snoise(below), snoise(above), 1.6e-3f);
        ASSERT_NEAR(snoise(glm::vec2(below)), snoise(glm::vec2(above)), 1.6e-3f);
        ASSERT_NEAR(snoise(wall - h), snoise(wall + h), 1.6e-3f);
    }
}

TEST(Noise, TouchesTheSameValueFromBothSidesOfAWall) {
    test::Random random(5);
    for (int i = 0; i < 20000; ++i) {
        glm::vec3 at = random.point(4.0f);
        at[i % 3] = float(int(random.within(-4.0f, 4.0f)));
        glm::vec3 below = at;
        below[i % 3] = std::nextafter(at[i % 3], -infinity);
        ASSERT_NEAR(snoise(below), snoise(at), 4e-6f);
    }
}

TEST(Noise, SurvivesHugeAndBrokenCoordinates) {
    test::Random random(6);
    for (const float scale : {1e6f, 1e9f, 1e20f, 1e38f}) {
        for (int i = 0; i < 2000; ++i) {
            const glm::vec3 p = random.point(1.0f) * scale;
            for (const float n : {noise(p), noise(glm::vec2(p)), noise(p.x)}) {
                ASSERT_TRUE(n >= 0.0f && n <= 1.0f) << n << " at " << scale;
            }
            const float cell = cellnoise(p);
            ASSERT_TRUE(cell >= 0.0f && cell < 1.0f);
        }
    }
    for (const float broken : {infinity, -infinity, not_a_number}) {
        EXPECT_TRUE(std::isnan(noise(glm::vec3(1.5f, broken, 0.5f))));
        EXPECT_TRUE(std::isnan(noise(glm::vec2(broken, 0.5f))));
        EXPECT_TRUE(std::isnan(noise(broken)));
        const float cell = cellnoise(glm::vec3(broken));
        EXPECT_TRUE(cell >= 0.0f && cell < 1.0f);
    }
}

TEST(Noise, StillVariesAMillionUnitsAway) {
    test::Random random(7);
    test::Sample sample;
    for (int i = 0; i < 20000; ++i) sample.add(noise(glm::vec3(1e6f) + random.point(100.0f)));
    EXPECT_NEAR(sample.mean(), 0.5, 0.01);
    EXPECT_NEAR(sample.deviation(), 0.127, 0.01);
}

TEST(Noise, OfSeveralSeedsAndComponentsIsUncorrelated) {
    test::Random random(8);
    test::Correlation xy, yz, zx, seeds, of_x;
    for (int i = 0; i < many; ++i) {
        const glm::vec3 p = random.point(100.0f), v = vnoise(p);
        xy.add(v.x, v.y);
        yz.add(v.y, v.z);
        zx.add(v.z, v.x);
        seeds.add(noise(p, 7u), noise(p, 8u));
        of_x.add(noise(p), v.x);
    }
    for (const test::Correlation* c : {&xy, &yz, &zx, &seeds, &of_x}) {
        EXPECT_NEAR(c->value(), 0.0, 0.012);  // five times 1 / sqrt(200,000)
    }
}

/// Correlation of the random numbers of cell p and cell other(p) over a cube of 41^3 cells.
template <class Other>
double hash_correlation(Other other) {
    test::Correlation correlation;
    for (int z = -20; z <= 20; ++z) {
        for (int y = -20; y <= 20; ++y) {
            for (int x = -20; x <= 20; ++x) {
                const glm::ivec3 p(x, y, z), q = other(p);
                if (p == q) continue;
                correlation.add(detail::unit_float(detail::hash(p.x, p.y, p.z, 0)),
                                detail::unit_float(detail::hash(q.x, q.y, q.z, 0)));
            }
        }
    }
    return correlation.value();
}

// Mirrored pairs are counted twice, so five standard deviations are 5 sqrt(2 / 41^3).
constexpr double five_sigma = 0.027;

TEST(Hash, IsUncorrelatedAlongAxesAndDiagonals) {
    for (const int step : {1, 2, 3, 4, 8, 16, 256, 4096}) {
        for (int n = 0; n < 27; ++n) {
            const glm::ivec3 d(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
            if (d == glm::ivec3(0)) continue;
            EXPECT_NEAR(hash_correlation([&](glm::ivec3 p) { return p + step * d; }), 0.0,
                        five_sigma)
                << step << " times " << d.x << " " << d.y << " " << d.z;
        }
    }
}

TEST(Hash, HasNoMirrorAtTheOrigin) {
    for (int n = 1; n < 8; ++n) {
        const glm::ivec3 sign(n & 1 ? -1 : 1, n & 2 ? -1 : 1, n & 4 ? -1 : 1);
        for (const int shift : {0, -1}) {  // about lattice points, and about the middle of a cell
            const auto mirrored = [&](glm::ivec3 p) { return sign * p + shift * (1 - sign) / 2; };
            EXPECT_NEAR(hash_correlation(mirrored), 0.0, five_sigma) << n << " " << shift;
        }
    }
    EXPECT_NEAR(hash_correlation([](glm::ivec3 p) { return glm::ivec3(p.y, p.x, p.z); }), 0.0,
                five_sigma);
    EXPECT_NEAR(hash_correlation([](glm::ivec3 p) { return glm::ivec3(p.y, p.z, p.x); }), 0.0,
                five_sigma);
}

TEST(Hash, HasEveryBitSetHalfOfTheTime) {
    std::array<int, 32> set{};
    const int n = 64000;
    for (int i = 0; i < n; ++i) {
        const std::uint32_t h = detail::hash(i % 40 - 20, i / 40 % 40 - 20, i / 1600 - 20, 3);
        for (std::size_t bit = 0; bit < 32; ++bit) set[bit] += int((h >> bit) & 1u);
    }
    for (const int count : set)
        EXPECT_NEAR(double(count) / n, 0.5, 0.01);  // five standard deviations
}

TEST(Cellnoise, IsConstantInACellAndTheReference) {
    test::Random random(9);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 cell = glm::floor(random.point(100.0f));
        const glm::vec3 inside(random.unit(), random.unit(), random.unit());
        const float value = cellnoise(cell, 5u);
        ASSERT_EQ(value, float(reference::cellnoise(cell, 3, 5u)));
        ASSERT_EQ(cellnoise(glm::vec2(cell)), float(reference::cellnoise(cell, 2)));
        // The sum is rounded, possibly up to the next cell.
        const glm::vec3 p = glm::min(cell + inside, cell + 0.9999f);
        ASSERT_EQ(cellnoise(p, 5u), value);
        ASSERT_EQ(cellnoise(glm::vec2(p)), cellnoise(glm::vec2(cell)));
    }
}

TEST(Cellnoise, IsUniform) {
    std::array<int, 20> bins{};
    const int n = 40 * 40 * 40;
    for (int i = 0; i < n; ++i) {
        const glm::vec3 p(i % 40 - 20, i / 40 % 40 - 20, i / 1600 - 20);
        const float value = cellnoise(p);
        ASSERT_TRUE(value >= 0.0f && value < 1.0f);
        ++bins[std::size_t(value * 20.0f)];
    }
    double chi2 = 0;
    for (const int count : bins) chi2 += std::pow(count - n / 20.0, 2) / (n / 20.0);
    EXPECT_LT(chi2, 43.8);  // 19 degrees of freedom: one sample in a thousand is above
}

float turbulence(const glm::vec3& q, float w, Phi phi) {
    float sum = 0.0f;
    for (int k = 0; k < octaves_for(w); ++k) {
        sum += phi == Phi::noise ? turbulence_term<Phi::noise>(q, w, k)
                                 : turbulence_term<Phi::deviation>(q, w, k);
    }
    return sum;
}

TEST(Turbulence, HasTheReferenceNumberOfNoises) {
    EXPECT_EQ(octaves_for(0.02f), 6);
    EXPECT_EQ(octaves_for(0.01f), 7);
    EXPECT_EQ(octaves_for(0.005f), 8);
    EXPECT_EQ(octaves_for(0.001f), 10);
    for (const float w : {1e9f, 1.0f, 0.5f}) EXPECT_EQ(octaves_for(w), 1) << w;
    for (const float w : {1e-9f, 1e-38f, 1e-45f}) EXPECT_EQ(octaves_for(w), 24) << w;
    test::Random random(10);
    for (int i = 0; i < 10000; ++i) {
        const float w = std::exp2(random.within(-20.0f, 3.0f));
        ASSERT_EQ(octaves_for(w), reference::turbulence_noises(w)) << w;
    }
}

TEST(Turbulence, IsTheReference) {
    test::Random random(11);
    for (int i = 0; i < 5000; ++i) {
        const glm::vec3 q = random.point(10.0f);
        const float w = std::exp2(random.within(-12.0f, 1.0f));
        ASSERT_NEAR(turbulence(q, w, Phi::deviation), reference::turbulence(q, w, true), 5e-6) << w;
        ASSERT_NEAR(turbulence(q, w, Phi::noise), reference::turbulence(q, w, false), 5e-6) << w;
    }
}

TEST(Turbulence, OfTheDeviationHasTheReferenceHistogramAtAnyWidth) {
    test::Random random(12);
    for (const float w : {0.02f, 0.01f, 0.005f, 0.001f}) {
        test::Sample sample;
        for (int i = 0; i < 50000; ++i)
            sample.add(turbulence(random.point(500.0f), w, Phi::deviation));
        EXPECT_NEAR(sample.mean(), 0.205, 0.005) << w;
        EXPECT_NEAR(sample.quantile(0.01), 0.05, 0.01) << w;
        EXPECT_NEAR(sample.quantile(0.99), 0.42, 0.01) << w;
    }
}

TEST(Turbulence, FadesItsLastOctaveIn) {
    test::Random random(13);
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 q = random.point(10.0f);
        const float w = std::exp2(random.within(-8.0f, 0.0f));
        // A change of one part in 10,000 in the width may change each half-faded octave by as much.
        ASSERT_NEAR(turbulence(q, w, Phi::noise), turbulence(q, w * 1.0001f, Phi::noise), 3e-4)
            << w;
    }
    for (int k = 0; k < 10; ++k) {  // at the widths where the number of octaves changes
        const float w = std::ldexp(0.5f, -k), narrower = std::nextafter(w, 0.0f);
        const glm::vec3 q = random.point(10.0f);
        EXPECT_EQ(octaves_for(narrower * 0.9999f), octaves_for(w) + 1);
        EXPECT_NEAR(turbulence(q, w, Phi::noise), turbulence(q, narrower, Phi::noise), 1e-6);
    }
}

TEST(Turbulence, TermsBeyondTheLastAreNothing) {
    const glm::vec3 q(1.3f, -0.7f, 2.9f);
    for (const float w : {0.7f, 0.02f, 0.001f}) {
        for (int k = octaves_for(w); k < 24; ++k) {
            EXPECT_EQ(turbulence_term<Phi::deviation>(q, w, k), 0.0f) << w << " " << k;
        }
    }
}

TEST(NoiseGradient, ComesWithTheValueOfSnoiseToTheBit) {
    test::Random random(20);
    for (int i = 0; i < 50000; ++i) {
        const glm::vec3 p = random.point(i % 2 == 0 ? 3.0f : 3000.0f);
        const std::uint32_t seed = i % 4;
        ASSERT_EQ(snoise_gradient(p, seed).value, snoise(p, seed));
    }
}

// Rounding of the offsets as for the value; the noise curves by 60 at most.
TEST(NoiseGradient, IsTheChangeOfTheReference) {
    test::Random random(21);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 p = random.point(i % 2 == 0 ? 3.0f : 3000.0f);
        const std::uint32_t seed = i % 4;
        const glm::dvec3 exact = reference::change(
            [&](const glm::dvec3& q) { return reference::snoise(q, 3, seed); }, p, 1e-6);
        const glm::vec3 slope = snoise_gradient(p, seed).gradient;
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(slope[c], exact[c], 2e-5) << i;
    }
}

TEST(NoiseGradient, AtALatticePointIsThatOfItsCorner) {
    test::Random random(22);
    for (int i = 0; i < 1000; ++i) {
        const NoiseSlope at = snoise_gradient(glm::floor(random.point(100.0f)));
        EXPECT_EQ(at.value, 0.0f);
        int ones = 0;
        for (int c = 0; c < 3; ++c) {
            if (at.gradient[c] == 0.0f) continue;
            EXPECT_EQ(std::fabs(at.gradient[c]), 0.936f);
            ++ones;
        }
        EXPECT_EQ(ones, 2);
    }
}

TEST(NoiseGradient, IsFiniteAtHugeCoordinates) {
    test::Random random(23);
    for (const float scale : {1e6f, 1e9f, 1e20f, 1e38f}) {
        for (int i = 0; i < 1000; ++i) {
            const NoiseSlope at = snoise_gradient(random.point(1.0f) * scale);
            ASSERT_LT(glm::length(at.gradient), 8.0f);
        }
    }
}

}  // namespace
}  // namespace estara
