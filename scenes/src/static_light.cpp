#include "estara/scenes/static_light.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "estara/scenes/matrix.h"

namespace estara {
namespace {

glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) noexcept {
    const double length = glm::length(glm::dvec3(v));
    return length > 0.0 && std::isfinite(length) ? glm::vec3(glm::dvec3(v) / length) : otherwise;
}

template <class T>
bool changes(const Track<T>& track) noexcept {
    return std::any_of(track.values.begin(), track.values.end(),
                       [&](const T& value) { return value != track.values.front(); });
}

bool is_animated(const Node& node) noexcept {
    return changes(node.translations) || changes(node.rotations) || changes(node.scales) ||
           std::any_of(node.weight_tracks.begin(), node.weight_tracks.end(),
                       [](const Track<float>& track) { return changes(track); });
}

/// The nearest node, from this one upwards, that moves; or "".
std::string moving_from(const Scene& scene, int node) {
    for (; node >= 0; node = scene.nodes[std::size_t(node)].parent) {
        const Node& it = scene.nodes[std::size_t(node)];
        if (is_animated(it)) return it.name.empty() ? fmt::format("node {}", node) : it.name;
    }
    return "";
}

}  // namespace

std::string moving_node(const Scene& scene) {
    for (const Instance& instance : scene.instances) {
        std::vector<int> movers{instance.node};  // what a skin carries follows its joints alone
        if (instance.skin >= 0) movers = scene.skins[std::size_t(instance.skin)].joints;
        for (const int node : movers) {
            const std::string moving = moving_from(scene, node);
            if (!moving.empty()) return moving;
        }
    }
    for (const SceneLight& light : scene.lights) {
        const std::string moving = moving_from(scene, light.node);
        if (!moving.empty()) return moving;
    }
    return "";
}

std::string why_no_static_light(const Scene& scene, int object) {
    const std::vector<int> instances = instances_of(scene, object);
    if (instances.size() != 1) {
        return fmt::format("it stands in the scene {} times, and light differs from place to place",
                           instances.size());
    }
    const auto instance = std::size_t(instances.front());
    if (bends(scene, scene.instances[instance])) {
        return "it bends, and light is baked on the shape that it has at rest";
    }
    return pose_at(scene, 0.0).bent[instance] ? "its node squeezes it flat" : "";
}

glm::dvec3 near_origin(const Scene& scene) {
    return scene.instances.empty() ? glm::dvec3(0.0)
                                   : place_of(scene, scene.instances.front().node, 0.0);
}

std::string lights_digest(const Scene& scene, int instance) {
    std::string text = std::to_string(instance);
    const auto add = [&text](const void* data, std::size_t bytes) {
        text.append(static_cast<const char*>(data), bytes);
    };
    const Pose pose = pose_at(scene, 0.0, near_origin(scene));
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        add(&pose.world_from_instance[i], sizeof(glm::mat4));
        text += std::to_string(scene.instances[i].object) + ';';
        if (pose.bent[i]) add(pose.bent[i]->P.data(), pose.bent[i]->P.size() * sizeof(glm::vec3));
    }
    for (const Object& object : scene.objects) text += mesh_digest(object.mesh);
    for (const PosedLight& light : posed_lights(scene, pose)) {
        text += std::to_string(int(light.type)) + (light.shadow ? 's' : 'n');
        add(&light.position, sizeof light.position);
        add(&light.direction, sizeof light.direction);
        add(&light.color, sizeof light.color);
        for (const float v : {light.range, light.cos_inner, light.cos_outer}) add(&v, sizeof v);
    }
    return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

StaticLight::StaticLight(const Scene& scene, const RayScene& rays, int instance)
    : StaticLight(scene, rays, pose_at(scene, 0.0, rays.origin()), instance) {}

StaticLight::StaticLight(const Scene& scene, const RayScene& rays, const Pose& pose, int instance)
    : m_rays(rays),
      m_world_from_object(pose.world_from_instance[std::size_t(instance)]),
      m_world_from_normal(normal_matrix(glm::dmat3(glm::mat3(m_world_from_object)))),
      m_offset(m_world_from_object),
      m_lights(posed_lights(scene, pose)) {}

void StaticLight::irradiance(std::span<const MeshPoint> points, glm::vec3* E) const {
    std::fill_n(E, points.size(), glm::vec3(0.0f));
    for (std::size_t first = 0; first < points.size(); first += RayBatch::capacity) {
        const std::size_t size = std::min<std::size_t>(RayBatch::capacity, points.size() - first);
        for (const PosedLight& light : m_lights) add(light, points.subspan(first, size), E + first);
    }
}

void StaticLight::add(const PosedLight& light, std::span<const MeshPoint> points,
                      glm::vec3* E) const {
    thread_local RayBatch rays;
    thread_local std::uint8_t blocked[RayBatch::capacity];
    thread_local std::vector<std::pair<std::size_t, glm::vec3>>
        reached;  // point, what would arrive
    rays.size = 0;
    reached.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const MeshPoint& point = points[i];
        const glm::vec3 P(m_world_from_object * glm::vec4(point.P, 1.0f));
        const glm::vec3 Ng = unit_or(m_world_from_normal * point.Ng, glm::vec3(0.0f, 0.0f, 1.0f));
        const glm::vec3 N = unit_or(m_world_from_normal * point.N, Ng);
        const FallingLight falling = falling_light(light, P, N);
        if (falling.Cl == glm::vec3(0.0f)) continue;
        reached.push_back({i, falling.Cl * falling.cosine});
        const glm::vec3 side = glm::dot(Ng, falling.L) < 0.0f ? -Ng : Ng;
        rays.push(shadow_ray(light, m_offset.from(P, side, point.P), falling.L));
    }
    if (light.shadow) {
        m_rays.occluded(rays, blocked);
    } else {
        std::fill_n(blocked, rays.size, std::uint8_t{0});
    }
    for (std::size_t r = 0; r < reached.size(); ++r) {
        if (!blocked[r]) E[reached[r].first] += reached[r].second;
    }
}

}  // namespace estara
