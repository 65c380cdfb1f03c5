// Baked light is the light of the scene's lights, or it says that it is not to be trusted.
#include "estara/bake/irradiance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "../render/small_scene.h"
#include "estara/grids/bricks.h"
#include "estara/grids/irradiance.h"

namespace estara {
namespace {

using test::add_sun;
using test::error_of;
using test::object;
using test::scene_of;

/// A square of side 4 around 0 that faces the camera (z), and a ball above its middle or none,
/// under a sun of Cl = 1 that shines along -z.
Scene board(bool with_ball) {
    Mesh mesh;
    mesh.P = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    std::vector<Object> objects{object("board", mesh)};
    if (with_ball) {
        Mesh ball = test::sphere(0.5f, 48);
        for (glm::vec3& P : ball.P) P.z += 1.0f;
        objects.push_back(object("ball", ball));
    }
    Scene scene = scene_of(std::move(objects));
    add_sun(scene, glm::quat(1.0f, 0.0f, 0.0f, 0.0f));
    return scene;
}

TextureGrid bake(const Scene& scene, const IrradianceSettings& settings) {
    const RayScene rays(scene);
    return bake_irradiance(scene, rays, 0, settings);
}

struct Found {
    glm::vec3 E;
    float mask;
};
Found look_up(const BrickPyramid& bricks, const glm::vec3& P) {
    float values[4];
    EXPECT_TRUE(bricks.lookup(P, 0.0f, values));
    return {{values[0], values[1], values[2]}, values[3]};
}

TEST(Irradiance, OfAnOpenBoardIsTheSunsEverywhere) {
    const TextureGrid grid = bake(board(false), {.voxel_size = 0.1});
    EXPECT_EQ(grid.shader, irradiance_shader);
    EXPECT_EQ(masked_share(grid), 0.0);
    ASSERT_FALSE(grid.errors.empty());
    EXPECT_LE(grid.errors[0].max, 1e-5);
    const BrickPyramid bricks(grid);
    for (float x = -1.95f; x < 2.0f; x += 0.13f) {
        const Found found = look_up(bricks, {x, 0.7f * x, 0.0f});
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.E[c], 1.0f, 1e-5f);
        EXPECT_EQ(found.mask, 0.0f);
    }
}

TEST(Irradiance, OfAShadowIsNoneAndItsEdgeIsMasked) {
    const double h = 0.05;
    const BrickPyramid bricks(bake(board(true), {.voxel_size = h}));
    for (int i = 0; i < 2000; ++i) {
        const float angle = 0.1f * float(i), radius = 0.0006f * float(i);
        const glm::vec3 P(radius * std::cos(angle), radius * std::sin(angle), 0.0f);
        const Found found = look_up(bricks, P);
        const float edge = std::abs(radius - 0.5f);
        // The ball is a polyhedron, its shadow's radius between .5 and .5 cos(pi / 96).
        if (edge < 0.002f) {
            EXPECT_GT(found.mask, irradiance_mask_limit) << radius;
        } else if (found.mask <= irradiance_mask_limit) {
            EXPECT_NEAR(found.E.x, radius < 0.5f ? 0.0f : 1.0f, 0.01f) << radius;
        }
        if (edge > 4.0f * float(h)) {
            EXPECT_NEAR(found.mask, 0.0f, 1e-6f) << radius;
        }
    }
}

TEST(Irradiance, KeepsItsBoundAtPointsThatItHasNotSeen) {
    for (const double bound : {0.1, 0.01}) {
        const TextureGrid grid =
            bake(board(true), {.max_error = bound, .finest = 0.01, .max_bytes = 1u << 30});
        ASSERT_FALSE(grid.errors.empty());
        EXPECT_LE(grid.errors[0].p999, bound);
        EXPECT_LE(masked_share(grid), 0.05);
        EXPECT_GT(masked_share(grid), 0.0);
    }
}

TEST(Irradiance, IsTheSameWithOneThreadAndFour) {
    const Scene scene = board(true);
    const auto baked = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return bake(scene, {.voxel_size = 0.1});
    };
    const TextureGrid one = baked(1), four = baked(4);
    ASSERT_EQ(one.levels.size(), four.levels.size());
    for (std::size_t l = 0; l < one.levels.size(); ++l) {
        EXPECT_EQ(one.levels[l].planes, four.levels[l].planes) << "level " << l;
    }
    EXPECT_EQ(one.errors[0].rmse, four.errors[0].rmse);
}

TEST(Irradiance, RefusesAnObjectInTwoPlaces) {
    Scene scene = board(false);
    scene.instances.push_back(scene.instances.front());
    EXPECT_THAT(error_of([&] { bake(scene, {.voxel_size = 0.1}); }),
                testing::HasSubstr("it stands in the scene 2 times"));
}

}  // namespace
}  // namespace estara
