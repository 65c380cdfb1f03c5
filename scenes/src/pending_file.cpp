// A file that appears under its name only when it is whole.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <random>
#include <set>

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

/// Files to remove if the program is interrupted. A signal handler may not allocate or lock, so the
/// names lie in fixed places; a file beyond the last place is only removed by its destructor.
class Interrupted {
public:
    static Interrupted& instance() {
        static Interrupted all;
        return all;
    }

    void add(const std::string& path) noexcept {
        for (Place& place : m_places) {
            int empty = 0;
            if (path.size() + 1 > place.name.size()) return;
            if (!place.state.compare_exchange_strong(empty, 1)) continue;
            std::memcpy(place.name.data(), path.c_str(), path.size() + 1);
            place.state = 2;
            return;
        }
    }

    void remove(const std::string& path) noexcept {
        for (Place& place : m_places) {
            if (place.state == 2 && path == place.name.data()) place.state = 0;
        }
    }

private:
    struct Place {
        std::atomic<int> state{0};  ///< 0 empty, 1 being filled, 2 full
        std::array<char, 1024> name{};
    };

    Interrupted() {
        for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
            // What is ignored (nohup) stays ignored.
            if (std::signal(signal, &Interrupted::clean_up) == SIG_IGN)
                std::signal(signal, SIG_IGN);
        }
    }

    static void clean_up(int signal) {
        for (Place& place : instance().m_places) {
            if (place.state == 2) ::unlink(place.name.data());
        }
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }

    std::array<Place, 16> m_places;
};

/// What tells this machine's temporary files from those of others on a shared disk.
std::string machine_tag() {
    std::array<char, 256> name{};
    ::gethostname(name.data(), name.size() - 1);
    return fmt::format("{:08x}", XXH32(name.data(), std::strlen(name.data()), 0));
}

/// ".STEM.TAG-RANDOM.tmp.EXT"
std::string temporary_name(const fs::path& path, unsigned random) {
    return fmt::format(".{}.{}-{:08x}.tmp{}", path.stem().string(), machine_tag(), random,
                       path.extension().string());
}

bool is_our_temporary_name(const std::string& name) {
    const std::size_t tmp = name.rfind(".tmp");
    const std::string tag = '.' + machine_tag() + '-';
    constexpr std::size_t digits = 8;
    if (name.empty() || name[0] != '.' || tmp == std::string::npos || tmp < tag.size() + digits) {
        return false;
    }
    return name.compare(tmp - digits - tag.size(), tag.size(), tag) == 0 &&
           name.find_first_not_of("0123456789abcdef", tmp - digits) == tmp;
}

/// Removes what programs that were killed on this machine have left in a folder: files whose lock
/// nobody holds. The system frees a lock with its process, however that ends.
void remove_abandoned(const fs::path& folder) {
    static std::mutex mutex;
    static std::set<std::string> done;  // a folder may hold as many frames as a film has
    {
        const std::lock_guard lock(mutex);
        if (!done.insert(fs::absolute(folder).string()).second) return;
    }
    std::error_code code;
    for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
        if (!is_our_temporary_name(it->path().filename().string())) continue;
        const int file = ::open(it->path().c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
        if (file < 0) continue;
        if (::flock(file, LOCK_EX | LOCK_NB) == 0) ::unlink(it->path().c_str());
        ::close(file);
    }
}

/// Creates and locks a file of a name that no other program, here or on another machine of the same
/// disk, has taken. -1 with errno if it cannot be.
int create_beside(const fs::path& folder, const fs::path& path, std::string& name) {
    std::random_device random;
    for (int attempt = 0;; ++attempt) {
        const std::string file = temporary_name(path, random());
        name = (path.has_parent_path() ? folder / file : fs::path(file)).string();
        // Before it is there: a signal in between finds nothing to remove, or it.
        Interrupted::instance().add(name);
        const int opened = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        struct stat status {};
        if (opened >= 0) {
            // Where locks are not to be had (some network disks) nobody removes it either.
            const bool locked = ::flock(opened, LOCK_EX | LOCK_NB) == 0;
            // Another may have taken it for abandoned before it was locked.
            const bool there = ::fstat(opened, &status) == 0 && status.st_nlink > 0;
            if (there && (locked || errno != EWOULDBLOCK)) return opened;
            ::close(opened);
        }
        const int why = errno;
        Interrupted::instance().remove(name);
        errno = why;
        if ((opened < 0 && why != EEXIST) || attempt == 100) return -1;
    }
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
    remove_abandoned(folder);
    m_file = create_beside(folder, path, m_path);
    if (m_file < 0) {
        throw Error(fmt::format("{}: cannot write to the folder {}: {}", m_final, folder.string(),
                                std::strerror(errno)));
    }
}

PendingFile::~PendingFile() {
    if (!m_committed) ::unlink(m_path.c_str());
    ::close(m_file);
    Interrupted::instance().remove(m_path);
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

void PendingFile::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(m_file, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) {
            throw Error(fmt::format("{}: cannot be written: {}", m_final,
                                    written < 0 ? std::strerror(errno) : "the disk takes no more"),
                        ExitStatus::failed);
        }
        bytes.remove_prefix(std::size_t(written));
    }
}

void write_text(const std::string& path, const std::string& text) {
    PendingFile file(path);
    file.write(text);
    file.commit();
}

void refuse_same_file(const std::vector<std::pair<std::string, std::string>>& files) {
    const auto absolute = [](const std::string& file) {
        std::error_code code;
        const fs::path path = fs::weakly_canonical(fs::absolute(file), code);
        return code ? fs::path(file) : path;
    };
    for (std::size_t i = 0; i < files.size(); ++i) {
        for (std::size_t k = i + 1; k < files.size(); ++k) {
            if (files[i].second.empty() || files[k].second.empty()) continue;
            if (absolute(files[i].second) != absolute(files[k].second)) continue;
            throw Error(fmt::format("{} {} and {} {} are the same file", files[i].first,
                                    files[i].second, files[k].first, files[k].second));
        }
    }
}

}  // namespace estara
