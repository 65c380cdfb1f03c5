// Cameras and lights.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "estara/scenes/scene.h"

namespace estara {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

PinholePose pinhole(const Node& node, float yfov) {
    Scene scene;
    scene.nodes.push_back(node);
    return pinhole_pose(scene, {"c", 0, yfov}, pose_at(scene, 0));
}

TEST(Pinhole, LooksAlongMinusZWithYUp) {
    Node node;
    node.translation = {1, 2, 3};
    const PinholePose p = pinhole(node, 0.5f * pi);
    EXPECT_EQ(p.eye, glm::vec3(1, 2, 3));
    EXPECT_EQ(p.forward, glm::vec3(0, 0, -1));
    EXPECT_EQ(p.right, glm::vec3(1, 0, 0));
    EXPECT_EQ(p.up, glm::vec3(0, 1, 0));
    EXPECT_NEAR(p.tan_half_yfov, 1.0f, 1e-6f);
}

TEST(Pinhole, CornersSpanTheFieldOfView) {
    const PinholePose p = pinhole(Node{}, 0.5f * pi);
    const auto near = [](const glm::vec3& a, const glm::vec3& b) {
        EXPECT_NEAR(glm::distance(a, b), 0.0f, 1e-5f);
    };
    near(p.direction(100, 50, 200, 100), {0, 0, -1});
    near(p.direction(0, 0, 200, 100), {-2, 1, -1});
    near(p.direction(200, 100, 200, 100), {2, -1, -1});
}

TEST(Pinhole, DirectionsHaveOneAlongForward) {
    Node node;
    node.rotation = glm::normalize(glm::quat(0.3f, 0.5f, -0.7f, 0.2f));
    const PinholePose p = pinhole(node, 1.0f);
    for (const float x : {0.0f, 3.5f, 64.0f}) {
        EXPECT_NEAR(glm::dot(p.direction(x, 7.5f, 64, 48), p.forward), 1.0f, 1e-6f);
    }
}

TEST(Pinhole, PixelAngleIsThatBetweenRaysAPixelApart) {
    const PinholePose p = pinhole(Node{}, 0.9f);
    const glm::vec3 a = glm::normalize(p.direction(32, 23.5f, 64, 48));
    const glm::vec3 b = glm::normalize(p.direction(32, 24.5f, 64, 48));
    EXPECT_NEAR(p.pixel_angle(48), std::asin(glm::length(glm::cross(a, b))), 1e-6f);
}

TEST(Pinhole, StaysOrthonormalUnderScaleAndMirrors) {
    for (const glm::vec3 scale : {glm::vec3(3, 0.1f, 7), glm::vec3(-1, 1, 1), glm::vec3(0)}) {
        Node node;
        node.scale = scale;
        node.rotation = glm::normalize(glm::quat(0.3f, 0.5f, -0.7f, 0.2f));
        const PinholePose p = pinhole(node, 1.0f);
        const glm::mat3 frame(p.right, p.up, -p.forward);
        EXPECT_NEAR(glm::determinant(frame), 1.0f, 1e-5f);
        EXPECT_NEAR(glm::dot(p.right, p.up), 0.0f, 1e-6f);
        EXPECT_NEAR(glm::dot(p.right, p.forward), 0.0f, 1e-6f);
    }
}

PosedLight lamp(LightType type, float candela) {
    Scene scene;
    scene.nodes.emplace_back();
    SceneLight light;
    light.type = type;
    light.intensity = candela;
    light.color = {1.0f, 0.5f, 0.25f};
    scene.lights.push_back(light);
    return posed_lights(scene, pose_at(scene, 0)).front();
}

TEST(Light, OfPiTimes683LuxHasAClOfItsColor) {
    const PosedLight sun = lamp(LightType::directional, pi * 683.0f);
    const LightSample sample = sample_light(sun, {5, 5, 5});
    EXPECT_NEAR(glm::distance(sample.Cl, glm::vec3(1.0f, 0.5f, 0.25f)), 0.0f, 1e-6f);
    EXPECT_EQ(sample.L, glm::vec3(0, 0, 1));
    EXPECT_EQ(sample.distance, std::numeric_limits<float>::infinity());
}

TEST(Light, FallsWithTheSquareOfTheDistance) {
    const PosedLight bulb = lamp(LightType::point, 683.0f);
    for (const float distance : {0.5f, 1.0f, 20.0f}) {
        const LightSample sample = sample_light(bulb, {0, distance, 0});
        EXPECT_NEAR(sample.Cl.r * pi * distance * distance, 1.0f, 1e-5f);
        EXPECT_EQ(sample.L, glm::vec3(0, -1, 0));
        EXPECT_EQ(sample.distance, distance);
    }
}

TEST(Light, EndsAtItsRange) {
    PosedLight bulb = lamp(LightType::point, 683.0f);
    bulb.range = 2.0f;
    EXPECT_NEAR(sample_light(bulb, {1, 0, 0}).Cl.r, (1.0f - 1.0f / 16.0f) / pi, 1e-6f);
    EXPECT_EQ(sample_light(bulb, {2, 0, 0}).Cl, glm::vec3(0));
    EXPECT_EQ(sample_light(bulb, {3, 0, 0}).Cl, glm::vec3(0));
}

TEST(Light, IsNothingAtItself) {
    const LightSample sample = sample_light(lamp(LightType::point, 683.0f), {0, 0, 0});
    EXPECT_EQ(sample.Cl, glm::vec3(0));
    EXPECT_EQ(sample.L, glm::vec3(0));
}

TEST(Light, OfASpotIsFullInsideAndNothingOutside) {
    PosedLight spot = lamp(LightType::spot, 683.0f);
    spot.cos_inner = std::cos(0.2f);
    spot.cos_outer = std::cos(0.4f);
    const auto at = [&](float angle) {
        return sample_light(spot, {std::sin(angle), 0, -std::cos(angle)}).Cl.r * pi;
    };
    EXPECT_NEAR(at(0.0f), 1.0f, 1e-5f);
    EXPECT_NEAR(at(0.19f), 1.0f, 1e-5f);
    const float middle = (std::cos(0.3f) - std::cos(0.4f)) / (std::cos(0.2f) - std::cos(0.4f));
    EXPECT_NEAR(at(0.3f), middle * middle, 1e-4f);
    EXPECT_EQ(at(0.41f), 0.0f);
    EXPECT_EQ(at(pi), 0.0f);
}

TEST(Light, OfASpotWithAHardEdgeIsAStep) {
    PosedLight spot = lamp(LightType::spot, 683.0f);
    spot.cos_inner = spot.cos_outer = std::cos(0.4f);
    EXPECT_NEAR(sample_light(spot, {std::sin(0.39f), 0, -std::cos(0.39f)}).Cl.r * pi, 1.0f, 1e-5f);
    EXPECT_EQ(sample_light(spot, {std::sin(0.41f), 0, -std::cos(0.41f)}).Cl, glm::vec3(0));
}

TEST(Light, ShinesAlongItsNodesMinusZ) {
    Scene scene;
    Node node;
    node.translation = {0, 9, 0};
    node.rotation = glm::angleAxis(-0.5f * pi, glm::vec3(1, 0, 0));
    node.scale = {4, 4, 4};
    scene.nodes.push_back(node);
    scene.lights.emplace_back();
    const PosedLight light = posed_lights(scene, pose_at(scene, 0)).front();
    EXPECT_NEAR(glm::distance(light.direction, glm::vec3(0, -1, 0)), 0.0f, 1e-6f);
    EXPECT_EQ(light.position, glm::vec3(0, 9, 0));
}

}  // namespace
}  // namespace estara
