// A file that is written from front to back, and what it must hold in the end.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_bytes.h"

namespace estara {

/// Keeps a hash of every piece that it writes, so that the file can be compared with what was
/// meant without keeping that.
class CheckedOutput {
public:
    /// @param path   where the bytes go
    /// @param title  what messages call the file
    CheckedOutput(std::string path, std::string title);

    std::uint64_t size() const noexcept { return m_size; }

    /// Error (failed) if the disk is full.
    void append(std::string_view bytes);
    /// Writes over one piece that was appended, with as many bytes.
    /// @param at  size() before that piece
    void replace(std::uint64_t at, std::string_view bytes);
    /// Error (failed) if not every byte arrived.
    void close();
    /// Compares the closed file with what was written. Error (failed) if it differs.
    void check(const MappedFile& read_back) const;

private:
    struct Piece {
        std::uint64_t at, size, hash;
    };

    [[noreturn]] void fail_cut() const;

    std::string m_path, m_title;
    std::ofstream m_file;
    std::uint64_t m_size = 0;
    std::vector<Piece> m_pieces;
};

}  // namespace estara
