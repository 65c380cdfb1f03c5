// A node's values in a .vdb file:
//
//   what is known of inactive values u8 | up to two inactive values | [mask that selects one] |
//   [size i64] | bytes
//
// The size is there if the grid is compressed with zip or Blosc; one that is not positive means
// that so many bytes follow as they are.
#include "vdb_values.h"

#include <libdeflate.h>
#include <openvdb/io/Compression.h>

#include <algorithm>
#include <array>
#include <boost/interprocess/streams/bufferstream.hpp>
#include <new>
#include <sstream>

namespace estara {
namespace {

using openvdb::math::half;
namespace io = openvdb::io;

constexpr std::size_t most_floats = 512 * 3;

/// libdeflate's levels are 1 to 12; a higher one saves two per cent of floats for half as much time
/// again.
constexpr int zip_level = 1;

/// Values are stored as they are unless zip saves a fifth of their size. Noise in the last bits of
/// floats lets a leaf shrink by 15 % at most, and unpacking that takes ten times as long as the
/// rest of reading it.
constexpr std::size_t worth_zipping(std::size_t size) { return size - size / 5; }

/// Whether a sixteenth of the floats are the one before or that of the value before. Nodes of whole
/// floats without such repeats hardly ever shrink by a fifth: trying took two thirds of the time in
/// which noise was written.
bool has_repeats(const char* data, std::size_t floats, int components) {
    std::array<std::uint32_t, most_floats> bits;
    std::memcpy(bits.data(), data, floats * sizeof(float));
    const auto value = std::size_t(components);
    std::size_t repeats = 0;
    for (std::size_t i = value; i < floats; ++i) {
        repeats += std::size_t((bits[i] == bits[i - 1]) | (bits[i] == bits[i - value]));
    }
    return 16 * repeats >= floats;
}

bool has(const ValueFormat& format, std::uint32_t flag) { return (format.compression & flag) != 0; }

void append_raw(const void* data, std::size_t size, std::string& out) {
    out.append(static_cast<const char*>(data), size);
}

struct FreeCompressor {
    void operator()(libdeflate_compressor* c) const { libdeflate_free_compressor(c); }
};
struct FreeDecompressor {
    void operator()(libdeflate_decompressor* d) const { libdeflate_free_decompressor(d); }
};

template <class T>
T* or_bad_alloc(T* made) {
    if (!made) throw std::bad_alloc();
    return made;
}

}  // namespace

struct ValueEncoder::Impl {
    ValueFormat format;
    std::unique_ptr<libdeflate_compressor, FreeCompressor> zip;
    std::array<half, most_floats> halves;
    std::array<char, most_floats * sizeof(float)> packed;

    void append_zip(const char* data, std::size_t size, std::string& out) {
        std::size_t got = 0;
        if (format.half || has_repeats(data, size / sizeof(float), format.components)) {
            got =
                libdeflate_zlib_compress(zip.get(), data, size, packed.data(), worth_zipping(size));
        }
        const std::int64_t told = got > 0 ? std::int64_t(got) : -std::int64_t(size);
        append_raw(&told, sizeof told, out);
        append_raw(got > 0 ? packed.data() : data, got > 0 ? got : size, out);
    }
};

ValueEncoder::ValueEncoder(const ValueFormat& format) : m_impl(std::make_unique<Impl>()) {
    m_impl->format = format;
    if (has(format, io::COMPRESS_ZIP)) {
        m_impl->zip.reset(or_bad_alloc(libdeflate_alloc_compressor(zip_level)));
    }
}

ValueEncoder::~ValueEncoder() = default;

void ValueEncoder::append(const float* values, std::size_t count, std::string& out) {
    const ValueFormat& format = m_impl->format;
    const std::size_t floats = count * std::size_t(format.components);
    const char* data = reinterpret_cast<const char*>(values);
    if (format.half) {
        std::transform(values, values + floats, m_impl->halves.begin(),
                       [](float v) { return half(v); });
        data = reinterpret_cast<const char*>(m_impl->halves.data());
    }
    const std::size_t size = count * format.stored_size();
    if (has(format, io::COMPRESS_BLOSC)) {
        std::ostringstream stream;
        io::bloscToStream(stream, data, format.stored_size(), count);
        out += stream.view();
    } else if (has(format, io::COMPRESS_ZIP)) {
        m_impl->append_zip(data, size, out);
    } else {
        append_raw(data, size, out);
    }
}

StoredValues take_values(ByteCursor& in, const ValueFormat& format, std::size_t size,
                         std::size_t active) {
    const auto known = in.number<std::int8_t>();
    const std::size_t value_size = std::size_t(format.components) * sizeof(float);  // never half
    if (known == io::NO_MASK_AND_ONE_INACTIVE_VAL || known == io::MASK_AND_ONE_INACTIVE_VAL) {
        in.skip(value_size);
    }
    if (known == io::MASK_AND_TWO_INACTIVE_VALS) in.skip(2 * value_size);
    if (known == io::MASK_AND_NO_INACTIVE_VALS || known == io::MASK_AND_ONE_INACTIVE_VAL ||
        known == io::MASK_AND_TWO_INACTIVE_VALS) {
        in.skip(size / 8);
    }
    StoredValues stored;
    stored.has_inactive =
        !has(format, io::COMPRESS_ACTIVE_MASK) || known == io::NO_MASK_AND_ALL_VALS;
    std::uint64_t bytes = (stored.has_inactive ? size : active) * format.stored_size();
    const bool is_packed = has(format, io::COMPRESS_ZIP | io::COMPRESS_BLOSC);
    if (is_packed && !(format.half && bytes == 0)) {  // no half floats at all have no size either
        const auto told = in.number<std::int64_t>();
        stored.is_compressed = told > 0;
        bytes = told > 0 ? std::uint64_t(told) : -std::uint64_t(told);
    }
    stored.bytes = in.take(bytes);
    return stored;
}

struct ValueDecoder::Impl {
    ValueFormat format;
    std::unique_ptr<libdeflate_decompressor, FreeDecompressor> zip;
    std::array<half, most_floats> halves;

    bool unpack(const StoredValues& stored, char* out, std::size_t size) {
        if (!stored.is_compressed) {
            if (stored.bytes.size() != size) return false;
            std::memcpy(out, stored.bytes.data(), size);
            return true;
        }
        if (has(format, io::COMPRESS_BLOSC)) {
            // OpenVDB reads the size itself: it is in front of the bytes.
            boost::interprocess::ibufferstream stream(stored.bytes.data() - sizeof(std::int64_t),
                                                      stored.bytes.size() + sizeof(std::int64_t));
            io::bloscFromStream(stream, out, size);
            return true;
        }
        // Without a place for the actual size it must be exactly that.
        return libdeflate_zlib_decompress(zip.get(), stored.bytes.data(), stored.bytes.size(), out,
                                          size, nullptr) == LIBDEFLATE_SUCCESS;
    }
};

ValueDecoder::ValueDecoder(const ValueFormat& format) : m_impl(std::make_unique<Impl>()) {
    m_impl->format = format;
    if (has(format, io::COMPRESS_ZIP)) {
        m_impl->zip.reset(or_bad_alloc(libdeflate_alloc_decompressor()));
    }
}

ValueDecoder::~ValueDecoder() = default;

bool ValueDecoder::decode(const StoredValues& stored, std::size_t count, float* out) {
    const ValueFormat& format = m_impl->format;
    const std::size_t size = count * format.stored_size();
    if (!format.half) return m_impl->unpack(stored, reinterpret_cast<char*>(out), size);
    const auto halves = m_impl->halves.begin();
    if (!m_impl->unpack(stored, reinterpret_cast<char*>(&*halves), size)) return false;
    std::copy(halves, halves + std::ptrdiff_t(count) * format.components, out);
    return true;
}

}  // namespace estara
