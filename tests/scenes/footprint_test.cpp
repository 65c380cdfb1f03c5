#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "estara/scenes/ray_scene.h"
#include "ray_scenes.h"

namespace estara::test {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float yfov = 0.6f;
constexpr int width = 322, height = 182;

/// A camera at the origin that looks along -z. `after` moves it there at time 1.
void add_camera(Scene& scene, const glm::vec3& after) {
    Node node;
    node.translations.times = {0.0f, 1.0f};
    node.translations.values = {glm::vec3(0.0f), after};
    scene.nodes.push_back(node);
    scene.cameras.push_back({"camera", int(scene.nodes.size()) - 1, yfov});
}

glm::mat4 at_distance(float z, const glm::vec3& scale = glm::vec3(1.0f)) {
    return transform({0, 0, -z}, glm::quat(1, 0, 0, 0), scale);
}

/// Angle between pixels at the image centre.
double pixel_angle() { return 2.0 * std::tan(0.5 * yfov) / height; }

std::vector<float> footprints(const Scene& scene, const FrameRange& frames = {0, 0, 1}) {
    RayScene rays(scene);
    return smallest_footprints(scene, rays, 0, frames, 1.0, width, height);
}

TEST(SmallestFootprint, OfAPlaneThatFacesTheCameraIsDistanceTimesPixelAngle) {
    Scene scene = scene_of({panel(20, 20)}, {at_distance(7)});
    add_camera(scene, {});
    EXPECT_NEAR(footprints(scene)[0], 7.0 * pixel_angle(), 1e-3 * 7.0 * pixel_angle());
}

TEST(SmallestFootprint, IsInObjectSpaceByTheLargestStretch) {
    Scene scene = scene_of({panel(20, 20)}, {at_distance(7, {2.0f, 5.0f, 0.1f})});
    scene.nodes[0].matrix =
        *scene.nodes[0].matrix *
        glm::dmat4(glm::mat4_cast(glm::angleAxis(1.1f, glm::vec3(0.0f, 0.0f, 1.0f))));
    add_camera(scene, {});
    EXPECT_NEAR(footprints(scene)[0], 7.0 * pixel_angle() / 5.0, 1e-3 * pixel_angle());
}

TEST(SmallestFootprint, IsTheSmallestOverTheFrames) {
    Scene scene = scene_of({panel(20, 20)}, {at_distance(7)});
    add_camera(scene, {0, 0, -5});
    EXPECT_NEAR(footprints(scene, {0, 1, 1})[0], 2.0 * pixel_angle(), 1e-3 * 2.0 * pixel_angle());
    // Clocks stop at the last key.
    EXPECT_EQ(footprints(scene, {0, 1, 1}), footprints(scene, {0, 3, 1}));
    EXPECT_NEAR(footprints(scene, {0, 1, 2})[0], 7.0 * pixel_angle(), 1e-3 * 7.0 * pixel_angle());
}

TEST(SmallestFootprint, IsInfiniteForWhatNoPixelSees) {
    Scene scene = scene_of({panel(20, 20), panel(1, 1), panel(1, 1)},
                           {at_distance(7), at_distance(9), at_distance(-3)});
    add_camera(scene, {});
    const std::vector<float> found = footprints(scene);
    EXPECT_LT(found[0], inf);
    EXPECT_EQ(found[1], inf) << "hidden behind the first";
    EXPECT_EQ(found[2], inf) << "behind the camera";
}

TEST(SmallestFootprint, IsThatOfTheNearestInstance) {
    Scene scene = scene_of({panel(1, 1), panel(30, 30)}, {at_distance(4), at_distance(12)});
    scene.instances[1].object = 0;
    add_camera(scene, {});
    const std::vector<float> found = footprints(scene);
    EXPECT_NEAR(found[0], 4.0 * pixel_angle(), 1e-3 * 4.0 * pixel_angle());
    EXPECT_EQ(found[1], inf) << "no instance shows the second object";
}

TEST(SmallestFootprint, IsTheSameWithOneThreadAndFour) {
    Scene scene = scene_of({ball(20), panel(30, 30)},
                           {transform({0.2f, 0, -4}, slanted(), {1, 2, 0.5f}), at_distance(9)});
    add_camera(scene, {0.5f, 0.1f, -1});
    const auto with_threads = [&](std::size_t count) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, count);
        return footprints(scene, {0, 1, 1});
    };
    EXPECT_EQ(with_threads(1), with_threads(4));
}

TEST(SmallestFootprint, IsFoundInAnImageOfOnePixel) {
    Scene scene = scene_of({panel(20, 20)}, {at_distance(7)});
    add_camera(scene, {});
    RayScene rays(scene);
    const std::vector<float> found = smallest_footprints(scene, rays, 0, {0, 0, 1}, 1.0, 1, 1);
    EXPECT_NEAR(found[0], 7.0 * yfov, 1e-3 * 7.0 * yfov);
}

}  // namespace
}  // namespace estara::test
