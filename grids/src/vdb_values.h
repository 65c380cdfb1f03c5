// A node's values as bytes of a .vdb file, after OpenVDB 10's io/Compression.h and
// io/Compression.cc. What OpenVDB does through a stream, a node at a time, with zlib, is done here
// from memory to memory, by any number of threads, with libdeflate: it writes and reads the same
// zlib streams in a third of the time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_bytes.h"

namespace estara {

/// How the values of a grid are stored.
struct ValueFormat {
    std::uint32_t compression = 0;  ///< OpenVDB's flags
    int components = 1;             ///< floats of a value: 1 or 3
    bool half = false;              ///< stored as half floats

    std::size_t stored_size() const noexcept {
        return std::size_t(components) * (half ? 2 : sizeof(float));
    }
};

/// Writes values. One thread at a time.
class ValueEncoder {
public:
    explicit ValueEncoder(const ValueFormat& format);
    ~ValueEncoder();

    /// Appends to `out`.
    /// @param values  format.components floats a value, one value after the other
    /// @param count   of values, at most 512
    void append(const float* values, std::size_t count, std::string& out);

private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

/// Where a node's values are in a file.
struct StoredValues {
    std::string_view bytes;
    bool is_compressed = false;
    bool has_inactive = false;  ///< all values are there, not only the active ones
};

/// Steps over what a node says of its inactive values, and over its values. Throws Cut.
/// @param size    voxels (or entries) of the node
/// @param active  how many of them are active
StoredValues take_values(ByteCursor& in, const ValueFormat& format, std::size_t size,
                         std::size_t active);

/// Reads values. One thread at a time.
class ValueDecoder {
public:
    explicit ValueDecoder(const ValueFormat& format);
    ~ValueDecoder();

    /// @param count  of values, at most 512
    /// @param out    format.components floats a value
    /// @return  false: the bytes are not those of so many values
    bool decode(const StoredValues& stored, std::size_t count, float* out);

private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace estara
