// Cameras and lights, placed in the world.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "estara/scenes/scene.h"

namespace estara {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

/// Blender and glTF give lumens, 683 of which are a watt of green light.
constexpr float lumens_per_watt = 683.0f;

/// Unit vector along v, or `otherwise` if v has no direction (a node scaled to nothing).
glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) noexcept {
    const double length = glm::length(glm::dvec3(v));
    return length > 0.0 && std::isfinite(length) ? glm::vec3(glm::dvec3(v) / length) : otherwise;
}

/// Share of a spot's light at an angle from its axis: KHR_lights_punctual's formula. Differs: the
/// specification's example code widens a soft edge to 0.001 of cosine, which would dim narrow
/// spots; ours takes it as it is.
float cone_share(const PosedLight& light, float cosine) noexcept {
    if (cosine <= light.cos_outer) return 0.0f;
    if (cosine >= light.cos_inner) return 1.0f;
    const float s = (cosine - light.cos_outer) / (light.cos_inner - light.cos_outer);
    return s * s;
}

/// KHR_lights_punctual, "Range Property".
float range_window(float distance, float range) noexcept {
    if (!(range > 0.0f)) return 1.0f;
    const float q = distance / range;
    return std::clamp(1.0f - q * q * q * q, 0.0f, 1.0f);
}

}  // namespace

std::vector<PosedLight> posed_lights(const Scene& scene, const Pose& pose) {
    std::vector<PosedLight> lights;
    for (const SceneLight& light : scene.lights) {
        const glm::mat4& world = pose.world_from_node[std::size_t(light.node)];
        lights.push_back({light.type, glm::vec3(world[3]),
                          unit_or(-glm::vec3(world[2]), glm::vec3(0.0f, 0.0f, -1.0f)),
                          light.color * (light.intensity / lumens_per_watt), light.range,
                          std::cos(light.inner_cone), std::cos(light.outer_cone)});
    }
    return lights;
}

LightSample sample_light(const PosedLight& light, const glm::vec3& point) noexcept {
    LightSample sample;
    if (light.type == LightType::directional) {
        sample.L = -light.direction;
        sample.distance = std::numeric_limits<float>::infinity();
        sample.Cl = light.color / pi;
        return sample;
    }
    const glm::vec3 to_light = light.position - point;
    const float distance2 = glm::dot(to_light, to_light);
    // At the light itself there is no direction; beyond the float's range there is no light.
    if (!(distance2 > std::numeric_limits<float>::min()) || !std::isfinite(distance2)) {
        return sample;
    }
    sample.distance = std::sqrt(distance2);
    sample.L = to_light / sample.distance;
    float share = range_window(sample.distance, light.range);
    if (light.type == LightType::spot) {
        share *= cone_share(light, -glm::dot(sample.L, light.direction));
    }
    sample.Cl = light.color * (share / (pi * distance2));
    return sample;
}

glm::vec3 PinholePose::direction(float x, float y, int width, int height) const noexcept {
    const float pixel = 2.0f * tan_half_yfov / float(height);
    return forward + right * ((x - 0.5f * float(width)) * pixel) +
           up * ((0.5f * float(height) - y) * pixel);
}

float PinholePose::pixel_angle(int height) const noexcept {
    return 2.0f * std::atan(tan_half_yfov / float(height));
}

PinholePose pinhole_pose(const Scene&, const SceneCamera& camera, const Pose& pose) {
    const glm::mat4& world = pose.world_from_node[std::size_t(camera.node)];
    PinholePose pinhole{};
    pinhole.eye = glm::vec3(world[3]);
    pinhole.forward = unit_or(-glm::vec3(world[2]), glm::vec3(0.0f, 0.0f, -1.0f));
    // Made orthonormal: a camera does not take part in the scale or shear of its parents.
    const glm::vec3 side =
        glm::cross(pinhole.forward, unit_or(glm::vec3(world[1]), glm::vec3(0.0f)));
    const glm::vec3 any = std::abs(pinhole.forward.y) < 0.9f ? glm::vec3(0.0f, 1.0f, 0.0f)
                                                             : glm::vec3(0.0f, 0.0f, 1.0f);
    pinhole.right =
        unit_or(side, unit_or(glm::cross(pinhole.forward, any), glm::vec3(1.0f, 0.0f, 0.0f)));
    pinhole.up = glm::cross(pinhole.right, pinhole.forward);
    pinhole.tan_half_yfov = std::tan(0.5f * camera.yfov);
    return pinhole;
}

}  // namespace estara
