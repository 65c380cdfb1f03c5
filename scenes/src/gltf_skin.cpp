// Skins and morph targets of glTF.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gltf.h"

namespace estara {
namespace {

std::vector<glm::vec3> displacements(const tinygltf::Model& model,
                                     const std::map<std::string, int>& target, const char* name,
                                     std::size_t vertices, const std::string& where) {
    const auto found = target.find(name);
    if (found == target.end()) return {};
    const std::string here = fmt::format("{}: {}", where, name);
    const std::vector<float> values = read_floats(model, found->second, 3, here);
    if (values.size() != 3 * vertices) {
        throw Error(fmt::format("{}: {} for {} vertices", here, values.size() / 3, vertices));
    }
    std::vector<glm::vec3> result;
    for (std::size_t i = 0; i < vertices; ++i) {
        result.emplace_back(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
    }
    return result;
}

/// Four joints and weights of each vertex.
struct Four {
    std::vector<std::uint32_t> joints;
    std::vector<float> weights;
};

Four read_four(const tinygltf::Model& model, const tinygltf::Primitive& primitive, int set,
               std::size_t vertices, const std::string& where) {
    const auto joints = primitive.attributes.find(fmt::format("JOINTS_{}", set));
    const auto weights = primitive.attributes.find(fmt::format("WEIGHTS_{}", set));
    const auto end = primitive.attributes.end();
    if (joints == end && weights == end) return {};
    if (joints == end || weights == end) {
        throw Error(fmt::format("{}: JOINTS_{} and WEIGHTS_{} go together; one is missing", where,
                                set, set));
    }
    Four four;
    // Joints are small whole numbers: floats hold them.
    const std::vector<float> numbers =
        read_floats(model, joints->second, 4, fmt::format("{}: JOINTS_{}", where, set));
    four.joints.assign(numbers.begin(), numbers.end());
    four.weights =
        read_floats(model, weights->second, 4, fmt::format("{}: WEIGHTS_{}", where, set));
    if (four.joints.size() != 4 * vertices || four.weights.size() != 4 * vertices) {
        throw Error(
            fmt::format("{}: JOINTS_{} and WEIGHTS_{} must be given for each of {} vertices", where,
                        set, set, vertices));
    }
    return four;
}

/// Weights that sum to 1; all of the first joint's for a vertex that has none.
void normalize(float* weights, int count) {
    double sum = 0.0;
    for (int k = 0; k < count; ++k) {
        weights[k] = std::max(weights[k], 0.0f);
        sum += double(weights[k]);
    }
    for (int k = 0; k < count; ++k) weights[k] = sum > 0.0 ? float(weights[k] / sum) : 0.0f;
    if (!(sum > 0.0)) weights[0] = 1.0f;
}

Influences read_influences(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                           std::size_t vertices, const std::string& where) {
    const Four sets[2] = {read_four(model, primitive, 0, vertices, where),
                          read_four(model, primitive, 1, vertices, where)};
    Influences all;
    for (const Four& four : sets) all.count += four.joints.empty() ? 0 : 4;
    for (std::size_t i = 0; i < vertices && all.count > 0; ++i) {
        for (const Four& four : sets) {
            for (std::size_t k = 4 * i; k < 4 * (i + 1) && !four.joints.empty(); ++k) {
                all.joint.push_back(std::uint16_t(std::min(four.joints[k], 65535u)));
                all.weight.push_back(four.weights[k]);
            }
        }
        normalize(all.weight.data() + all.weight.size() - std::size_t(all.count), all.count);
    }
    return all;
}

}  // namespace

Deformation read_deformation(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                             std::size_t vertices, const std::string& where) {
    Deformation result;
    for (std::size_t t = 0; t < primitive.targets.size(); ++t) {
        const std::string here = fmt::format("{}: morph target {}", where, t);
        const auto& target = primitive.targets[t];
        MorphTarget morph{displacements(model, target, "POSITION", vertices, here),
                          displacements(model, target, "NORMAL", vertices, here)};
        if (morph.P.empty()) morph.P.assign(vertices, glm::vec3(0.0f));
        result.targets.push_back(std::move(morph));
    }
    result.influences = read_influences(model, primitive, vertices, where);
    return result;
}

Skin read_skin(const tinygltf::Model& model, int index, const std::vector<int>& ours,
               const std::string& path) {
    const tinygltf::Skin& from = gltf_element(model.skins, index, path, "skin");
    const std::string where =
        fmt::format("{}: {}", path, gltf_name("skin", from.name, std::size_t(index)));
    Skin skin;
    skin.name = from.name;
    if (from.joints.empty()) throw Error(where + ": no joints");
    for (const int joint : from.joints) {
        const int node = gltf_element(ours, joint, where, "node");
        if (node < 0) {
            throw Error(fmt::format(
                "{}: joint {} is not in the scene that is shown", where,
                gltf_name("node", model.nodes[std::size_t(joint)].name, std::size_t(joint))));
        }
        skin.joints.push_back(node);
    }
    skin.joint_from_rest.assign(skin.joints.size(), glm::mat4(1.0f));
    if (from.inverseBindMatrices == -1) return skin;
    const std::vector<float> values =
        read_floats(model, from.inverseBindMatrices, 16, where + ": inverse bind matrices");
    if (values.size() < 16 * skin.joints.size()) {
        throw Error(fmt::format("{}: {} inverse bind matrices for {} joints", where,
                                values.size() / 16, skin.joints.size()));
    }
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
        for (int k = 0; k < 16; ++k) {
            skin.joint_from_rest[j][k / 4][k % 4] = values[16 * j + std::size_t(k)];
        }
    }
    return skin;
}

void check_joints(const Object& object, const Skin& skin, const std::string& where) {
    const Influences& influences = object.bends.influences;
    for (std::size_t i = 0; i < influences.joint.size(); ++i) {
        if (influences.joint[i] < skin.joints.size()) continue;
        throw Error(fmt::format("{}: vertex {} follows joint {}; its skin has {}, counted from 0",
                                where, i / std::size_t(influences.count), influences.joint[i],
                                skin.joints.size()));
    }
}

}  // namespace estara
