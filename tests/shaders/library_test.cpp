// What single shaders are known to look like: reference figures of their patterns.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "estara/shaders/noise.h"
#include "estara/shaders/registry.h"
#include "reference.h"
#include "sampling.h"

namespace estara {
namespace {

constexpr int capacity = SurfaceBatch::capacity;

BoundShaderPtr bound(const char* name, const std::vector<Setting>& settings, bool has_uv) {
    BindResult result = bind_shader(name, settings, has_uv);
    for (const Problem& problem : result.problems) ADD_FAILURE() << problem.what;
    return result.shader;
}

/// Float k of a shader at 102,400 points of a large cube.
test::Sample baked(const BoundShader& shader, int k, float filter_width = 0.01f) {
    test::Sample sample;
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        const std::vector<float> planes =
            test::bake(shader, test::random_batch(seed, 300.0f, filter_width));
        for (int i = 0; i < capacity; ++i) sample.add(planes[std::size_t(k * capacity + i)]);
    }
    return sample;
}

TEST(Greenmarble, HasTheReferenceVeinsAndSubstrate) {
    const std::vector<Setting> colors{
        {"darkcolor", {0, 0, 0}}, {"lightcolor", {1, 0, 0}}, {"veincolor", {0, 1, 0}}};
    const BoundShaderPtr shader = bound("greenmarble", colors, false);
    test::Sample veins, substrate;
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        const std::vector<float> planes = test::bake(*shader, test::random_batch(seed, 300.0f));
        for (std::size_t i = 0; i < capacity; ++i) {
            const float vein = planes[capacity + i];
            veins.add(vein);
            if (vein < 0.9f) substrate.add(planes[i] / (1.0f - vein));
        }
    }
    EXPECT_NEAR(veins.above(0.5), 0.035, 0.003);
    // It depends on the filter width: .398 at the .01 taken here, .407 at .001.
    EXPECT_NEAR(substrate.mean(), 0.41, 0.015);
}

TEST(Greenmarble, HasTheReferenceMask) {
    test::Random random(1);
    test::Sample mask;
    for (int i = 0; i < 20000; ++i) {
        mask.add(reference::marble(random.point(300.0f), 0.01, 1, 25).mask);
    }
    EXPECT_NEAR(mask.mean(), 0.54, 0.012);
}

// The reference, .51, is the mean over a ring whose phase is uniform (.515, by integration). It is
// not quite uniform: the noise that shifts the rings is 1/2 at every whole ring, so phases near
// 1/2, where wood is dark, are the likelier ones, and the mean over many rings is .537.
TEST(Wood, HasDarkRingsOnHalfOfItsRadius) {
    test::Sample weight = baked(*bound("wood", {}, false), 3);
    EXPECT_NEAR((weight.mean() - 0.7) / 0.3, 0.537, 0.005);
    EXPECT_NEAR(weight.quantile(0.0), 0.7, 1e-6);
    EXPECT_NEAR(weight.largest(), 1.0, 1e-6);

    test::Sample uniform;
    for (int i = 0; i < 10000; ++i) {
        const double phase = (i + 0.5) / 10000;
        uniform.add(reference::smoothstep(0, 0.8, phase) - reference::smoothstep(0.83, 1, phase));
    }
    EXPECT_NEAR(uniform.mean(), 0.515, 1e-6);
}

TEST(Wood, IsDarkWhereItShines) {
    const BoundShaderPtr shader = bound("wood", {}, false);
    const std::vector<float> planes = test::bake(*shader, test::random_batch(1));
    for (int i = 0; i < capacity; ++i) {
        const float r = (planes[std::size_t(3 * capacity + i)] - 0.7f) / 0.3f;
        ASSERT_NEAR(planes[std::size_t(i)], 0.3f + r * (0.05f - 0.3f), 1e-6f);
    }
}

/// Share of mortar: the solid's and the flat's colours made black and white.
double mortar(bool has_uv) {
    const BoundShaderPtr shader = bound("cobblestone", {{"selfCol", {1}}, {"varCol", {0}}}, has_uv);
    return baked(*shader, 0).mean() * 2.0;  // the mortar is selfCol / 2
}

TEST(Cobblestone, HasTheReferenceShareOfMortar) {
    const double share = mortar(true);
    EXPECT_GT(share, 0.11);
    EXPECT_LT(share, 0.12);
}

TEST(Cobblestone, HasMoreMortarWhenItIsSolid) {
    const double share = mortar(false);  // 27 neighbours instead of 9 are nearer to each other
    EXPECT_GT(share, mortar(true));
    EXPECT_LT(share, 0.25);
}

TEST(Cobblestone, GivesEachCobbleAShadeOfItsOwn) {
    const BoundShaderPtr shader =
        bound("cobblestone", {{"varCol", {0.8f}}, {"selfCol", {0}}}, false);
    const test::Sample red = baked(*shader, 0);
    EXPECT_GT(red.above(0.95), 0.05);  // cobbles are uniform between .6 and 1
    EXPECT_GT(1.0 - red.above(0.65), 0.05);
}

TEST(Stone, HasNoMoreShadesThanAsked) {
    for (const float nshades : {1.0f, 4.0f, 7.0f}) {
        const BoundShaderPtr shader =
            bound("stone", {{"nshades", {nshades}}, {"Cs", {1}}, {"exponent", {1}}}, false);
        std::set<float> shades;
        for (std::uint32_t seed = 0; seed < 20; ++seed) {
            const std::vector<float> planes = test::bake(*shader, test::random_batch(seed));
            shades.insert(planes.begin(), planes.begin() + capacity);
        }
        EXPECT_LE(shades.size(), std::size_t(nshades) + 1);
        EXPECT_GE(shades.size(), 2u);
        for (const float shade : shades)
            EXPECT_NEAR(shade * nshades, std::round(shade * nshades), 1e-5f);
    }
}

TEST(Stone, IsOnTheAverageTheQuantisedNoise) {
    const BoundShaderPtr shader = bound("stone", {{"Cs", {1}}}, false);
    test::Random random(2);
    test::Sample expected;
    for (int i = 0; i < 100000; ++i) {
        const double t = reference::noise(random.point(300.0f), 3);
        expected.add(std::round(4 * t * t) / 4);
    }
    EXPECT_NEAR(baked(*shader, 0).mean(), expected.mean(), 0.005);
}

TEST(Plastic, IsItsColourEverywhere) {
    const BoundShaderPtr shader = bound("plastic", {{"Cs", {0.1f, 0.2f, 0.3f}}}, false);
    const std::vector<float> planes = test::bake(*shader, test::random_batch(3));
    for (int c = 0; c < 3; ++c) {
        const float wanted = std::vector{0.1f, 0.2f, 0.3f}[std::size_t(c)];
        for (int i = 0; i < capacity; ++i) ASSERT_EQ(planes[std::size_t(c * capacity + i)], wanted);
    }
}

}  // namespace
}  // namespace estara
