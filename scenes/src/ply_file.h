// The PLY container: elements with properties, as text or binary, without a meaning yet.
// (Turk 1994, "The PLY Polygon File Format".) Private to this folder.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace estara {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::f32;
    std::optional<PlyType> list_size;  ///< type of the number in front; none: a single value
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

enum class PlyFormat { ascii, little_endian, big_endian };

struct PlyHeader {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;
    std::size_t body = 0;  ///< where the values start in the file, bytes
};

/// Reads the header. Error (beginning with path) if it is not one.
PlyHeader read_ply_header(const std::string& path, std::string_view file);

/// The values after the header, one after the other.
class PlyBody {
public:
    PlyBody(const std::string& path, std::string_view file, const PlyHeader& header);

    /// Names the element that is read next in messages, and checks that the file is long enough
    /// to hold that many.
    void begin(const PlyElement& element);
    void begin_row(std::uint64_t row) noexcept { m_row = row; }

    /// The next value; whole numbers of up to 32 bits are exact. Error at the end of the file.
    double next(PlyType type);
    /// The next value as the length of a list: whole, >= 0 and not more than the file can hold.
    std::uint64_t next_length(PlyType type, PlyType of);
    void skip(const PlyProperty& property);

    /// Error that says which row of which element.
    [[noreturn]] void fail(const std::string& what) const;

private:
    double next_word();
    template <class T>
    double next_binary();
    std::uint64_t smallest_size(PlyType type) const noexcept;

    std::string m_path, m_element;
    std::string_view m_rest;
    PlyFormat m_format;
    std::uint64_t m_row = 0, m_count = 0;
};

}  // namespace estara
