// Cameras and lights, placed in the world.
#include <cmath>

#include "estara/scenes/scene.h"

namespace estara {
namespace {

/// Blender and glTF give lumens, 683 of which are a watt of green light.
constexpr float lumens_per_watt = 683.0f;

/// Unit vector along v, or `otherwise` if v has no direction (a node scaled to nothing).
glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) noexcept {
    const double length = glm::length(glm::dvec3(v));
    return length > 0.0 && std::isfinite(length) ? glm::vec3(glm::dvec3(v) / length) : otherwise;
}

}  // namespace

std::vector<PosedLight> posed_lights(const Scene& scene, const Pose& pose) {
    std::vector<PosedLight> lights;
    for (const SceneLight& light : scene.lights) {
        const glm::mat4& world = pose.world_from_node[std::size_t(light.node)];
        lights.push_back({light.type, glm::vec3(world[3]),
                          unit_or(-glm::vec3(world[2]), glm::vec3(0.0f, 0.0f, -1.0f)),
                          light.color * (light.intensity / lumens_per_watt), light.range,
                          std::cos(light.inner_cone), std::cos(light.outer_cone), light.shadow});
    }
    return lights;
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
