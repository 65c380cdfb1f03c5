// Where glTF nodes show their meshes: visibility, instances of one node, quantised positions.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "gltf.h"

namespace estara {
namespace {

constexpr const char* instancing = "EXT_mesh_gpu_instancing";

/// The accessors that an instancing extension names; "where" for messages.
std::vector<float> instance_values(const tinygltf::Model& model, const tinygltf::Value& attributes,
                                   const char* name, int components, const std::string& where) {
    if (!attributes.Has(name)) return {};
    const tinygltf::Value& index = attributes.Get(name);
    return read_floats(model, index.IsInt() ? index.GetNumberAsInt() : -1, components,
                       fmt::format("{}: {}: {}", where, instancing, name));
}

bool has_integer_positions(const tinygltf::Model& model, int mesh) {
    const auto& primitives = model.meshes[std::size_t(mesh)].primitives;
    return std::any_of(primitives.begin(), primitives.end(), [&](const auto& primitive) {
        const auto found = primitive.attributes.find("POSITION");
        if (found == primitive.attributes.end()) return false;
        const auto index = std::size_t(found->second);
        return index < model.accessors.size() &&
               model.accessors[index].componentType != TINYGLTF_COMPONENT_TYPE_FLOAT;
    });
}

}  // namespace

bool is_hidden(const tinygltf::Node& node) {
    const auto found = node.extensions.find("KHR_node_visibility");
    if (found == node.extensions.end() || !found->second.Has("visible")) return false;
    const tinygltf::Value& visible = found->second.Get("visible");
    return visible.IsBool() && !visible.Get<bool>();
}

std::vector<Node> instances_of_node(const tinygltf::Model& model, const tinygltf::Node& node,
                                    const std::string& where) {
    const auto found = node.extensions.find(instancing);
    if (found == node.extensions.end()) return {};
    const tinygltf::Value& attributes = found->second.Get("attributes");
    const std::vector<float> t = instance_values(model, attributes, "TRANSLATION", 3, where);
    const std::vector<float> r = instance_values(model, attributes, "ROTATION", 4, where);
    const std::vector<float> s = instance_values(model, attributes, "SCALE", 3, where);
    const std::size_t count = std::max({t.size() / 3, r.size() / 4, s.size() / 3});
    for (const auto& [size, name] :
         {std::pair(t.size() / 3, "TRANSLATION"), std::pair(r.size() / 4, "ROTATION"),
          std::pair(s.size() / 3, "SCALE")}) {
        if (size == 0 || size == count) continue;
        throw Error(
            fmt::format("{}: {}: {} of {} for {} instances", where, instancing, size, name, count));
    }
    std::vector<Node> nodes(count);
    for (std::size_t i = 0; i < count; ++i) {
        Node& one = nodes[i];
        if (!t.empty()) one.translation = {t[3 * i], t[3 * i + 1], t[3 * i + 2]};
        if (!s.empty()) one.scale = {s[3 * i], s[3 * i + 1], s[3 * i + 2]};
        if (r.empty()) continue;
        const glm::quat q(r[4 * i + 3], r[4 * i], r[4 * i + 1], r[4 * i + 2]);
        const float length = glm::length(q);
        if (!(length > 0.0f)) {
            throw Error(fmt::format("{}: {}: ROTATION {} is zero", where, instancing, i));
        }
        one.rotation = q / length;
    }
    return nodes;
}

Dequantization dequantization_of(const tinygltf::Model& model, const tinygltf::Node& node,
                                 const Node& ours) {
    Dequantization result;
    if (node.skin != -1 || ours.matrix || !has_integer_positions(model, node.mesh)) return result;
    const bool grows = ours.scale.x > 0.0f && ours.scale.y > 0.0f && ours.scale.z > 0.0f;
    if (!grows || !ours.scales.empty()) return result;
    result.scale = ours.scale;
    const bool turned = ours.rotation != glm::quat(1.0f, 0.0f, 0.0f, 0.0f);
    const bool moves = !ours.translations.empty() || !ours.rotations.empty();
    if (!turned && !moves) result.translation = glm::vec3(ours.translation);
    return result;
}

void dequantize(Object& object, const Dequantization& how) {
    if (how.is_identity()) return;
    for (glm::vec3& P : object.mesh.P) {
        P = glm::vec3(glm::dvec3(P) * glm::dvec3(how.scale) + glm::dvec3(how.translation));
    }
    for (glm::vec3& N : object.mesh.N) N = glm::normalize(N / how.scale);
    for (MorphTarget& target : object.bends.targets) {
        for (glm::vec3& P : target.P) P *= how.scale;
    }
}

}  // namespace estara
