// What single shaders are known to look like: reference figures of their patterns.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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

/// The share of spattercolor with so many sizes of specks.
double specks(float sizes) {
    const BoundShaderPtr shader =
        bound("spatter", {{"sizes", {sizes}}, {"basecolor", {0}}, {"spattercolor", {1}}}, false);
    return baked(*shader, 0).mean();
}

// The noise exceeds .7 at 6 % of its points, and the noises of two sizes are all but independent.
TEST(Spatter, HasSpecksOfEverySize) {
    test::Random random(5);
    test::Sample above;
    for (int i = 0; i < 100000; ++i) above.add(reference::noise(random.point(300.0f), 3));
    const double one = above.above(0.7);
    EXPECT_NEAR(one, 0.06, 0.006);
    for (const float sizes : {1.0f, 3.0f, 5.0f, 8.0f}) {
        EXPECT_NEAR(specks(sizes), 1 - std::pow(1 - one, sizes), 0.012) << sizes;
    }
}

TEST(Spatter, HasTwoColours) {
    const BoundShaderPtr shader = bound("spatter", {}, false);
    const std::vector<float> planes = test::bake(*shader, test::random_batch(4));
    const std::set<float> reds(planes.begin(), planes.begin() + capacity);
    EXPECT_EQ(reds, (std::set<float>{0.1f, 1.0f}));
}

TEST(Carpet, HasScuffsAroundTheMeanOfTheTurbulence) {
    const BoundShaderPtr shader = bound("carpet", {{"Cs", {1}}}, false);
    test::Sample scuffs = baked(*shader, 0, 0.02f);  // nap is faded: its speckles are .01
    EXPECT_NEAR(scuffs.mean() / 0.8, 0.705, 0.005);
    EXPECT_NEAR(scuffs.quantile(0.01) / 0.8, 0.55, 0.01);
    EXPECT_NEAR(scuffs.quantile(0.99) / 0.8, 0.92, 0.01);
}

TEST(Carpet, HasANapWithTheMeanThatItFadesTo) {
    const BoundShaderPtr shader = bound("carpet", {{"Cs", {1}}}, false);
    const test::Sample near = baked(*shader, 0, 0.001f), far = baked(*shader, 0, 0.02f);
    EXPECT_NEAR(near.mean(), far.mean(), 0.004);
    EXPECT_GT(near.deviation(), 2.0 * far.deviation());
}

TEST(Cmarble, IsWhiteWithThinVeinsOfItsColour) {
    const BoundShaderPtr shader = bound("cmarble", {{"Cs", {0.5f, 0.25f, 0.125f}}}, false);
    test::Sample red = baked(*shader, 0), blue = baked(*shader, 2);
    EXPECT_NEAR(red.quantile(0.0), 0.5, 0.01);  // in the middle of a vein it is Cs
    EXPECT_NEAR(blue.quantile(0.0), 0.125, 0.01);
    EXPECT_NEAR(1.0 - blue.above(0.4), 0.20, 0.02);  // veins are thin
    EXPECT_GT(red.above(0.79), 0.25);
    EXPECT_GT(blue.quantile(0.5), 0.6);
}

TEST(Cmarble, OfAGreyHasNoHue) {
    for (const float grey : {0.0f, 0.3f, 1.0f}) {
        const std::vector<float> planes =
            test::bake(*bound("cmarble", {{"Cs", {grey}}}, false), test::random_batch(8));
        for (std::size_t i = 0; i < capacity; ++i) {
            ASSERT_NEAR(planes[i], planes[2 * capacity + i], 1e-6f);
        }
    }
}

TEST(Colormarble, IsMostlyPaleAndHasAllFourColours) {
    const auto share = [](const char* color) {
        std::vector<Setting> settings{
            {"pale", {0}}, {"medium", {0}}, {"middark", {0}}, {"dark", {0}}};
        for (Setting& s : settings) {
            if (s.name == color) s.value = {1};
        }
        return baked(*bound("colormarble", settings, false), 0).mean();
    };
    const double pale = share("pale"), medium = share("medium"), middark = share("middark"),
                 dark = share("dark");
    EXPECT_GT(pale, 0.4);
    for (const double other : {medium, middark, dark}) {
        EXPECT_GT(other, 0.05);
        EXPECT_LT(other, pale);
    }
    EXPECT_NEAR(pale + medium + middark + dark, 1.0, 0.1);  // but for what is clamped
}

/// Share of mortar in blocks whose edges are straight.
double joints(bool has_uv, float jagged) {
    const BoundShaderPtr shader = bound("blocks",
                                        {{"blockcolor", {1}},
                                         {"mortarcolor", {0}},
                                         {"blockvary", {0}},
                                         {"pitting", {0}},
                                         {"jagged", {jagged}}},
                                        has_uv);
    return 1.0 - baked(*shader, 0).mean();
}

TEST(Blocks, HasMortarBetweenBlocksOfTheirSize) {
    // Edges are soft on an eighth of the mortar's thickness on the average, on either side.
    const double width = (0.3 - 0.0025) / 0.31, height = (0.15 - 0.0025) / 0.16;
    EXPECT_NEAR(joints(true, 0.0f), 1 - width * height, 0.004);
    EXPECT_NEAR(joints(false, 0.0f), 1 - width * width * height, 0.004);
    EXPECT_NEAR(joints(true, 0.04f), joints(true, 0.0f), 0.01);  // ragged edges take and give
}

TEST(Blocks, GivesEachBlockAShadeOfItsOwn) {
    for (const bool has_uv : {true, false}) {
        const test::Sample red = baked(*bound("blocks",
                                              {{"blockcolor", {1}},
                                               {"mortarcolor", {0}},
                                               {"pitting", {0}},
                                               {"blockvary", {0.5f}}},
                                              has_uv),
                                       0);
        EXPECT_NEAR(red.above(0.75), 0.43, 0.02);  // of 86 % that are not mortar
        EXPECT_NEAR(red.above(0.95) / red.above(0.75), 0.2, 0.03);
    }
}

TEST(Blocks, HasThreeDifferentColoursAndPits) {
    const test::Sample smooth = baked(*bound("blocks", {{"pitting", {0}}}, true), 0);
    const test::Sample pitted = baked(*bound("blocks", {{"pitting", {1}}}, true), 0);
    EXPECT_GT(smooth.above(0.5), 0.85);
    EXPECT_LT(pitted.mean(), smooth.mean() - 0.02);
    EXPECT_GT(pitted.mean(), smooth.mean() - 0.2);
}

/// Largest angle's sine between normals of a shader and those of its double reference, and how many
/// of its points are off by more than `tolerance`.
void expect_reference_normals(const BoundShader& shader, double tolerance, double others) {
    const int at = shader.info().baked_floats - 3;
    int off = 0, points = 0;
    test::Sample tilt;
    for (std::uint32_t seed = 0; seed < 10; ++seed) {
        const SurfaceBatch batch = test::random_batch(seed, 2.0f);
        const std::vector<float> planes = test::bake(shader, batch);
        for (int i = 0; i < capacity; ++i) {
            const SurfacePoint x{{batch.P[0][i], batch.P[1][i], batch.P[2][i]},
                                 {batch.N[0][i], batch.N[1][i], batch.N[2][i]},
                                 {batch.uv[0][i], batch.uv[1][i]},
                                 {batch.dPdu[0][i], batch.dPdu[1][i], batch.dPdu[2][i]},
                                 batch.filter_width,
                                 0.0f};
            const std::vector<double> exact = *reference::bake(shader, x);
            double error = 0;
            glm::vec3 N(0.0f);
            for (int c = 0; c < 3; ++c) {
                N[c] = planes[std::size_t((at + c) * capacity + i)];
                error = std::max(error, std::abs(N[c] - exact[std::size_t(at + c)]));
            }
            tilt.add(std::acos(std::min(1.0f, glm::dot(N, x.N))));
            ++points;
            if (error > tolerance) ++off;
        }
    }
    EXPECT_LE(off, others * points);
    EXPECT_GT(tilt.mean(), 0.002);
    EXPECT_LT(tilt.mean(), 0.3);
}

// The others lie where another joint becomes the nearest.
TEST(Blocks, HasTheNormalsOfItsRelief) {
    expect_reference_normals(*bound("blocks", {{"bump", {1}}}, true), 1e-3, 1e-3);
    expect_reference_normals(*bound("blocks", {{"bump", {1}}}, false), 1e-3, 1e-3);
}

TEST(Blocks, PaintsTheSameColourWithReliefAndWithout) {
    for (const bool has_uv : {true, false}) {
        const SurfaceBatch batch = test::random_batch(9);
        const std::vector<float> flat = test::bake(*bound("blocks", {}, has_uv), batch);
        std::vector<float> relief = test::bake(*bound("blocks", {{"bump", {1}}}, has_uv), batch);
        relief.resize(flat.size());
        EXPECT_TRUE(test::same_bits(relief, flat));
    }
}

TEST(RCSkin, HasTheReferenceTurbulence) {
    test::Random random(6);
    test::Sample tau;
    for (int i = 0; i < 100000; ++i) {
        tau.add(reference::skin_turbulence(random.point(300.0f), 8));
    }
    EXPECT_NEAR(tau.mean(), 0.36, 0.01);
    EXPECT_NEAR(tau.quantile(0.99), 0.80, 0.02);
}

// Creases of a pore are where the others lie.
TEST(RCSkin, HasTheNormalsOfItsPores) {
    expect_reference_normals(*bound("RCSkin", {}, true), 1e-4, 1e-3);
    expect_reference_normals(*bound("RCSkin", {{"maxfreq", {64}}, {"poresthresh", {1}}}, true),
                             3e-4, 4e-3);
}

TEST(RCSkin, HasAsManyOctavesAsLieBelowMaxfreq) {
    const SurfaceBatch batch = test::random_batch(7);
    const auto planes = [&](float maxfreq) {
        return test::bake(*bound("RCSkin", {{"maxfreq", {maxfreq}}}, true), batch);
    };
    EXPECT_TRUE(test::same_bits(planes(4.01f), planes(8)));
    EXPECT_FALSE(test::same_bits(planes(4), planes(8)));
    EXPECT_FALSE(test::same_bits(planes(8), planes(8.01f)));
    const std::vector<float> none = planes(1);  // tau is 0: no pores, and the spline's start
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(none[std::size_t((9 + c) * capacity)], batch.N[c][0], 1e-6f);
        EXPECT_NEAR(none[std::size_t(c * capacity)], (c == 0 ? .7f : c == 1 ? .56f : .52f), 1e-6f);
    }
}

TEST(RCSkin, TurnsTheOilByItsAngle) {
    const SurfaceBatch batch = test::random_batch(8);
    const auto planes = [&](float angle) {
        return test::bake(*bound("RCSkin", {{"angle", {angle}}}, true), batch);
    };
    const std::vector<float> zero = planes(0), quarter = planes(90), half = planes(180);
    for (std::size_t i = 0; i < capacity; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const float X = zero[(3 + c) * capacity + i], Y = zero[(6 + c) * capacity + i];
            ASSERT_NEAR(quarter[(3 + c) * capacity + i], Y, 1e-6f);
            ASSERT_NEAR(half[(3 + c) * capacity + i], -X, 1e-6f);
            ASSERT_NEAR(half[(6 + c) * capacity + i], -Y, 1e-6f);
        }
    }
}

}  // namespace
}  // namespace estara
