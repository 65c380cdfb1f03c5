// Shaders as text.
#pragma once

#include <string>

#include "estara/shaders/registry.h"

namespace estara::bake {

/// Name, summary, parameters and channels of a shader, in aligned lines.
std::string describe(const ShaderInfo& shader);

/// All shaders as a Markdown table: name, summary, parameters with defaults, channels.
std::string shader_table();

}  // namespace estara::bake
