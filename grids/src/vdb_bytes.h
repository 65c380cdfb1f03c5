// A .vdb file as bytes: what can be known of it before OpenVDB, which trusts what it reads, sees
// it.
#pragma once

#include <cstdint>
#include <cstring>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

namespace estara {

/// File metadata under which a file carries the digest of its own bytes, 16 hex digits.
inline constexpr const char* digest_key = "estara_digest";
inline constexpr const char* digest_placeholder = "0000000000000000";

/// A file's bytes, read as they are used. The file must not shrink meanwhile; write_vdb() never
/// changes one, it puts another in its place.
class MappedFile {
public:
    /// Error: no such file, not a file, empty, cannot be read.
    explicit MappedFile(const std::string& path);
    ~MappedFile();
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    std::string_view bytes() const noexcept { return m_bytes; }
    /// Takes a range out of memory; it is read again when it is used again.
    void forget(std::uint64_t from, std::uint64_t to) const noexcept;

private:
    std::string_view m_bytes;
};

/// Thrown by ByteCursor instead of leaving its bytes.
struct Cut {
    std::uint64_t needed;  ///< position, in the bytes, that could not be reached
};

/// A position in bytes that cannot leave them.
class ByteCursor {
public:
    explicit ByteCursor(std::string_view bytes, std::uint64_t at = 0) : m_bytes(bytes) { seek(at); }

    std::uint64_t at() const noexcept { return m_at; }
    void seek(std::uint64_t at) {
        if (at > m_bytes.size()) throw Cut{at};
        m_at = at;
    }
    std::string_view take(std::uint64_t count) {
        if (count > m_bytes.size() - m_at) throw Cut{m_at + count};
        const std::string_view taken = m_bytes.substr(m_at, count);
        m_at += count;
        return taken;
    }
    void skip(std::uint64_t count) { take(count); }
    template <class T>
    T number() {
        T value{};
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }

private:
    std::string_view m_bytes;
    std::uint64_t m_at = 0;
};

/// Where a grid is in a file.
struct StoredGrid {
    std::string name;           ///< unique in the file
    std::string type;           ///< "Tree_vec3s_5_4_3"
    bool half = false;          ///< its floats are stored as half floats
    bool is_instance = false;   ///< it has no voxels of its own: another grid's are meant
    std::uint64_t data = 0;     ///< position of its compression, metadata, transform, tree
    std::uint64_t buffers = 0;  ///< position of its voxels' values
    std::uint64_t end = 0;      ///< position after them
};

struct VdbLayout {
    std::uint64_t size = 0;       ///< of the file, bytes
    std::uint64_t needed = 0;     ///< more than size: cut short, and what follows is incomplete
    std::uint64_t digest_at = 0;  ///< where the digest's 16 characters are; 0: there is none
    std::uint32_t format = 0, library_major = 0, library_minor = 0;
    std::vector<StoredGrid> grids;  ///< in file order; their positions are in the file and in order
};

/// Reads the header and the list of grids. Any length or position in them that points outside the
/// file ends the reading, so this takes little memory whatever the bytes are.
/// Error: not a .vdb, a format older or newer than OpenVDB 10 writes.
/// @param path  for messages
VdbLayout vdb_layout(const std::string& path, const MappedFile& file);

/// vdb_layout(), and an Error if the file is cut short.
VdbLayout whole_vdb_layout(const std::string& path, const MappedFile& file);

/// Error unless the file's digest, if it has one, is that of its bytes. Reads all of them.
void check_vdb_digest(const std::string& path, const MappedFile& file, const VdbLayout& layout);

/// Digest of all bytes but the file's random id and the digest's own characters, 16 hex digits.
std::string vdb_digest(const MappedFile& file, const VdbLayout& layout);

/// An Error that names the file and says what is wrong in it.
[[noreturn]] void damaged(const std::string& path, const std::string& what);

/// First line of a text that comes from elsewhere, at most 200 characters; '?' for all but
/// printable ASCII.
std::string clamped(const std::string& text);

/// What an exception of OpenVDB says, clamped, without the name of its class in front.
std::string reason(const std::exception& e);

}  // namespace estara
