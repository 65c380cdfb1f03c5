// Animation: key frames to matrices, and the view and lights they carry.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "estara/scenes/ray_scene.h"
#include "estara/scenes/scene.h"

namespace estara {
namespace {

float between(float a, float b, float s) { return glm::mix(a, b, s); }
glm::vec3 between(const glm::vec3& a, const glm::vec3& b, float s) { return glm::mix(a, b, s); }
glm::quat between(const glm::quat& a, const glm::quat& b, float s) {
    return glm::slerp(a, b, s);  // GLM's turns the shorter way round
}

float finished(float v) { return v; }
glm::vec3 finished(const glm::vec3& v) { return v; }
glm::quat finished(const glm::quat& q) {
    const float length = glm::length(q);
    return length > 0.0f ? q / length : glm::quat(1.0f, 0.0f, 0.0f, 0.0f);
}

/// Cubic Hermite spline between keys i and i + 1, glTF 2.0, appendix C.5: tangents are per second.
template <class T>
T hermite(const Track<T>& track, std::size_t i, float s, float duration) {
    const T& v0 = track.values[3 * i + 1];
    const T& out0 = track.values[3 * i + 2];
    const T& in1 = track.values[3 * i + 3];
    const T& v1 = track.values[3 * i + 4];
    const float s2 = s * s, s3 = s2 * s;
    return v0 * (2.0f * s3 - 3.0f * s2 + 1.0f) + out0 * (duration * (s3 - 2.0f * s2 + s)) +
           v1 * (3.0f * s2 - 2.0f * s3) + in1 * (duration * (s3 - s2));
}

/// Value of a track that is not empty.
template <class T>
T value_at(const Track<T>& track, double time) {
    const bool cubic = track.interpolation == Interpolation::cubic_spline;
    const auto key = [&](std::size_t i) { return track.values[cubic ? 3 * i + 1 : i]; };
    const std::size_t last = track.times.size() - 1;
    // A step's key is reached at its frame, though the file has its time as a float: of f / fps, or
    // of f times a float that is 1 / fps.
    if (track.interpolation == Interpolation::step) {
        const float rounded = float(time);
        time += 2.0 * (double(std::nextafter(rounded, std::numeric_limits<float>::infinity())) -
                       double(rounded));
    }
    if (!(time > double(track.times.front()))) return finished(key(0));  // also for NaN
    if (time >= double(track.times[last])) return finished(key(last));

    const auto after = std::upper_bound(track.times.begin(), track.times.end(), time,
                                        [](double t, float k) { return t < double(k); });
    const std::size_t i = std::size_t(after - track.times.begin()) - 1;
    if (track.interpolation == Interpolation::step) return finished(key(i));
    const double start = double(track.times[i]), duration = double(track.times[i + 1]) - start;
    const float s = float((time - start) / duration);
    if (cubic) return finished(hermite(track, i, s, float(duration)));
    return finished(between(key(i), key(i + 1), s));
}

glm::dmat4 parent_from_node(const Node& node, double time) {
    if (node.matrix) return *node.matrix;
    const glm::dvec3 t = node.translations.empty() ? node.translation
                                                   : glm::dvec3(value_at(node.translations, time));
    const glm::quat r = node.rotations.empty() ? node.rotation : value_at(node.rotations, time);
    const glm::dvec3 s(node.scales.empty() ? node.scale : value_at(node.scales, time));
    const glm::dmat3 turn = glm::mat3_cast(glm::normalize(glm::dquat(r)));
    return {glm::dvec4(turn[0] * s.x, 0.0), glm::dvec4(turn[1] * s.y, 0.0),
            glm::dvec4(turn[2] * s.z, 0.0), glm::dvec4(t, 1.0)};
}

std::vector<glm::dmat4> world_from_nodes(const Scene& scene, double time) {
    std::vector<glm::dmat4> world;
    world.reserve(scene.nodes.size());
    for (const Node& node : scene.nodes) {
        const glm::dmat4 local = parent_from_node(node, time);
        world.push_back(node.parent < 0 ? local : world[std::size_t(node.parent)] * local);
    }
    return world;
}

glm::mat4 seen_from(const glm::dvec3& origin, glm::dmat4 world_from_it) {
    world_from_it[3] -= glm::dvec4(origin, 0.0);
    return glm::mat4(world_from_it);
}

std::vector<float> weights_at(const Node& node, const Object& object, double time) {
    if (node.weight_tracks.empty()) return node.weights.empty() ? object.weights : node.weights;
    std::vector<float> weights;
    for (const Track<float>& track : node.weight_tracks) weights.push_back(value_at(track, time));
    return weights;
}

bool is_finite(const glm::mat4& m) {
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 3; ++r) {
            if (!std::isfinite(m[c][r])) return false;
        }
    }
    return true;
}

bool any_weight(const std::vector<float>& weights) {
    return std::any_of(weights.begin(), weights.end(), [](float w) { return w != 0.0f; });
}

void pose_instance(const Scene& scene, const Instance& instance, double time,
                   const glm::dvec3& origin, const std::vector<glm::dmat4>& world, Pose& pose) {
    const Object& object = scene.objects[std::size_t(instance.object)];
    const glm::dmat4& node = world[std::size_t(instance.node)];
    const glm::mat4 placed = seen_from(origin, node);
    const bool is_bent = bends(scene, instance);
    const bool is_flat = is_finite(placed) && !can_be_hit(placed);
    if (!is_bent && !is_flat) {
        pose.world_from_instance.push_back(placed);
        pose.bent.push_back(nullptr);
        return;
    }
    std::vector<glm::dmat4> joints;
    if (instance.skin >= 0) {
        const Skin& skin = scene.skins[std::size_t(instance.skin)];
        for (std::size_t j = 0; j < skin.joints.size(); ++j) {
            joints.push_back(world[std::size_t(skin.joints[j])] *
                             glm::dmat4(skin.joint_from_rest[j]));
        }
    }
    const Bent bent =
        bend(object.mesh, object.bends,
             weights_at(scene.nodes[std::size_t(instance.node)], object, time), node, joints);
    glm::dmat4 there(1.0);
    // What is not finite is nowhere, as is a matrix that is not.
    there[3] = bent.mesh ? glm::dvec4(bent.anchor, 1.0)
                         : glm::dvec4(glm::dvec3(std::numeric_limits<double>::infinity()), 1.0);
    pose.world_from_instance.push_back(seen_from(origin, there));
    pose.bent.push_back(bent.mesh);
}

/// Widens [first, last] to a track's keys.
template <class T>
void take_in(const Track<T>& track, double& first, double& last) {
    if (track.empty()) return;
    first = std::min(first, double(track.times.front()));
    last = std::max(last, double(track.times.back()));
}

int whole_frame(double frame) { return int(std::clamp(frame, -1e9, 1e9)); }

}  // namespace

std::optional<double> rate_of_keys(const Scene& scene) {
    std::vector<float> times;
    const auto add = [&](const auto& track) {
        times.insert(times.end(), track.times.begin(), track.times.end());
    };
    for (const Node& node : scene.nodes) {
        add(node.translations);
        add(node.rotations);
        add(node.scales);
        for (const Track<float>& track : node.weight_tracks) add(track);
    }
    // In thousandths of a frame beside the rounding of a float.
    const auto fits = [&](double rate) {
        return std::all_of(times.begin(), times.end(), [&](float time) {
            const double frame = double(time) * rate;
            return std::abs(frame - std::round(frame)) < 2e-3 + 1e-6 * std::abs(frame);
        });
    };
    if (fits(24.0)) return std::nullopt;
    for (const double rate : {25.0, 30.0, 12.0, 48.0, 50.0, 60.0, 24000.0 / 1001.0,
                              30000.0 / 1001.0, 60000.0 / 1001.0, 100.0, 120.0}) {
        if (fits(rate)) return rate;
    }
    return std::nullopt;
}

double frame_rate(Scene& scene, const std::optional<double>& given) {
    if (given) return *given;
    if (scene.fps) return *scene.fps;
    constexpr double usual = 24.0;
    if (const std::optional<double> rate = rate_of_keys(scene)) {
        scene.warnings.push_back(fmt::format(
            "{}: its keys lie on frames at {:.5g} a second, not at {}; --fps {:.5g}, or "
            "\"fps\" in the scene's extras, shows them so",
            scene.path, *rate, usual, *rate));
    }
    return usual;
}

Pose pose_at(const Scene& scene, double time, const glm::dvec3& origin) {
    const std::vector<glm::dmat4> world = world_from_nodes(scene, time);
    Pose pose;
    pose.origin = origin;
    pose.world_from_node.reserve(world.size());
    for (const glm::dmat4& node : world) pose.world_from_node.push_back(seen_from(origin, node));
    for (const Instance& instance : scene.instances) {
        pose_instance(scene, instance, time, origin, world, pose);
    }
    return pose;
}

glm::dvec3 place_of(const Scene& scene, int node, double time) {
    glm::dvec3 place(0.0);
    for (; node >= 0; node = scene.nodes[std::size_t(node)].parent) {
        place = glm::dvec3(parent_from_node(scene.nodes[std::size_t(node)], time) *
                           glm::dvec4(place, 1.0));
    }
    return place;
}

bool bends(const Scene& scene, const Instance& instance) {
    if (instance.skin >= 0) return true;
    const Object& object = scene.objects[std::size_t(instance.object)];
    if (object.bends.targets.empty()) return false;
    const Node& node = scene.nodes[std::size_t(instance.node)];
    if (node.weight_tracks.empty()) {
        return any_weight(node.weights.empty() ? object.weights : node.weights);
    }
    return std::any_of(node.weight_tracks.begin(), node.weight_tracks.end(),
                       [](const Track<float>& track) { return any_weight(track.values); });
}

FrameRange animated_frames(const Scene& scene, double fps) {
    double first = std::numeric_limits<double>::infinity(), last = -first;
    for (const Node& node : scene.nodes) {
        take_in(node.translations, first, last);
        take_in(node.rotations, first, last);
        take_in(node.scales, first, last);
        for (const Track<float>& track : node.weight_tracks) take_in(track, first, last);
    }
    if (first > last) return {};
    // Times are floats of f / fps: a key a thousandth of a frame late is on its frame.
    constexpr double tolerance = 1e-3;
    FrameRange frames;
    frames.first = whole_frame(std::ceil(first * fps - tolerance));
    frames.last = std::max(frames.first, whole_frame(std::floor(last * fps + tolerance)));
    return frames;
}

}  // namespace estara
