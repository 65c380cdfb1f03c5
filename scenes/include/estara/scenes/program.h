// What the programs share: values on the command line, progress, exit status, files put in place.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "estara/scenes/error.h"
#include "estara/scenes/scene.h"

namespace estara {

inline constexpr const char* version = "0.1.0";

/// Runs a program's body and turns what it throws into one line on stderr, "program: message", and
/// an exit status: Error's own; 1 for std::bad_alloc ("out of memory"); 3 for anything else.
/// Texts of foreign exceptions are clamped to one line of 300 characters.
int run_program(const char* program, const std::function<void()>& body);

/// A message as a program prints it on stderr: one line of at most 300 characters, with its name
/// before it and without control characters, whatever file it speaks of.
std::string message_line(const std::string& program, const std::string& message);

/// "A-B", "A-BxSTEP", "A" or a list of them, "1,20,40-60x5". Error names the option and the form.
FrameRange parse_frames(const std::string& text);
/// "1280x720", both in [1, 65536].
glm::ivec2 parse_resolution(const std::string& text);
/// "0.5,0.4,0.3" or one number for all three.
glm::vec3 parse_color(const std::string& text);
/// "2G", "512M", "1.5GiB", "800000": bytes; K, M, G, T are powers of 1024.
std::uint64_t parse_size(const std::string& text);
/// "NAME=VALUE" or "NAME=R,G,B".
Setting parse_setting(const std::string& text);

/// "1.4 GiB", "312 KiB".
std::string format_bytes(std::uint64_t bytes);
/// "0.8 s", "2 min 05 s".
std::string format_seconds(double seconds);

/// Largest amount of memory the process has held so far, bytes.
std::uint64_t peak_memory() noexcept;
/// Memory of the machine, bytes.
std::uint64_t physical_memory() noexcept;

enum class ProgressStyle { automatic, plain, none };
/// Error for any word but auto, plain, none.
ProgressStyle parse_progress(const std::string& text);

/// Progress on stderr: a bar with the remaining time on a terminal, redrawn at most ten times a
/// second; elsewhere (or plain) a line at the start, each ten per cent (at most one a second), and
/// the end. Any thread may advance it.
class Progress {
public:
    Progress(ProgressStyle style, std::string what, std::uint64_t total);
    ~Progress();  ///< clears the bar
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    void advance(std::uint64_t amount) noexcept;

private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

/// Where a file is written before it is whole: beside the final name, same ending
/// (".name.MACHINE-RANDOM.tmp.exr"). Moved into place by commit(); removed by the destructor
/// otherwise, so that nothing half-written is ever seen under the final name. Removed too if the
/// program is interrupted (SIGINT, SIGTERM, SIGHUP); what killed programs have left is removed by
/// the next one on the same machine that writes to the folder.
class PendingFile {
public:
    /// Creates missing parent folders. Error (bad_input) if the folder cannot be made or written
    /// to.
    explicit PendingFile(std::string final_path);
    ~PendingFile();
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;
    const std::string& path() const noexcept { return m_path; }
    /// Appends bytes. Error (failed) if not all of them arrive.
    void write(std::string_view bytes);
    /// fsync and rename. Error (failed) if either fails.
    void commit();

private:
    std::string m_final, m_path;
    int m_file = -1;  ///< open and locked as long as this lives
    bool m_committed = false;
};

/// Writes a small text file whole or not at all. Error (failed) if the disk is full.
void write_text(const std::string& path, const std::string& text);

/// Error if two options would read or write the same file, in whatever way it is spelt.
/// @param files  option (as the user knows it) and file; empty files are left out
void refuse_same_file(const std::vector<std::pair<std::string, std::string>>& files);

/// Seconds since construction.
class Stopwatch {
public:
    double seconds() const noexcept {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - m_start).count();
    }

private:
    std::chrono::steady_clock::time_point m_start = std::chrono::steady_clock::now();
};

}  // namespace estara
