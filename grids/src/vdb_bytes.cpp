// Header of a .vdb file, after OpenVDB 10's io/Archive.cc and io/GridDescriptor.cc (its format has
// no other description):
//
//   magic i64 | format u32 | library u32 u32 | has offsets u8 | uuid 36 chars | file metadata |
//   number of grids i32 | for each grid: name, type, instance parent, 3 positions i64, data
//   data of a grid: compression u32, metadata, transform, tree
//
// Text is a u32 length and bytes. Metadata is a u32 count, then for each: name, type, u32 length,
// bytes. The positions are where the grid's data, its voxel buffers and its end are; the next grid
// begins at that end. Everything is little-endian.
#include "vdb_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "estara/scenes/error.h"

namespace estara {
namespace {

constexpr std::int64_t magic = 0x56444220;
constexpr std::uint32_t oldest_format = 222, newest_format = 224;
constexpr std::uint64_t uuid_at = 21, uuid_size = 36;  // random, so not part of the digest
constexpr std::uint64_t digest_size = 16;

/// Thrown when a read would leave the file; never leaves this source file.
struct Cut {
    std::uint64_t needed;
};

[[noreturn]] void damaged(const std::string& path, const std::string& what) {
    throw Error(fmt::format("{}: damaged: {}; bake it again", path, what));
}

/// A position in a file that cannot leave it.
class Cursor {
public:
    Cursor(const std::string& path, std::uint64_t size)
        : m_path(path), m_stream(path, std::ios::binary), m_size(size) {}

    std::uint64_t at() const noexcept { return m_at; }

    void seek(std::uint64_t at) {
        if (at > m_size) throw Cut{at};
        m_at = at;
        m_stream.seekg(std::streamoff(at));
    }
    void skip(std::uint64_t bytes) { seek(m_at + bytes); }
    template <class T>
    T number() {
        T value{};
        read(&value, sizeof value);
        return value;
    }
    std::string text() {
        constexpr std::uint32_t longest = 1 << 16;  // all texts read here are names
        const auto length = number<std::uint32_t>();
        if (length > m_size - m_at) throw Cut{m_at + length};
        if (length > longest) damaged(m_path, fmt::format("a name of {} characters", length));
        std::string s(length, '\0');
        read(s.data(), length);
        return s;
    }

private:
    void read(void* out, std::uint64_t bytes) {
        if (bytes > m_size - m_at) throw Cut{m_at + bytes};
        if (!m_stream.read(static_cast<char*>(out), std::streamsize(bytes))) {
            throw Error(fmt::format("{}: it cannot be read", m_path), ExitStatus::failed);
        }
        m_at += bytes;
    }

    std::string m_path;
    std::ifstream m_stream;
    std::uint64_t m_size, m_at = 0;
};

std::uint64_t size_of(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) throw Error(fmt::format("{}: no such file", path));
    if (!fs::is_regular_file(status)) throw Error(fmt::format("{}: not a file", path));
    const std::uint64_t size = fs::file_size(path, error);
    if (error || !std::ifstream(path, std::ios::binary)) {
        throw Error(fmt::format("{}: it cannot be read: {}", path,
                                error ? error.message() : "permission denied"));
    }
    if (size == 0) throw Error(fmt::format("{}: the file is empty", path));
    return size;
}

[[noreturn]] void not_a_vdb(const std::string& path) {
    throw Error(fmt::format("{}: not a .vdb file", path));
}

void read_start(const std::string& path, Cursor& in) {
    if (in.number<std::int64_t>() != magic) not_a_vdb(path);
    const auto format = in.number<std::uint32_t>();
    if (format < oldest_format || format > newest_format) {
        throw Error(fmt::format("{}: .vdb format {}; this program reads {} to {}", path, format,
                                oldest_format, newest_format));
    }
    in.skip(8);
    if (in.number<char>() != 1) {
        throw Error(
            fmt::format("{}: a .vdb stream without positions; not made by estara-bake", path));
    }
    in.skip(uuid_size);
}

/// @return  where the digest is, or 0
std::uint64_t read_metadata(Cursor& in) {
    std::uint64_t digest_at = 0;
    const auto count = in.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::string name = in.text(), type = in.text();
        const auto length = in.number<std::uint32_t>();
        if (name == digest_key && type == "string" && length == digest_size) digest_at = in.at();
        in.skip(length);
    }
    return digest_at;
}

void read_grids(const std::string& path, Cursor& in, VdbLayout& layout) {
    const auto count = in.number<std::int32_t>();
    for (std::int32_t i = 0; i < count; ++i) {
        std::string name = in.text();
        name = name.substr(0, name.find('\x1e'));  // what follows tells grids of one name apart
        in.text();
        in.text();
        const auto data = in.number<std::int64_t>(), buffers = in.number<std::int64_t>(),
                   end = in.number<std::int64_t>();
        if (data < std::int64_t(in.at()) || buffers < data || end < buffers) {
            damaged(path, fmt::format("the position of grid \"{}\" makes no sense", clamped(name)));
        }
        in.seek(std::uint64_t(end));
        in.seek(std::uint64_t(data));
        in.skip(4);         // how it is compressed
        read_metadata(in);  // its lengths must be sound: OpenVDB allocates what they say
        in.seek(std::uint64_t(end));
        layout.grids.push_back(std::move(name));
    }
    layout.needed = in.at();
}

/// Digest of all bytes but the file's random id and the digest's own characters.
std::string digest_of(const std::string& path, const VdbLayout& layout) {
    std::ifstream in(path, std::ios::binary);
    XXH3_state_t state;
    XXH3_64bits_reset(&state);
    std::vector<char> buffer(1 << 20);
    std::uint64_t at = 0;
    while (in.read(buffer.data(), std::streamsize(buffer.size())) || in.gcount() > 0) {
        const auto got = std::uint64_t(in.gcount());
        const auto blank = [&](std::uint64_t from, std::uint64_t bytes) {
            for (std::uint64_t i = std::max(from, at); i < std::min(from + bytes, at + got); ++i) {
                buffer[i - at] = '0';
            }
        };
        blank(uuid_at, uuid_size);
        blank(layout.digest_at, digest_size);
        XXH3_64bits_update(&state, buffer.data(), got);
        at += got;
    }
    return fmt::format("{:016x}", XXH3_64bits_digest(&state));
}

}  // namespace

VdbLayout vdb_layout(const std::string& path) {
    VdbLayout layout;
    layout.size = size_of(path);
    Cursor in(path, layout.size);
    try {
        read_start(path, in);
        layout.digest_at = read_metadata(in);
        read_grids(path, in, layout);
    } catch (const Cut& cut) {
        if (layout.size < sizeof magic) not_a_vdb(path);
        layout.needed = cut.needed;
    }
    return layout;
}

VdbLayout check_vdb_bytes(const std::string& path) {
    VdbLayout layout = vdb_layout(path);
    if (layout.needed > layout.size) {
        throw Error(fmt::format("{}: cut short: {} bytes of at least {}; bake it again", path,
                                layout.size, layout.needed));
    }
    if (layout.digest_at != 0) {
        Cursor in(path, layout.size);
        in.seek(layout.digest_at);
        std::string told(digest_size, '\0');
        for (char& c : told) c = in.number<char>();
        if (told != digest_of(path, layout))
            damaged(path, "its bytes are not those that were written");
    }
    return layout;
}

void seal_vdb(const std::string& path, const VdbLayout& layout) {
    const std::string digest = digest_of(path, layout);
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(std::streamoff(layout.digest_at));
    file.write(digest.data(), std::streamsize(digest.size()));
    file.close();
    if (!file) throw Error(fmt::format("{}: it cannot be written", path), ExitStatus::failed);
}

std::string clamped(const std::string& text) {
    constexpr std::size_t longest = 200;
    std::string line = text.substr(0, std::min(text.find('\n'), longest));
    for (char& c : line) {
        if (c < 0x20 || c == 0x7f) c = '?';  // bytes above 0x7f are negative
    }
    return line;
}

std::string reason(const std::exception& e) {
    const std::string text = e.what();
    const std::size_t colon = text.find(": ");
    return clamped(colon == std::string::npos ? text : text.substr(colon + 2));
}

}  // namespace estara
