// The one exception of this project: a message for the user, in the user's words.
#pragma once

#include <stdexcept>
#include <string>

namespace estara {

/// Exit status of the programs.
enum class ExitStatus : int {
    done = 0,
    failed = 1,     ///< the work failed: disk, memory, a bound that cannot be reached
    bad_input = 2,  ///< wrong usage or input
    bug = 3,        ///< our own mistake
};

/// Something the user can understand and mend. what() is one line, "where: what", optionally
/// followed by "; what exists or what to do". Libraries throw it, run_program() prints it once.
class Error : public std::runtime_error {
public:
    explicit Error(const std::string& message, ExitStatus status = ExitStatus::bad_input)
        : std::runtime_error(message), m_status(status) {}
    ExitStatus status() const noexcept { return m_status; }

private:
    ExitStatus m_status;
};

}  // namespace estara
