// Key frames: glTF 2.0, appendix C.
#include <gtest/gtest.h>

#include <numbers>

#include "estara/scenes/scene.h"

namespace estara {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

Scene scene_with(const Node& node) {
    Scene scene;
    scene.nodes.push_back(node);
    return scene;
}

glm::vec3 place(const Node& node, double time) {
    return glm::vec3(pose_at(scene_with(node), time).world_from_node[0][3]);
}

/// Where the node's x axis points to.
glm::vec3 x_axis(const Node& node, double time) {
    return glm::vec3(pose_at(scene_with(node), time).world_from_node[0][0]);
}

glm::quat about_y(float angle) { return glm::angleAxis(angle, glm::vec3(0, 1, 0)); }

Node moved(Interpolation interpolation, std::vector<float> times, std::vector<glm::vec3> values) {
    Node node;
    node.translations = {interpolation, std::move(times), std::move(values)};
    return node;
}

TEST(Pose, HasTheKeysValuesAtTheKeys) {
    const Node node = moved(Interpolation::linear, {1, 2, 4}, {{1, 0, 0}, {5, 0, 0}, {7, 0, 0}});
    EXPECT_EQ(place(node, 1), glm::vec3(1, 0, 0));
    EXPECT_EQ(place(node, 2), glm::vec3(5, 0, 0));
    EXPECT_EQ(place(node, 4), glm::vec3(7, 0, 0));
}

TEST(Pose, IsLinearBetweenKeys) {
    const Node node = moved(Interpolation::linear, {1, 2, 4}, {{1, 0, 0}, {5, 0, 0}, {7, 0, 0}});
    EXPECT_EQ(place(node, 1.25), glm::vec3(2, 0, 0));
    EXPECT_EQ(place(node, 3), glm::vec3(6, 0, 0));
}

TEST(Pose, HoldsTheEndsBeforeAndAfter) {
    const Node node = moved(Interpolation::linear, {1, 2}, {{1, 0, 0}, {5, 0, 0}});
    EXPECT_EQ(place(node, -3), glm::vec3(1, 0, 0));
    EXPECT_EQ(place(node, 99), glm::vec3(5, 0, 0));
    EXPECT_EQ(place(moved(Interpolation::cubic_spline, {1}, {{9, 9, 9}, {2, 0, 0}, {9, 9, 9}}), 5),
              glm::vec3(2, 0, 0));
}

TEST(Pose, StepsAtTheFrameOfAKeyThatIsAFloat) {
    for (const double fps : {24.0, 25.0, 30.0, 59.94}) {
        for (int frame = 1; frame <= 500; ++frame) {
            // As exporters write it: rounded, or multiplied in float.
            for (const float key : {float(frame / fps), float(frame) * float(1.0 / fps)}) {
                const Node node = moved(Interpolation::step, {0, key}, {{1, 0, 0}, {5, 0, 0}});
                EXPECT_EQ(place(node, frame / fps).x, 5.0f) << frame << " at " << fps;
                EXPECT_EQ(place(node, (frame - 0.01) / fps).x, 1.0f) << frame << " at " << fps;
            }
        }
    }
}

TEST(Pose, StepsAtTheKey) {
    const Node node = moved(Interpolation::step, {1, 2}, {{1, 0, 0}, {5, 0, 0}});
    EXPECT_EQ(place(node, 1.999), glm::vec3(1, 0, 0));
    EXPECT_EQ(place(node, 2), glm::vec3(5, 0, 0));
}

TEST(Pose, CubicSplineReproducesACubic) {
    // x = t^3 on [1, 3]: tangents 3 t^2 per second.
    const Node node = moved(Interpolation::cubic_spline, {1, 3},
                            {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {27, 0, 0}, {27, 0, 0}, {0, 0, 0}});
    for (const double t : {1.0, 1.5, 2.0, 2.75, 3.0}) {
        EXPECT_NEAR(place(node, t).x, t * t * t, 1e-5) << t;
    }
}

TEST(Pose, RotatesAtConstantSpeed) {
    Node node;
    node.rotations = {Interpolation::linear, {0, 1}, {about_y(0), about_y(0.8f * pi)}};
    for (const float t : {0.25f, 0.5f, 0.9f}) {
        const float angle = 0.8f * pi * t;
        const glm::vec3 expected(std::cos(angle), 0, -std::sin(angle));
        EXPECT_NEAR(glm::distance(x_axis(node, double(t)), expected), 0.0f, 1e-6f) << t;
    }
}

TEST(Pose, TurnsTheShorterWayRound) {
    Node node;
    node.rotations = {Interpolation::linear, {0, 1}, {about_y(0), -about_y(0.5f * pi)}};
    const glm::vec3 expected(std::cos(0.25f * pi), 0, -std::sin(0.25f * pi));
    EXPECT_NEAR(glm::distance(x_axis(node, 0.5), expected), 0.0f, 1e-6f);
}

TEST(Pose, CubicRotationsStayRotations) {
    Node node;
    const glm::quat zero(0, 0, 0, 0);
    node.rotations = {Interpolation::cubic_spline,
                      {0, 1},
                      {zero, about_y(0), zero, zero, about_y(0.9f * pi), zero}};
    const glm::mat3 m(pose_at(scene_with(node), 0.3).world_from_node[0]);
    EXPECT_NEAR(glm::determinant(m), 1.0f, 1e-5f);
}

TEST(Pose, MultipliesDownTheHierarchy) {
    Scene scene;
    Node parent, child;
    parent.translation = {10, 0, 0};
    parent.rotation = about_y(0.5f * pi);
    parent.scale = {2, 2, 2};
    child.parent = 0;
    child.translation = {1, 0, 0};
    scene.nodes = {parent, child};
    const glm::vec3 p(pose_at(scene, 0).world_from_node[1][3]);
    EXPECT_NEAR(glm::distance(p, glm::vec3(10, 0, -2)), 0.0f, 1e-5f);
}

TEST(Pose, ScalesBeforeItTurns) {
    Node node;
    node.scale = {3, 1, -1};
    node.rotation = about_y(0.5f * pi);
    const glm::mat4 m = pose_at(scene_with(node), 0).world_from_node[0];
    EXPECT_NEAR(glm::distance(glm::vec3(m * glm::vec4(1, 0, 0, 1)), glm::vec3(0, 0, -3)), 0, 1e-6f);
    EXPECT_LT(glm::determinant(m), 0.0f);
}

TEST(Pose, TakesAMatrixAsItIs) {
    Node node;
    node.matrix = glm::mat4(2.0f);
    EXPECT_EQ(pose_at(scene_with(node), 7).world_from_node[0], glm::mat4(2.0f));
}

TEST(AnimatedFrames, AreTheFramesBetweenTheKeys) {
    const float frame = 1.0f / 24.0f;
    const Node node = moved(Interpolation::linear, {3 * frame, 40 * frame}, {{}, {}});
    EXPECT_EQ(animated_frames(scene_with(node), 24).first, 3);
    EXPECT_EQ(animated_frames(scene_with(node), 24).last, 40);
    EXPECT_EQ(animated_frames(scene_with(node), 24).step, 1);
}

TEST(AnimatedFrames, AreInsideKeysThatLieBetweenFrames) {
    const Node node = moved(Interpolation::linear, {0.26f, 0.99f}, {{}, {}});
    EXPECT_EQ(animated_frames(scene_with(node), 10).first, 3);
    EXPECT_EQ(animated_frames(scene_with(node), 10).last, 9);
}

TEST(AnimatedFrames, AreOneWithoutAnimation) {
    EXPECT_EQ(animated_frames(scene_with(Node{}), 24).first, 1);
    EXPECT_EQ(animated_frames(scene_with(Node{}), 24).last, 1);
}

TEST(AnimatedFrames, DoNotOverflow) {
    const Node node = moved(Interpolation::linear, {0, 1e30f}, {{}, {}});
    EXPECT_EQ(animated_frames(scene_with(node), 24).last, 1000000000);
}

}  // namespace
}  // namespace estara
