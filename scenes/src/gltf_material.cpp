// How a glTF material wears a shader: extras {"shader": "wood", "params": {...}}, or its name.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "gltf.h"

namespace estara {
namespace {

using nlohmann::json;

/// Extras as the file has them; an empty object if there are none or they are something else.
json extras_of(const std::string& text) {
    json extras = text.empty() ? json::object() : json::parse(text, nullptr, false);
    return extras.is_object() ? extras : json::object();
}

bool is_finite_number(const json& value) {
    return value.is_number() && std::isfinite(value.get<float>());
}

/// A number or three of them; nothing else.
std::vector<float> numbers(const json& value, const std::string& where, const std::string& key) {
    if (is_finite_number(value)) return {value.get<float>()};
    const bool three = value.is_array() && value.size() == 3 && is_finite_number(value[0]) &&
                       is_finite_number(value[1]) && is_finite_number(value[2]);
    if (three) return value.get<std::vector<float>>();
    throw Error(fmt::format("{}: \"{}\" must be a number or three of them, not {}", where,
                            one_line(key), one_line(value.dump(-1, ' ', true))));
}

std::string shader_of(const json& extras, const tinygltf::Material& material,
                      const std::string& where) {
    if (!extras.contains("shader")) return shader_named(material.name);
    const json& name = extras["shader"];
    if (name.is_string() && !name.get<std::string>().empty()) return name;
    throw Error(fmt::format("{}: \"shader\" must be a name in quotes, not {}", where,
                            one_line(name.dump(-1, ' ', true))));
}

/// Parameters beside "shader" instead of in "params", as Blender's custom properties are flat.
void warn_of_flat_parameters(const json& extras, const std::string& shader,
                             const std::string& where, std::vector<std::string>& warnings) {
    const ShaderInfo* const info = find_shader(shader);
    if (info == nullptr) return;  // which binding will tell
    std::string flat;
    for (const auto& [key, value] : extras.items()) {
        const bool is_parameter =
            std::any_of(info->params.begin(), info->params.end(),
                        [&name = key](const ParamInfo& p) { return p.name == name; });
        if (is_parameter) flat += (flat.empty() ? "\"" : ", \"") + key + '"';
    }
    if (flat.empty()) return;
    warnings.push_back(fmt::format(
        "{}: {} beside \"shader\": not used; parameters go into \"params\": {{...}}", where, flat));
}

std::vector<Setting> settings_of(const json& extras, const std::string& where) {
    std::vector<Setting> settings;
    if (!extras.contains("params")) return settings;
    const json& params = extras["params"];
    if (!params.is_object()) {
        throw Error(fmt::format("{}: \"params\" must be {{\"name\": value, ...}}, not {}", where,
                                one_line(params.dump(-1, ' ', true))));
    }
    for (const auto& [key, value] : params.items()) {
        settings.push_back({key, numbers(value, where, key)});
    }
    return settings;
}

}  // namespace

void read_material(const tinygltf::Model& model, int index, const std::string& where,
                   Object& object, std::vector<std::string>& warnings) {
    if (index == -1) return;
    const tinygltf::Material& material = gltf_element(model.materials, index, where, "material");
    const std::vector<double>& color = material.pbrMetallicRoughness.baseColorFactor;
    if (color.size() == 4) {
        object.base_color =
            glm::clamp(glm::vec3(color[0], color[1], color[2]), glm::vec3(0.0f), glm::vec3(1.0f));
    }
    const json extras = extras_of(material.extras_json_string);
    object.choice.where = where;
    object.choice.name = shader_of(extras, material, where);
    if (object.wears_shader()) {
        object.choice.settings = settings_of(extras, where);
        warn_of_flat_parameters(extras, object.choice.name, where, warnings);
        return;
    }
    if (extras.contains("params")) {
        warnings.push_back(fmt::format("{}: \"params\" without a \"shader\"", where));
    }
    const std::string meant = shader_almost_named(material.name);
    if (meant.empty()) return;
    warnings.push_back(
        fmt::format("{}: wears no shader; its name would have to be \"{}\"", where, meant));
}

void warn_of_shader(const std::string& text, const std::string& where,
                    std::vector<std::string>& warnings) {
    const json extras = extras_of(text);
    if (!extras.contains("shader") && !extras.contains("params")) return;
    warnings.push_back(
        fmt::format("{}: extras \"{}\" not used; a shader is named in the extras of the material",
                    where, extras.contains("shader") ? "shader" : "params"));
}

std::optional<glm::vec3> read_ambient(const tinygltf::Scene& scene, const std::string& where) {
    const json extras = extras_of(scene.extras_json_string);
    if (!extras.contains("ambient")) return std::nullopt;
    const std::vector<float> value = numbers(extras["ambient"], where, "ambient");
    const glm::vec3 ambient =
        value.size() == 1 ? glm::vec3(value[0]) : glm::vec3(value[0], value[1], value[2]);
    if (ambient.r >= 0.0f && ambient.g >= 0.0f && ambient.b >= 0.0f) return ambient;
    throw Error(fmt::format("{}: \"ambient\" must not be negative", where));
}

std::optional<double> read_fps(const tinygltf::Scene& scene, const std::string& where) {
    const json extras = extras_of(scene.extras_json_string);
    if (!extras.contains("fps")) return std::nullopt;
    const json& fps = extras["fps"];
    if (is_finite_number(fps) && fps.get<double>() > 0.0) return fps.get<double>();
    throw Error(fmt::format("{}: \"fps\" must be a number above 0, not {}", where,
                            one_line(fps.dump(-1, ' ', true), longest_name)));
}

}  // namespace estara
