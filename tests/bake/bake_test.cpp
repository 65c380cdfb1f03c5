// Bakes hold the shader's own values, at a known error, whoever bakes them.
#include "estara/bake/bake.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <random>

#include "estara/bake/surface_band.h"
#include "estara/grids/bricks.h"
#include "estara/scenes/error.h"
#include "estara/scenes/load.h"
#include "estara/scenes/program.h"
#include "shapes.h"

namespace estara {
namespace {

BoundShaderPtr bound(const std::string& name, const std::vector<Setting>& settings = {},
                     bool has_uv = false) {
    BindResult result = bind_shader(name, settings, has_uv);
    if (!result.shader) throw std::runtime_error(result.problems.front().what);
    return result.shader;
}

/// Shaders in sizes that suit a sphere of radius 1.
const std::vector<std::pair<std::string, std::vector<Setting>>> solid_shaders{
    {"wood", {{"ringscale", {4.0f}}}},
    {"stone", {{"scale", {0.3f}}}},
    {"cobblestone", {{"txtscale", {3.0f}}}},
    {"greenmarble", {}},
    {"plastic", {}}};

TEST(Bake, HoldsTheShadersOwnValueAtEachVoxel) {
    const Mesh mesh = test::sphere(30, 1.0f);
    for (const auto& [name, settings] : solid_shaders) {
        const BoundShaderPtr shader = bound(name, settings);
        const TextureGrid grid = bake_mesh(mesh, *shader, 0.05, false);
        static SurfaceBatch one;
        std::vector<float> planes(std::size_t(grid.floats()) * SurfaceBatch::capacity);
        one.size = 1;
        one.filter_width = 0.05f;
        for (const Block& block : grid.levels[0].blocks) {
            std::uint64_t row = block.first;
            for (int bit = 0; bit < 512; ++bit) {
                if (!block.active.test(bit)) continue;
                const glm::dvec3 voxel(block.origin +
                                       glm::ivec3(bit >> 6, (bit >> 3) & 7, bit & 7));
                one.set(0, glm::vec3(grid.origin + grid.voxel_size * voxel), {0, 1, 0}, {0, 0},
                        {1, 0, 0});
                shader->bake(one, planes.data());
                for (int k = 0; k < grid.floats(); ++k) {
                    ASSERT_EQ(grid.levels[0].planes[std::size_t(k)][row],
                              planes[std::size_t(k) * SurfaceBatch::capacity])
                        << name;
                }
                ++row;
            }
        }
    }
}

TEST(Bake, HoldsTheDistanceOfEachVoxel) {
    const Mesh mesh = test::sphere(60, 1.0f);
    constexpr double sagitta = 0.003;  // of the mesh
    for (const BoundShaderPtr& shader :
         {bound("plastic"), bound("cobblestone", {{"variant", {0.0f}}}, true)}) {
        const TextureGrid grid = bake_mesh(mesh, *shader, 0.05, false);
        std::size_t row = 0;
        for (const Block& block : grid.levels.front().blocks) {
            for_each_bit(block.active, [&](int x, int y, int z) {
                const glm::dvec3 voxel(block.origin + glm::ivec3(x, y, z));
                const double expected = glm::length(grid.origin + grid.voxel_size * voxel) - 1.0;
                if (std::abs(expected) < grid.voxel_size) {  // beyond, it may be larger
                    EXPECT_NEAR(grid.distance[row], expected, sagitta);
                }
                ++row;
            });
        }
        EXPECT_EQ(grid.distance, surface_band(mesh, 0.05).distance);
        EXPECT_EQ(row, grid.distance.size());
    }
}

TEST(Bake, FindsAVoxelForEverySurfacePointOnEveryLevel) {
    for (const Mesh& mesh :
         {test::sphere(40, 1.0f), test::joined(test::square(1.0f), test::square(1.0f, 0.002f))}) {
        const TextureGrid grid = bake_mesh(mesh, *bound("greenmarble"), 0.02, false);
        const BrickPyramid pyramid(grid);
        ASSERT_EQ(pyramid.levels(), int(grid.levels.size()));
        std::mt19937 random(3);
        std::uniform_real_distribution<float> uniform;
        std::array<float, BrickPyramid::max_floats> value{};
        for (int n = 0; n < 20000; ++n) {
            float b1 = uniform(random), b2 = uniform(random);
            if (b1 + b2 > 1.0f) b1 = 1.0f - b1, b2 = 1.0f - b2;
            const glm::vec3 P =
                mesh_point(mesh, std::uint32_t(random() % mesh.triangles.size()), b1, b2).P;
            for (int level = 0; level < pyramid.levels(); ++level) {
                ASSERT_TRUE(pyramid.lookup(P, level, value.data())) << "level " << level;
            }
        }
    }
}

TEST(Bake, GoesDownToALevelOfSixteenVoxels) {
    const TextureGrid grid = bake_mesh(test::sphere(20, 1.0f), *bound("wood"), 0.02, false);
    const auto side = [](const GridLevel& level) {
        glm::ivec3 lo(1 << 20), hi(0);
        for (const Block& block : level.blocks) {
            for (int bit = 0; bit < 512; ++bit) {
                if (!block.active.test(bit)) continue;
                const glm::ivec3 v = block.origin + glm::ivec3(bit >> 6, (bit >> 3) & 7, bit & 7);
                lo = glm::min(lo, v), hi = glm::max(hi, v);
            }
        }
        const glm::ivec3 extent = hi - lo + 1;
        return std::max({extent.x, extent.y, extent.z});
    };
    EXPECT_LE(side(grid.levels.back()), 16);
    EXPECT_GT(side(grid.levels[grid.levels.size() - 2]), 16);
}

TEST(Bake, IsTheSameWithOneThreadAndFour) {
    const Mesh mesh = test::sphere(30, 1.0f);
    const BoundShaderPtr shader = bound("greenmarble");
    const auto bake_with = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        TextureGrid grid = bake_mesh(mesh, *shader, 0.03, true);
        grid.errors = measure_error(mesh, *shader, grid, 5000, 1);
        return grid;
    };
    const TextureGrid one = bake_with(1), four = bake_with(4);
    ASSERT_EQ(one.levels.size(), four.levels.size());
    for (std::size_t n = 0; n < one.levels.size(); ++n)
        EXPECT_EQ(one.levels[n].planes, four.levels[n].planes);
    EXPECT_EQ(one.errors[0].rmse, four.errors[0].rmse);
    EXPECT_EQ(one.errors[0].p999, four.errors[0].p999);
}

TEST(Bake, OnTextureCoordinatesTakesTheNearestSurfacePoint) {
    const Mesh mesh = test::sphere(60, 1.0f);
    const BoundShaderPtr shader = bound("cobblestone", {{"variant", {0.0f}}}, true);
    ASSERT_EQ(shader->domain(), Domain::surface);
    const TextureGrid grid = bake_mesh(mesh, *shader, 0.004, false);
    const auto errors = measure_error(mesh, *shader, grid, 50000, 1);
    EXPECT_LT(errors[0].rmse, 0.02);  // mortar edges are .04 of a cell of .3 wide: 3 voxels
    EXPECT_LT(errors[0].p99, 0.1);
}

TEST(Bake, ErrorShrinksWithTheSquareOfTheVoxelWhereTheShaderIsSmooth) {
    const Mesh mesh = test::sphere(60, 1.0f);
    const BoundShaderPtr shader =
        bound("wood", {{"ringscale", {0.5f}}});  // rings wider than the sphere
    const auto rmse = [&](double size) {
        return measure_error(mesh, *shader, bake_mesh(mesh, *shader, size, false), 40000, 1)[0]
            .rmse;
    };
    const double coarse = rmse(0.04), fine = rmse(0.01);
    EXPECT_GT(coarse / fine, 10.0);  // 16 in theory; noise has kinks in its third derivative
    EXPECT_LT(coarse / fine, 20.0);
}

TEST(Bake, ErrorFiguresAreInOrderAndIncludeHalfRounding) {
    const Mesh mesh = test::sphere(30, 1.0f);
    const BoundShaderPtr plain = bound("plastic", {{"Cs", {0.3f, 0.123456f, 0.777f}}});
    TextureGrid grid = bake_mesh(mesh, *plain, 0.1, false);
    EXPECT_LT(measure_error(mesh, *plain, grid, 1000, 1)[0].max, 1e-6);
    grid = bake_mesh(mesh, *plain, 0.1, true);
    const ErrorFigures half = measure_error(mesh, *plain, grid, 1000, 1)[0];
    EXPECT_GT(half.max, 1e-6);
    EXPECT_LT(half.max, 0x1p-12);

    const BoundShaderPtr marble = bound("greenmarble");
    grid = bake_mesh(mesh, *marble, 0.05, false);
    const ErrorFigures e = measure_error(mesh, *marble, grid, 20000, 1)[0];
    EXPECT_EQ(e.samples, 20000u);
    EXPECT_GT(e.mean, 0.0);
    EXPECT_LT(e.mean, e.rmse);
    EXPECT_LT(e.rmse, e.p99);
    EXPECT_LT(e.p99, e.p999);
    EXPECT_LE(e.p999, e.max);
    // Other points, same error: the sample is large enough to be believed.
    EXPECT_NEAR(measure_error(mesh, *marble, grid, 20000, 2)[0].rmse, e.rmse, 0.1 * e.rmse);
}

TEST(Bake, KeepsTheErrorItIsAskedFor) {
    const Mesh mesh = test::sphere(40, 1.0f);
    const BoundShaderPtr shader = bound("wood", {{"ringscale", {2.0f}}});
    const BoundedBake baked = bake_to_error(mesh, *shader, 0.003, false, std::uint64_t{4} << 30, 1);
    for (const ErrorFigures& e : baked.grid.errors) EXPECT_LE(e.rmse, 0.003);
    // Not much finer than needed: a voxel a third larger breaks the bound.
    const double coarser = 1.34 * baked.grid.voxel_size;
    const auto errors =
        measure_error(mesh, *shader, bake_mesh(mesh, *shader, coarser, false), 100000, 1);
    EXPECT_GT(std::max(errors[0].rmse, errors[1].rmse), 0.003);
}

TEST(Bake, SaysWhenABoundIsOutOfReach) {
    const Mesh mesh = test::sphere(20, 1.0f);
    try {
        (void)bake_to_error(mesh, *bound("stone"), 1e-5, false, std::uint64_t{64} << 20, 1);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.status(), ExitStatus::failed);
        EXPECT_THAT(
            error.what(),
            testing::MatchesRegex(
                "RMSE 1e-05 is out of reach within the 64 MiB that --max-memory leaves: the "
                "smallest voxel that fits, .*, reached .*"));
    }
}

TEST(Bake, StaysNearItsVoxelEstimate) {
    const BoundShaderPtr shader = bound("wood");
    for (const double size : {0.05, 0.01, 0.005}) {
        const Mesh mesh = test::sphere(40, 1.0f);
        const auto estimated = double(estimate_bake(mesh, shader->info(), size).voxels);
        const auto actual = double(bake_mesh(mesh, *shader, size, false).levels[0].voxels());
        EXPECT_NEAR(estimated / actual, 1.0, 0.05) << size;
    }
}

TEST(Bake, HoldsOnMeshesAsPeopleHaveThem) {
    for (const char* name : {"scan.obj", "spot.obj", "strips.ply"}) {
        const Scene scene = load_scene(std::string(ESTARA_MODELS) + "/" + name);
        const Mesh& mesh = scene.objects[0].mesh;
        const double size = double(bounds(mesh).diagonal()) / 300.0;
        const BoundShaderPtr shader =
            bound("wood", {{"ringscale", {float(0.02 / size)}}});  // a ring every 50 voxels
        const TextureGrid grid = bake_mesh(mesh, *shader, size, false);
        const auto errors = measure_error(mesh, *shader, grid, 50000, 1);
        EXPECT_LT(errors[0].rmse, 0.004) << name;
        EXPECT_LT(errors[0].max, 0.26)
            << name;  // lightwood - darkwood: no lookup misses its voxels
    }
}

}  // namespace
}  // namespace estara
