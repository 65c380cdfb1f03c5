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

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "estara/scenes/error.h"

namespace estara {
namespace {

constexpr std::int64_t magic = 0x56444220;
constexpr std::uint32_t oldest_format = 222, newest_format = 224;
constexpr std::uint64_t uuid_at = 21, uuid_size = 36;  // random, so not part of the digest
constexpr std::uint64_t digest_size = 16;
constexpr std::string_view half_suffix = "_HalfFloat";

std::string text(const std::string& path, ByteCursor& in) {
    constexpr std::uint32_t longest = 1 << 16;  // all texts read here are names
    const auto length = in.number<std::uint32_t>();
    const std::string_view bytes = in.take(length);
    if (length > longest) damaged(path, fmt::format("a name of {} characters", length));
    return std::string(bytes);
}

[[noreturn]] void not_a_vdb(const std::string& path) {
    throw Error(fmt::format("{}: not a .vdb file", path));
}

void read_start(const std::string& path, ByteCursor& in, VdbLayout& layout) {
    if (in.number<std::int64_t>() != magic) not_a_vdb(path);
    layout.format = in.number<std::uint32_t>();
    if (layout.format < oldest_format || layout.format > newest_format) {
        throw Error(fmt::format("{}: .vdb format {}; this program reads {} to {}", path,
                                layout.format, oldest_format, newest_format));
    }
    layout.library_major = in.number<std::uint32_t>();
    layout.library_minor = in.number<std::uint32_t>();
    if (in.number<char>() != 1) {
        throw Error(
            fmt::format("{}: a .vdb stream without positions; not made by estara-bake", path));
    }
    in.skip(uuid_size);
}

/// @return  where the digest is, or 0
std::uint64_t read_metadata(const std::string& path, ByteCursor& in) {
    std::uint64_t digest_at = 0;
    const auto count = in.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::string name = text(path, in), type = text(path, in);
        const auto length = in.number<std::uint32_t>();
        if (name == digest_key && type == "string" && length == digest_size) digest_at = in.at();
        in.skip(length);
    }
    return digest_at;
}

void read_grids(const std::string& path, ByteCursor& in, VdbLayout& layout) {
    const auto count = in.number<std::int32_t>();
    for (std::int32_t i = 0; i < count; ++i) {
        StoredGrid grid;
        grid.name = text(path, in);
        grid.name = grid.name.substr(0, grid.name.find('\x1e'));  // then a number, if not unique
        grid.type = text(path, in);
        if (grid.type.ends_with(half_suffix)) {
            grid.half = true;
            grid.type.resize(grid.type.size() - half_suffix.size());
        }
        grid.is_instance = !text(path, in).empty();
        const auto data = in.number<std::int64_t>(), buffers = in.number<std::int64_t>(),
                   end = in.number<std::int64_t>();
        if (data < std::int64_t(in.at()) || buffers < data || end < buffers) {
            damaged(path,
                    fmt::format("the position of grid \"{}\" makes no sense", clamped(grid.name)));
        }
        grid.data = std::uint64_t(data);
        grid.buffers = std::uint64_t(buffers);
        grid.end = std::uint64_t(end);
        in.seek(grid.end);
        in.seek(grid.data);
        in.skip(4);               // how it is compressed
        read_metadata(path, in);  // its lengths must be sound: OpenVDB allocates what they say
        in.seek(grid.end);
        layout.grids.push_back(std::move(grid));
    }
    layout.needed = in.at();
}

}  // namespace

MappedFile::MappedFile(const std::string& path) {
    const auto check = [&](bool fine) {
        if (!fine) {
            throw Error(fmt::format("{}: it cannot be read: {}", path, std::strerror(errno)));
        }
    };
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0 && (errno == ENOENT || errno == ENOTDIR)) {
        throw Error(fmt::format("{}: no such file", path));
    }
    check(file >= 0);
    struct stat status {};
    const bool known = fstat(file, &status) == 0;
    const auto size = std::size_t(status.st_size);
    const bool is_file = known && S_ISREG(status.st_mode);
    void* start =
        is_file && size > 0 ? mmap(nullptr, size, PROT_READ, MAP_SHARED, file, 0) : nullptr;
    const int error = errno;
    close(file);
    errno = error;
    check(known && start != MAP_FAILED);
    if (!is_file) throw Error(fmt::format("{}: not a file", path));
    if (size == 0) throw Error(fmt::format("{}: the file is empty", path));
    madvise(start, size, MADV_WILLNEED);
    m_bytes = {static_cast<const char*>(start), size};
}

MappedFile::~MappedFile() { munmap(const_cast<char*>(m_bytes.data()), m_bytes.size()); }

void MappedFile::forget(std::uint64_t from, std::uint64_t to) const noexcept {
    const auto page = std::uint64_t(sysconf(_SC_PAGESIZE));
    from = (from + page - 1) / page * page;
    to = to / page * page;
    if (from < to) madvise(const_cast<char*>(m_bytes.data()) + from, to - from, MADV_DONTNEED);
}

VdbLayout vdb_layout(const std::string& path, const MappedFile& file) {
    VdbLayout layout;
    layout.size = file.bytes().size();
    ByteCursor in(file.bytes());
    try {
        read_start(path, in, layout);
        layout.digest_at = read_metadata(path, in);
        read_grids(path, in, layout);
    } catch (const Cut& cut) {
        if (layout.size < sizeof magic) not_a_vdb(path);
        layout.needed = cut.needed;
    }
    return layout;
}

VdbLayout whole_vdb_layout(const std::string& path, const MappedFile& file) {
    VdbLayout layout = vdb_layout(path, file);
    if (layout.needed > layout.size) {
        throw Error(fmt::format("{}: cut short: {} bytes of at least {}; bake it again", path,
                                layout.size, layout.needed));
    }
    return layout;
}

void check_vdb_digest(const std::string& path, const MappedFile& file, const VdbLayout& layout) {
    if (layout.digest_at != 0 &&
        file.bytes().substr(layout.digest_at, digest_size) != vdb_digest(file, layout)) {
        damaged(path, "its bytes are not those that were written");
    }
}

std::string vdb_digest(const MappedFile& file, const VdbLayout& layout) {
    constexpr std::uint64_t at_once = 16 << 20;
    const std::string_view bytes = file.bytes();
    std::string start(bytes.substr(0, layout.digest_at + digest_size));
    start.replace(uuid_at, uuid_size, uuid_size, '0');
    start.replace(layout.digest_at, digest_size, digest_size, '0');
    XXH3_state_t state;
    XXH3_64bits_reset(&state);
    XXH3_64bits_update(&state, start.data(), start.size());
    for (std::uint64_t at = start.size(); at < bytes.size(); at += at_once) {
        const std::string_view part = bytes.substr(at, at_once);
        XXH3_64bits_update(&state, part.data(), part.size());
        file.forget(at, at + part.size());
    }
    return fmt::format("{:016x}", XXH3_64bits_digest(&state));
}

void damaged(const std::string& path, const std::string& what) {
    throw Error(fmt::format("{}: damaged: {}; bake it again", path, what));
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
