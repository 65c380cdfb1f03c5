// estara-bake as a function.
#pragma once

#include <functional>
#include <string>

#include "estara/bake/options.h"

namespace estara::bake {

/// Where results (stdout) and messages (stderr) go, a line at a time.
struct Output {
    std::function<void(const std::string&)> result, message;
};

/// Does what the options ask for. Error for whatever cannot be done; nothing half-written is left.
void run(const Options& options, const Output& output);

}  // namespace estara::bake
