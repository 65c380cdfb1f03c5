// The programs of this project, run as a user runs them.
#pragma once

#include <cstdlib>
#include <string>

#include "estara/scenes/error.h"

namespace estara::bench {

/// Whether a line of sh ends with status 0. The programs are found by name; what they say is seen.
inline bool command_succeeds(const std::string& line) {
    return std::system(("PATH='" ESTARA_BIN "':$PATH; " + line + " >&2").c_str()) == 0;
}

inline void run_command(const std::string& line) {
    if (!command_succeeds(line)) throw Error(line + ": failed", ExitStatus::failed);
}

}  // namespace estara::bench
