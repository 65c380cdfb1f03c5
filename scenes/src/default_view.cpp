// Camera and lights for scenes that bring none.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "estara/scenes/static_light.h"
#include "loaders.h"

namespace estara {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double fps = 24.0;
constexpr int turn_frames = 48;
constexpr float yfov = 0.7f;        // 40 degrees: a portrait lens
constexpr float elevation = 0.35f;  // 20 degrees from above
constexpr float margin = 1.05f;     // of the picture around the object

struct Sphere {
    glm::dvec3 center{0.0};
    double radius = 1.0;
};

template <class F>
void for_each_world_point(const Scene& scene, const Pose& pose, F f) {
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const std::vector<glm::vec3>& vertices = placed_vertices(scene, pose, i);
        const glm::dmat4 world(pose.world_from_instance[i]);
        const Object& object = scene.objects[std::size_t(scene.instances[i].object)];
        for (const glm::uvec3& t : object.mesh.triangles) {
            for (int k = 0; k < 3; ++k) f(glm::dvec3(world * glm::dvec4(vertices[t[k]], 1.0)));
        }
    }
}

/// A sphere around all that is to be seen at time 0: the same from every side of the orbit.
Sphere around(const Scene& scene) {
    if (scene.instances.empty()) return {};
    const glm::dvec3 origin = near_origin(scene);
    const Pose pose = pose_at(scene, 0.0, origin);
    glm::dvec3 low(std::numeric_limits<double>::max()), high(-low);
    for_each_world_point(scene, pose, [&](const glm::dvec3& p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    });
    if (low.x > high.x) return {};
    Sphere sphere{0.5 * low + 0.5 * high, 0.0};
    for_each_world_point(scene, pose, [&](const glm::dvec3& p) {
        sphere.radius = std::max(sphere.radius, glm::distance(p, sphere.center));
    });
    if (!(sphere.radius > 0.0)) sphere.radius = 1.0;
    sphere.center += origin;
    return sphere;
}

int add_node(Scene& scene, Node node) {
    scene.nodes.push_back(std::move(node));
    return int(scene.nodes.size()) - 1;
}

/// Rotations about the y axis: one turn, whose end would be frame 49 = frame 1.
Track<glm::quat> one_turn() {
    Track<glm::quat> track;
    for (const int frame : {1, 13, 25, 37, 48}) {  // never half a turn between two keys
        track.times.push_back(float(frame / fps));
        track.values.push_back(glm::angleAxis(float(2.0 * pi * (frame - 1) / turn_frames),
                                              glm::vec3(0.0f, 1.0f, 0.0f)));
    }
    return track;
}

/// A directional light from an azimuth (0: the first frame's camera, positive: to its right) and
/// an elevation, degrees, with an irradiance of pi Cl.
void add_sun(Scene& scene, const char* name, float azimuth, float height, float Cl) {
    Node node;
    node.name = name;
    node.rotation = glm::angleAxis(glm::radians(azimuth), glm::vec3(0.0f, 1.0f, 0.0f)) *
                    glm::angleAxis(glm::radians(-height), glm::vec3(1.0f, 0.0f, 0.0f));
    SceneLight light;
    light.name = name;
    light.type = LightType::directional;
    light.node = add_node(scene, std::move(node));
    light.intensity = float(Cl * pi * 683.0);  // lux
    scene.lights.push_back(std::move(light));
}

}  // namespace

void add_orbit_camera(Scene& scene) {
    const Sphere sphere = around(scene);
    Node orbit;
    orbit.name = "orbit";
    orbit.translation = sphere.center;
    orbit.rotations = one_turn();
    const int orbit_node = add_node(scene, std::move(orbit));

    const double distance = margin * sphere.radius / std::sin(0.5 * yfov);
    Node arm;
    arm.name = "orbit_camera";
    arm.parent = orbit_node;
    arm.translation = distance * glm::dvec3(0.0, std::sin(elevation), std::cos(elevation));
    arm.rotation = glm::angleAxis(-elevation, glm::vec3(1.0f, 0.0f, 0.0f));
    const int arm_node = add_node(scene, std::move(arm));
    scene.cameras.push_back({"orbit", arm_node, yfov});
}

void add_studio_lights(Scene& scene) {
    // Of a surface that reflects a quarter (grey 0.5 under Kd 0.5), the key's highest radiance is
    // 0.4 and the fill's 0.15: both sides of the orbit lie in the middle of what a screen shows.
    add_sun(scene, "key", -35.0f, 45.0f, 1.6f);
    add_sun(scene, "fill", 140.0f, 20.0f, 0.6f);
}

}  // namespace estara
