// Animation: key frames to matrices, and the view and lights they carry.
#include <algorithm>
#include <cmath>
#include <limits>

#include "estara/scenes/scene.h"

namespace estara {
namespace {

glm::vec3 between(const glm::vec3& a, const glm::vec3& b, float s) { return glm::mix(a, b, s); }
glm::quat between(const glm::quat& a, const glm::quat& b, float s) {
    return glm::slerp(a, b, s);  // GLM's turns the shorter way round
}

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

glm::mat4 parent_from_node(const Node& node, double time) {
    if (node.matrix) return *node.matrix;
    const glm::vec3 t =
        node.translations.empty() ? node.translation : value_at(node.translations, time);
    const glm::quat r = node.rotations.empty() ? node.rotation : value_at(node.rotations, time);
    const glm::vec3 s = node.scales.empty() ? node.scale : value_at(node.scales, time);
    const glm::mat3 turn = glm::mat3_cast(r);
    return {glm::vec4(turn[0] * s.x, 0.0f), glm::vec4(turn[1] * s.y, 0.0f),
            glm::vec4(turn[2] * s.z, 0.0f), glm::vec4(t, 1.0f)};
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

Pose pose_at(const Scene& scene, double time) {
    Pose pose;
    pose.world_from_node.reserve(scene.nodes.size());
    for (const Node& node : scene.nodes) {
        const glm::mat4 local = parent_from_node(node, time);
        pose.world_from_node.push_back(
            node.parent < 0 ? local : pose.world_from_node[std::size_t(node.parent)] * local);
    }
    return pose;
}

FrameRange animated_frames(const Scene& scene, double fps) {
    double first = std::numeric_limits<double>::infinity(), last = -first;
    for (const Node& node : scene.nodes) {
        take_in(node.translations, first, last);
        take_in(node.rotations, first, last);
        take_in(node.scales, first, last);
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
