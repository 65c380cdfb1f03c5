#include "gltf_unshown.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace estara {
namespace {

/// Objects that a line names; of the others it tells the number.
constexpr std::size_t most_named = 8;

/// Extensions that change nothing without something else that is told of anyway, or at all.
bool is_told_elsewhere(const std::string& extension) {
    return extension == "KHR_materials_emissive_strength" ||
           !extension.starts_with("KHR_materials_");
}

bool emits(const tinygltf::Material& material) {
    const std::vector<double>& factor = material.emissiveFactor;
    return std::any_of(factor.begin(), factor.end(), [](double f) { return f > 0.0; });
}

/// Whether alpha can be anything but 1: glTF 2.0, 3.9.4, "Alpha Coverage".
bool has_alpha(const tinygltf::PbrMetallicRoughness& pbr, bool has_vertex_colors) {
    const bool factor = pbr.baseColorFactor.size() == 4 && pbr.baseColorFactor[3] < 1.0;
    return factor || pbr.baseColorTexture.index != -1 || has_vertex_colors;
}

}  // namespace

void UnshownFeatures::note(const Object& object, const tinygltf::Primitive& primitive,
                           const tinygltf::Material* material) {
    if (object.wears_shader()) return;
    const std::string& name = object.mesh_name;
    const bool has_vertex_colors = primitive.attributes.contains("COLOR_0");
    if (has_vertex_colors) add("vertex colours", name);
    if (material == nullptr) return;
    const tinygltf::PbrMetallicRoughness& pbr = material->pbrMetallicRoughness;
    if (pbr.baseColorTexture.index != -1) add("colour textures (the colour factor is)", name);
    if (pbr.metallicRoughnessTexture.index != -1 || material->values.contains("metallicFactor") ||
        material->values.contains("roughnessFactor")) {
        add("metallic and roughness (RSL's plastic is)", name);
    }
    if (emits(*material)) add("emission", name);
    if (material->normalTexture.index != -1) add("normal maps", name);
    if (material->occlusionTexture.index != -1) add("occlusion maps", name);
    if (has_alpha(pbr, has_vertex_colors)) {
        if (material->alphaMode == "MASK") add("alpha masks (shown opaque)", name);
        if (material->alphaMode == "BLEND") add("transparency (shown opaque)", name);
    }
    for (const auto& [extension, value] : material->extensions) {
        if (!is_told_elsewhere(extension)) add(one_line(extension), name);
    }
}

void UnshownFeatures::add(const std::string& feature, const std::string& object) {
    std::vector<std::string>& objects = m_objects[feature];
    if (std::find(objects.begin(), objects.end(), object) == objects.end()) {
        objects.push_back(object);
    }
}

std::vector<std::string> UnshownFeatures::lines() const {
    std::vector<std::string> lines;
    for (const auto& [feature, objects] : m_objects) {
        std::vector<std::string> names;
        for (std::size_t i = 0; i < std::min(objects.size(), most_named); ++i) {
            names.push_back(fmt::format("\"{}\"", one_line(objects[i])));
        }
        std::string line = fmt::format("not shown: {} of {}", feature, fmt::join(names, ", "));
        if (objects.size() > most_named) {
            line += fmt::format(" and {} others", objects.size() - most_named);
        }
        lines.push_back(one_line(line));
    }
    return lines;
}

}  // namespace estara
