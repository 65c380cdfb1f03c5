// What runs a program, and what it may know of the machine.
#include "estara/scenes/program.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <sstream>

#include "loaders.h"

namespace estara {
namespace {

/// Every line of an Error is a message of its own.
void print(const char* program, const std::string& message) {
    std::istringstream lines(message);
    for (std::string line; std::getline(lines, line);) {
        std::fputs((message_line(program, line) + '\n').c_str(), stderr);
    }
}

}  // namespace

std::string message_line(const std::string& program, const std::string& message) {
    return one_line(program + ": " + message);
}

int run_program(const char* program, const std::function<void()>& body) {
    // A limit on the size of files is then a write that fails, as on a full disk.
    std::signal(SIGXFSZ, SIG_IGN);
    try {
        body();
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
            throw Error("the results cannot be written to standard output", ExitStatus::failed);
        }
        return int(ExitStatus::done);
    } catch (const Error& error) {
        print(program, error.what());
        return int(error.status());
    } catch (const std::bad_alloc&) {
        print(program, "out of memory");
        return int(ExitStatus::failed);
    } catch (const std::exception& error) {
        print(program, "internal error: " + one_line(error.what()));
    } catch (...) {
        print(program, "internal error");
    }
    return int(ExitStatus::bug);
}

std::uint64_t peak_memory() noexcept {
    rusage usage{};
    if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
    return std::uint64_t(usage.ru_maxrss) * 1024;  // Linux says KiB
}

std::uint64_t physical_memory() noexcept {
    const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGE_SIZE);
    return pages > 0 && size > 0 ? std::uint64_t(pages) * std::uint64_t(size) : 0;
}

}  // namespace estara
