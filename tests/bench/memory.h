// Peak memory of a piece of work, from Linux.
#pragma once

#include <malloc.h>

#include <cstdint>
#include <fstream>
#include <functional>
#include <string>

#include "estara/scenes/error.h"

namespace estara::bench {

/// A line of /proc/self/status, "VmHWM" or "VmRSS", in bytes.
inline std::uint64_t memory_status(const std::string& name) {
    std::ifstream file("/proc/self/status");
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with(name + ":")) {
            return std::stoull(line.substr(name.size() + 1)) * 1024;  // Linux says KiB
        }
    }
    throw Error("/proc/self/status: no " + name, ExitStatus::failed);
}

/// By how many bytes the process grows at most while the work is done. What was free before is
/// given back first, so that the work cannot use it unseen.
inline std::uint64_t peak_growth(const std::function<void()>& work) {
    malloc_trim(0);
    std::ofstream reset("/proc/self/clear_refs");
    if (!(reset << "5" << std::flush)) {  // proc(5): sets the peak to what is held now
        throw Error("/proc/self/clear_refs: cannot be written to, so peaks cannot be measured",
                    ExitStatus::failed);
    }
    const std::uint64_t before = memory_status("VmRSS");
    work();
    const std::uint64_t peak = memory_status("VmHWM");
    return peak > before ? peak - before : 0;
}

}  // namespace estara::bench
