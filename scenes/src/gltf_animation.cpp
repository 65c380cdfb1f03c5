// Key frames of glTF nodes.
#include <fmt/format.h>

#include <algorithm>

#include "gltf.h"

namespace estara {
namespace {

Interpolation interpolation_named(const std::string& name, const std::string& where) {
    if (name.empty() || name == "LINEAR") return Interpolation::linear;
    if (name == "STEP") return Interpolation::step;
    if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
    throw Error(fmt::format("{}: interpolation '{}'; there are LINEAR, STEP and CUBICSPLINE", where,
                            one_line(name)));
}

float value_from(const float* v, const float&) { return v[0]; }
glm::vec3 value_from(const float* v, const glm::vec3&) { return {v[0], v[1], v[2]}; }
glm::quat value_from(const float* v, const glm::quat&) { return {v[3], v[0], v[1], v[2]}; }

void check_times(const std::vector<float>& times, const std::string& where) {
    if (times.empty()) throw Error(fmt::format("{}: no keys", where));
    for (std::size_t i = 1; i < times.size(); ++i) {
        if (times[i - 1] < times[i]) continue;
        throw Error(fmt::format("{}: key {} is at {} s, not after the one before ({} s)", where, i,
                                times[i], times[i - 1]));
    }
}

/// The tracks of a sampler's output: `count` values a key, one for each of as many tracks (morph
/// targets; 1 of everything else). A cubic spline has three times as many: all in-tangents of a key
/// come first, then its values.
template <class T>
std::vector<Track<T>> read_tracks(const tinygltf::Model& model,
                                  const tinygltf::AnimationSampler& sampler,
                                  const std::string& where, std::size_t count) {
    constexpr std::size_t components = sizeof(T) / sizeof(float);
    Track<T> track;
    track.interpolation = interpolation_named(sampler.interpolation, where);
    track.times = read_floats(model, sampler.input, 1, where + ": times");
    check_times(track.times, where);
    const std::vector<float> values =
        read_floats(model, sampler.output, int(components), where + ": values");
    const std::size_t parts = track.interpolation == Interpolation::cubic_spline ? 3 : 1;
    const std::size_t a_key = parts * count;
    if (values.size() != track.times.size() * a_key * components) {
        throw Error(fmt::format("{}: {} values for {} keys; it needs {} a key", where,
                                values.size() / components, track.times.size(), a_key));
    }
    std::vector<Track<T>> tracks(count, track);
    for (std::size_t i = 0; i < values.size() / components; ++i) {
        tracks[i % count].values.push_back(value_from(values.data() + i * components, T{}));
    }
    return tracks;
}

template <class T>
void read_track(const tinygltf::Model& model, const tinygltf::AnimationSampler& sampler,
                const std::string& where, Track<T>& track) {
    track = std::move(read_tracks<T>(model, sampler, where, 1).front());
}

/// How many morph targets a node's mesh has.
std::size_t targets_of(const tinygltf::Model& model, int node) {
    const int mesh = model.nodes[std::size_t(node)].mesh;
    if (mesh < 0 || std::size_t(mesh) >= model.meshes.size()) return 0;
    std::size_t most = 0;
    for (const tinygltf::Primitive& primitive : model.meshes[std::size_t(mesh)].primitives) {
        most = std::max(most, primitive.targets.size());
    }
    return most;
}

void check_rotations(const Track<glm::quat>& track, const std::string& where) {
    const bool cubic = track.interpolation == Interpolation::cubic_spline;
    for (std::size_t i = 0; i < track.times.size(); ++i) {
        if (glm::length(track.values[cubic ? 3 * i + 1 : i]) > 0.0f) continue;
        throw Error(fmt::format("{}: the rotation of key {} is zero", where, i));
    }
}

/// What happens to animations that are not shown.
enum class Outcome { taken, unknown_path, taken_before, has_matrix };

Outcome read_channel(const tinygltf::Model& model, const tinygltf::AnimationChannel& channel,
                     const tinygltf::AnimationSampler& sampler, const std::string& where,
                     Node& node) {
    const std::string& path = channel.target_path;
    if (path == "weights") {
        const std::size_t targets = targets_of(model, channel.target_node);
        if (targets == 0) return Outcome::unknown_path;
        if (!node.weight_tracks.empty()) return Outcome::taken_before;
        node.weight_tracks = read_tracks<float>(model, sampler, where, targets);
        return Outcome::taken;
    }
    if (path != "translation" && path != "rotation" && path != "scale") {
        return Outcome::unknown_path;
    }
    if (node.matrix) return Outcome::has_matrix;
    const bool before = path == "translation" ? !node.translations.empty()
                        : path == "rotation"  ? !node.rotations.empty()
                                              : !node.scales.empty();
    if (before) return Outcome::taken_before;
    if (path == "translation") read_track(model, sampler, where, node.translations);
    if (path == "scale") read_track(model, sampler, where, node.scales);
    if (path == "rotation") {
        read_track(model, sampler, where, node.rotations);
        check_rotations(node.rotations, where);
    }
    return Outcome::taken;
}

}  // namespace

void read_animations(const tinygltf::Model& model, const std::vector<int>& ours, Scene& scene) {
    for (std::size_t a = 0; a < model.animations.size(); ++a) {
        const tinygltf::Animation& animation = model.animations[a];
        const std::string where =
            fmt::format("{}: {}", scene.path, gltf_name("animation", animation.name, a));
        int left_out = 0, on_matrix = 0, twice = 0;
        for (const tinygltf::AnimationChannel& channel : animation.channels) {
            const int target = gltf_element(ours, channel.target_node, where, "node");
            const auto& sampler =
                gltf_element(animation.samplers, channel.sampler, where, "sampler");
            if (target < 0) continue;
            Node& node = scene.nodes[std::size_t(target)];
            switch (read_channel(model, channel, sampler,
                                 fmt::format("{}: {} of node \"{}\"", where,
                                             one_line(channel.target_path), one_line(node.name)),
                                 node)) {
                case Outcome::taken:
                    break;
                case Outcome::unknown_path:
                    ++left_out;
                    break;
                case Outcome::taken_before:
                    ++twice;
                    break;
                case Outcome::has_matrix:
                    ++on_matrix;
                    break;
            }
        }
        if (left_out > 0) {
            scene.warnings.push_back(fmt::format(
                "{}: {} channels move neither place, rotation, scale nor shape; not shown", where,
                left_out));
        }
        if (twice > 0) {
            scene.warnings.push_back(fmt::format(
                "{}: {} channels move what an earlier animation moves; not shown", where, twice));
        }
        if (on_matrix > 0) {
            scene.warnings.push_back(fmt::format(
                "{}: {} channels move nodes with a matrix; not shown", where, on_matrix));
        }
    }
}

}  // namespace estara
