// The list of shaders as the programs see it.
#include "estara/shaders/registry.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "bound.h"
#include "library/all.h"

namespace estara {

static_assert(std::tuple_size_v<AllShaders> == ESTARA_SHADERS,
              "library/ has a shader that all.h does not name, or the other way round");

namespace {

/// Raised when a shader's or a building block's mathematics changes: grids baked before are stale.
constexpr std::string_view shaders_version = "1";

using Binder = BoundShaderPtr (*)(const ShaderInfo&, const std::vector<glm::vec3>&, bool,
                                  InstructionSet);

struct Registry {
    std::vector<ShaderInfo> infos;
    std::vector<Binder> binders;
};

template <class S>
void add(Registry& registry) {
    registry.infos.push_back(detail::make_info<S>());
    registry.binders.push_back([](const ShaderInfo& info, const std::vector<glm::vec3>& values,
                                  bool has_uv, InstructionSet limit) -> BoundShaderPtr {
        return std::make_shared<detail::Bound<S>>(info, values, has_uv, limit);
    });
}

const Registry& registry() {
    static const Registry all = [] {
        Registry r;
        [&]<class... S>(std::type_identity<std::tuple<S...>>) {
            (add<S>(r), ...);
        }(std::type_identity<AllShaders>{});
        return r;
    }();
    return all;
}

template <class Infos>
std::vector<std::string_view> names_of(const Infos& infos) {
    std::vector<std::string_view> names;
    for (const auto& info : infos) names.push_back(info.name);
    return names;
}

std::string join(std::span<const std::string_view> words) {
    std::string text;
    for (const std::string_view word : words) {
        if (!text.empty()) text += ", ";
        text += word;
    }
    return text;
}

std::string quoted(std::string_view word) { return "'" + std::string(word) + "'"; }

/// "did you mean 'x'? it has: a, b, c".
std::string suggestion(std::string_view word, std::span<const std::string_view> known,
                       const char* what) {
    const std::string_view near = nearest_word(word, known);
    std::string hint = near.empty() ? "" : "did you mean " + quoted(near) + "? ";
    return hint + what + ": " + join(known);
}

/// What is wrong with a value, or "".
std::string value_problem(const ParamInfo& param, const Setting& setting) {
    const std::string name = quoted(param.name);
    const bool color = param.type == ValueType::color;
    if (setting.value.size() != 1 && !(color && setting.value.size() == 3)) {
        return name +
               (color ? " is a colour: give 3 numbers, or 1 for a grey" : " is one number, not ") +
               (color ? "" : std::to_string(setting.value.size()));
    }
    for (const float v : setting.value) {
        if (!(v >= param.min && v <= param.max)) {
            return name + " = " + to_string(v) + " is outside [" + to_string(param.min) + ", " +
                   to_string(param.max) + "]";
        }
        if (param.type == ValueType::integer && v != std::floor(v)) {
            return name + " = " + to_string(v) + " is not a whole number";
        }
    }
    return "";
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, changed});
        }
    }
    return row[b.size()];
}

}  // namespace

std::string_view to_string(Unit unit) noexcept {
    switch (unit) {
        case Unit::none:
            return "";
        case Unit::per_length:
            return "1/length";
        case Unit::length:
            return "length";
        case Unit::color:
            return "linear Rec. 709";
    }
    return "";
}

std::string to_string(float value) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    return {text.data(), end};
}

std::string to_string(const glm::vec3& value) {
    return to_string(value.x) + "," + to_string(value.y) + "," + to_string(value.z);
}

std::span<const ShaderInfo> all_shaders() { return registry().infos; }

const ShaderInfo* find_shader(std::string_view name) {
    const auto& infos = registry().infos;
    const auto at = std::find_if(infos.begin(), infos.end(),
                                 [&](const ShaderInfo& i) { return i.name == name; });
    return at == infos.end() ? nullptr : &*at;
}

std::string_view nearest_word(std::string_view word, std::span<const std::string_view> known) {
    std::string_view best;
    std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
    for (const std::string_view candidate : known) {
        const std::size_t distance = edit_distance(word, candidate);
        if (distance < best_distance) {
            best_distance = distance;
            best = candidate;
        }
    }
    return best;
}

std::string shader_names() { return join(names_of(all_shaders())); }

BindResult bind_shader(std::string_view name, std::span<const Setting> settings, bool has_uv,
                       InstructionSet limit) {
    BindResult result;
    const ShaderInfo* const info = find_shader(name);
    if (info == nullptr) {
        result.problems.push_back({std::string(name), "no shader " + quoted(name),
                                   suggestion(name, names_of(all_shaders()), "there are")});
        return result;
    }

    std::vector<glm::vec3> values;
    for (const ParamInfo& param : info->params) values.push_back(param.default_value);
    std::vector<bool> given(info->params.size(), false);
    for (const Setting& setting : settings) {
        const auto at = std::find_if(info->params.begin(), info->params.end(),
                                     [&](const ParamInfo& p) { return p.name == setting.name; });
        const std::string shader = "shader " + quoted(name);
        if (at == info->params.end()) {
            result.problems.push_back({setting.name,
                                       shader + " has no parameter " + quoted(setting.name),
                                       suggestion(setting.name, names_of(info->params), "it has")});
            continue;
        }
        const auto index = std::size_t(at - info->params.begin());
        if (given[index]) {
            result.problems.push_back(
                {setting.name, shader + ": " + quoted(setting.name) + " is set twice", ""});
            continue;
        }
        given[index] = true;
        if (const std::string problem = value_problem(*at, setting); !problem.empty()) {
            result.problems.push_back({setting.name, shader + ": " + problem, ""});
            continue;
        }
        values[index] = setting.value.size() == 3
                            ? glm::vec3(setting.value[0], setting.value[1], setting.value[2])
                            : glm::vec3(setting.value[0]);
    }
    if (!result.problems.empty()) return result;

    const auto number = std::size_t(info - registry().infos.data());
    BoundShaderPtr shader = registry().binders[number](*info, values, has_uv, limit);
    if (shader->needs_uv() && !has_uv) {
        result.problems.push_back(
            {"", "shader " + quoted(name) + " is set on texture coordinates, and the mesh has none",
             "add some, or use its solid variant"});
        return result;
    }
    result.shader = std::move(shader);
    return result;
}

namespace {

/// The values of the parameters that `wanted` names, each as " name=value".
template <class Predicate>
std::string list_values(const BoundShader& shader, Predicate wanted) {
    const std::vector<glm::vec3> values = shader.values();
    std::string text;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const ParamInfo& param = shader.info().params[i];
        if (!wanted(param)) continue;
        if (!text.empty()) text += ' ';
        text += std::string(param.name) + "=" +
                (param.type == ValueType::color ? to_string(values[i]) : to_string(values[i].x));
    }
    return text;
}

}  // namespace

std::string describe_values(const BoundShader& shader) {
    return list_values(shader, [](const ParamInfo&) { return true; });
}

std::string shader_digest(const BoundShader& shader) {
    const std::string text =
        std::string(shaders_version) + " " + std::string(shader.info().name) + " " +
        list_values(shader, [](const ParamInfo& p) { return p.part == Part::bake; });
    std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a, 64 bits: a checksum, not a secret
    for (const char c : text) hash = (hash ^ std::uint8_t(c)) * 0x100000001b3u;
    std::array<char, 17> digits{};
    for (int i = 0; i < 16; ++i) digits[i] = "0123456789abcdef"[(hash >> (60 - 4 * i)) & 15];
    return {digits.data(), 16};
}

}  // namespace estara
