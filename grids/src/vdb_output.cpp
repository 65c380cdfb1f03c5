#include "vdb_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "estara/scenes/error.h"

namespace estara {
namespace {

std::uint64_t hash(std::string_view bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

}  // namespace

CheckedOutput::CheckedOutput(std::string path, std::string title)
    : m_path(std::move(path)), m_title(std::move(title)), m_file(m_path, std::ios::binary) {
    if (!m_file) {
        throw Error(fmt::format("{}: it cannot be written", m_title), ExitStatus::failed);
    }
}

void CheckedOutput::append(std::string_view bytes) {
    m_pieces.push_back({m_size, bytes.size(), hash(bytes)});
    m_file.write(bytes.data(), std::streamsize(bytes.size()));
    m_size += bytes.size();
    if (!m_file) fail_cut();
}

void CheckedOutput::replace(std::uint64_t at, std::string_view bytes) {
    const auto piece = std::lower_bound(m_pieces.begin(), m_pieces.end(), at,
                                        [](const Piece& p, std::uint64_t a) { return p.at < a; });
    piece->hash = hash(bytes);
    m_file.seekp(std::streamoff(at));
    m_file.write(bytes.data(), std::streamsize(bytes.size()));
    m_file.seekp(std::streamoff(m_size));
    if (!m_file) fail_cut();
}

void CheckedOutput::close() {
    m_file.close();
    std::error_code error;
    if (!m_file || std::filesystem::file_size(m_path, error) != m_size) fail_cut();
}

void CheckedOutput::check(const MappedFile& read_back) const {
    if (read_back.bytes().size() != m_size) fail_cut();
    for (const Piece& piece : m_pieces) {
        const bool same = hash(read_back.bytes().substr(piece.at, piece.size)) == piece.hash;
        read_back.forget(piece.at, piece.at + piece.size);
        if (same) continue;
        throw Error(
            fmt::format("{}: what was read back is not what was written: is the disk faulty?",
                        m_title),
            ExitStatus::failed);
    }
}

void CheckedOutput::fail_cut() const {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(m_path, error);
    throw Error(fmt::format("{}: the disk is full or the file was cut short: only {} bytes arrived",
                            m_title, error ? 0 : size),
                ExitStatus::failed);
}

}  // namespace estara
