#include "describe.h"

#include <fmt/format.h>

namespace estara::bake {
namespace {

std::string default_text(const ParamInfo& param) {
    return param.type == ValueType::color ? to_string(param.default_value)
                                          : to_string(param.default_value.x);
}

std::string range_text(const ParamInfo& param) {
    return fmt::format("[{}, {}]", to_string(param.min), to_string(param.max));
}

}  // namespace

std::string describe(const ShaderInfo& shader) {
    std::string text = fmt::format("{}: {}\n", shader.name, shader.summary);
    for (const ParamInfo& p : shader.params) {
        text += fmt::format("    {:<14} {:<18} {:<15} {:<18} {}\n", p.name, default_text(p),
                            to_string(p.unit), range_text(p), p.help);
    }
    for (const ChannelInfo& c : shader.channels) {
        text += fmt::format("    -> {:<11} {:<18} {:<15} {:<18} {}\n", c.name,
                            c.components == 3 ? "3 floats" : "1 float", "", "", c.help);
    }
    return text;
}

std::string shader_table() {
    std::string text =
        "| shader | what it paints | parameters | baked channels |\n|---|---|---|---|\n";
    for (const ShaderInfo& shader : all_shaders()) {
        std::string params, channels;
        for (const ParamInfo& p : shader.params) {
            params += fmt::format("{}{} {}", params.empty() ? "" : ", ", p.name, default_text(p));
        }
        for (const ChannelInfo& c : shader.channels) {
            channels += fmt::format("{}{}", channels.empty() ? "" : ", ", c.name);
        }
        text +=
            fmt::format("| `{}` | {} | {} | {} |\n", shader.name, shader.summary, params, channels);
    }
    return text;
}

}  // namespace estara::bake
