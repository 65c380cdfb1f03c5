// Materials that wear a shader by their names.
#include <fmt/format.h>

#include "loaders.h"

namespace estara {

std::string shader_named(const std::string& material) {
    if (find_shader(material)) return material;
    const std::size_t dot = material.rfind('.');
    if (dot == std::string::npos || dot + 1 == material.size()) return "";
    if (material.find_first_not_of("0123456789", dot + 1) != std::string::npos) return "";
    const std::string stem = material.substr(0, dot);
    return find_shader(stem) ? stem : "";
}

std::string shader_almost_named(const std::string& material) {
    const auto small = [](std::string text) {
        for (char& c : text) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
        return text;
    };
    std::string stem = small(material);
    const std::size_t dot = stem.rfind('.');
    if (dot != std::string::npos && dot + 1 < stem.size() &&
        stem.find_first_not_of("0123456789", dot + 1) == std::string::npos) {
        stem.resize(dot);
    }
    for (const ShaderInfo& info : all_shaders()) {
        if (small(std::string(info.name)) == stem) return std::string(info.name);
    }
    return "";
}

std::string almost_named(const std::string& where, const std::string& shader) {
    return fmt::format("{}: wears no shader; its name would have to be \"{}\"", where, shader);
}

}  // namespace estara
