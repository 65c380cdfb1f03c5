// A file that appears under its name only when it is whole.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "estara/scenes/program.h"

namespace estara {
namespace {

namespace fs = std::filesystem;

/// Flushes a file or folder to the disk; whether that worked.
bool sync(const std::string& path, int flags) {
    const int file = ::open(path.c_str(), flags);
    if (file < 0) return false;
    const bool synced = ::fsync(file) == 0;
    const int why = errno;
    const bool closed = ::close(file) == 0;
    if (!synced) errno = why;
    return synced && closed;
}

void make_folder(const fs::path& folder, const std::string& final_path) {
    std::error_code code;
    fs::create_directories(folder, code);
    if (!code) return;
    throw Error(fmt::format("{}: cannot make the folder {}: {}", final_path, folder.string(),
                            code.message()));
}

}  // namespace

PendingFile::PendingFile(std::string final_path) : m_final(std::move(final_path)) {
    const fs::path path(m_final);
    if (!path.has_filename()) throw Error(fmt::format("'{}' is not the name of a file", m_final));
    std::error_code code;
    const fs::file_status there = fs::status(path, code);
    if (fs::exists(there) && !fs::is_regular_file(there)) {
        throw Error(fmt::format("{}: is not a file that can be replaced", m_final));
    }
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    make_folder(folder, m_final);
    const std::string name =
        fmt::format(".{}.{}.tmp{}", path.stem().string(), ::getpid(), path.extension().string());
    m_path = (path.has_parent_path() ? folder / name : fs::path(name)).string();
    const int file = ::open(m_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) {
        throw Error(fmt::format("{}: cannot write to the folder {}: {}", m_final, folder.string(),
                                std::strerror(errno)));
    }
    ::close(file);
}

PendingFile::~PendingFile() {
    if (!m_committed) ::unlink(m_path.c_str());
}

void PendingFile::commit() {
    if (!sync(m_path, O_RDONLY | O_CLOEXEC) || ::rename(m_path.c_str(), m_final.c_str()) != 0) {
        throw Error(fmt::format("{}: cannot be written: {}", m_final, std::strerror(errno)),
                    ExitStatus::failed);
    }
    m_committed = true;
    // The file is in place; a folder that cannot be flushed (some network disks) is no failure.
    const std::string folder = fs::path(m_final).parent_path().string();
    sync(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

}  // namespace estara
