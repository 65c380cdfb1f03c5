#include "ply_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "loaders.h"

namespace estara {
namespace {

std::optional<PlyType> type_named(std::string_view word) {
    struct Name {
        std::string_view c, sized;
        PlyType type;
    };
    static constexpr Name names[] = {
        {"char", "int8", PlyType::i8},      {"uchar", "uint8", PlyType::u8},
        {"short", "int16", PlyType::i16},   {"ushort", "uint16", PlyType::u16},
        {"int", "int32", PlyType::i32},     {"uint", "uint32", PlyType::u32},
        {"float", "float32", PlyType::f32}, {"double", "float64", PlyType::f64}};
    for (const Name& name : names) {
        if (word == name.c || word == name.sized) return name.type;
    }
    return std::nullopt;
}

std::uint64_t size_of(PlyType type) noexcept {
    switch (type) {
        case PlyType::i8:
        case PlyType::u8:
            return 1;
        case PlyType::i16:
        case PlyType::u16:
            return 2;
        case PlyType::f64:
            return 8;
        default:
            return 4;
    }
}

class HeaderReader {
public:
    HeaderReader(const std::string& path, std::string_view file) : m_path(path), m_file(file) {}

    PlyHeader run() {
        constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
        if (m_file.starts_with(byte_order_mark)) m_at = byte_order_mark.size();
        // An old Macintosh's lines end in CR alone.
        const std::size_t first = m_file.find_first_of("\r\n");
        const bool cr = first != m_file.npos && m_file[first] == '\r';
        if (cr && m_file.substr(first, 2) != "\r\n") m_line_end = '\r';
        if (next_line() != "ply") {
            throw Error(fmt::format("{}: not a PLY file; it does not begin with 'ply'", m_path));
        }
        for (std::string line = next_line(); line != "end_header"; line = next_line()) take(line);
        if (!m_has_format) fail("no 'format' line");
        m_header.body = m_at;
        return std::move(m_header);
    }

private:
    std::string next_line() {
        // A binary file without line ends must not become one long message.
        constexpr std::size_t longest = 4096;
        const std::size_t end = m_file.substr(m_at, longest).find(m_line_end);
        ++m_line;
        if (end == std::string_view::npos) fail("the header has no end ('end_header')");
        std::string line(m_file.substr(m_at, end));
        m_at += end + 1;
        while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
        return line;
    }

    void take(const std::string& line) {
        std::istringstream words(line);
        std::string kind, a, b, c, d;
        words >> kind >> a >> b >> c >> d;
        if (kind == "format") {
            take_format(a, b);
        } else if (kind == "element") {
            take_element(a, b);
        } else if (kind == "property") {
            a == "list" ? take_property(d, c, b) : take_property(b, a, "");
        } else if (kind != "comment" && kind != "obj_info" && !kind.empty()) {
            fail(fmt::format("'{}' is none of format, element, property, comment", one_line(kind)));
        }
    }

    void take_format(const std::string& name, const std::string& version) {
        if (version != "1.0") fail(fmt::format("version '{}'; this reads 1.0", one_line(version)));
        m_has_format = true;
        if (name == "ascii") {
            m_header.format = PlyFormat::ascii;
        } else if (name == "binary_little_endian") {
            m_header.format = PlyFormat::little_endian;
        } else if (name == "binary_big_endian") {
            m_header.format = PlyFormat::big_endian;
        } else {
            fail(
                fmt::format("format '{}'; there are ascii, binary_little_endian and "
                            "binary_big_endian",
                            one_line(name)));
        }
    }

    void take_element(const std::string& name, const std::string& count) {
        PlyElement element;
        element.name = name;
        const char* end = count.data() + count.size();
        const auto [stop, code] = std::from_chars(count.data(), end, element.count);
        if (count.empty() || stop != end || code != std::errc()) {
            fail(fmt::format("'{}' is not a number of elements", one_line(count)));
        }
        for (const PlyElement& other : m_header.elements) {
            if (other.name == name) fail(fmt::format("a second element '{}'", one_line(name)));
        }
        m_header.elements.push_back(std::move(element));
    }

    void take_property(const std::string& name, const std::string& type, const std::string& size) {
        if (m_header.elements.empty()) fail("a property before the first element");
        if (name.empty()) fail("a property without a name");
        PlyProperty property;
        property.name = name;
        property.type = known(type);
        if (!size.empty()) property.list_size = known(size);
        m_header.elements.back().properties.push_back(std::move(property));
    }

    PlyType known(const std::string& word) const {
        const std::optional<PlyType> type = type_named(word);
        if (!type) {
            fail(
                fmt::format("unknown type '{}'; there are char, uchar, short, ushort, int, uint, "
                            "float, double",
                            one_line(word)));
        }
        return *type;
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(fmt::format("{}: line {}: {}", m_path, m_line, what));
    }

    std::string m_path;
    std::string_view m_file;
    std::size_t m_at = 0;
    char m_line_end = '\n';
    int m_line = 0;
    bool m_has_format = false;
    PlyHeader m_header;
};

}  // namespace

PlyHeader read_ply_header(const std::string& path, std::string_view file) {
    return HeaderReader(path, file).run();
}

PlyBody::PlyBody(const std::string& path, std::string_view file, const PlyHeader& header)
    : m_path(path), m_rest(file.substr(header.body)), m_format(header.format) {}

std::uint64_t PlyBody::smallest_size(PlyType type) const noexcept {
    return m_format == PlyFormat::ascii ? 2 : size_of(type);  // a digit and a blank
}

void PlyBody::begin(const PlyElement& element) {
    m_element = element.name;
    m_count = element.count;
    m_row = 0;
    std::uint64_t row_size = 0;
    for (const PlyProperty& p : element.properties) {
        row_size += smallest_size(p.list_size.value_or(p.type));
    }
    // The last blank of a text may be missing.
    if (row_size > 0 && element.count > (m_rest.size() + 1) / row_size) {
        throw Error(
            fmt::format("{}: {} of '{}' do not fit into the {} bytes left; is the file "
                        "truncated?",
                        m_path, element.count, one_line(m_element), m_rest.size()));
    }
}

double PlyBody::next(PlyType type) {
    if (m_format == PlyFormat::ascii) return next_word();
    switch (type) {
        case PlyType::i8:
            return next_binary<std::int8_t>();
        case PlyType::u8:
            return next_binary<std::uint8_t>();
        case PlyType::i16:
            return next_binary<std::int16_t>();
        case PlyType::u16:
            return next_binary<std::uint16_t>();
        case PlyType::i32:
            return next_binary<std::int32_t>();
        case PlyType::u32:
            return next_binary<std::uint32_t>();
        case PlyType::f32:
            return double(next_binary<float>());
        default:
            return next_binary<double>();
    }
}

std::uint64_t PlyBody::next_length(PlyType type, PlyType of) {
    const double length = next(type);
    if (!(length >= 0.0) || length != std::floor(length)) {
        fail(fmt::format("{} is not the length of a list", length));
    }
    const std::uint64_t most = (m_rest.size() + 1) / smallest_size(of);
    if (length > double(most)) {
        fail(fmt::format("a list of {} does not fit into the {} bytes left; is the file truncated?",
                         length, m_rest.size()));
    }
    return std::uint64_t(length);
}

void PlyBody::skip(const PlyProperty& property) {
    const std::uint64_t values =
        property.list_size ? next_length(*property.list_size, property.type) : 1;
    for (std::uint64_t i = 0; i < values; ++i) next(property.type);
}

void PlyBody::fail(const std::string& what) const {
    throw Error(
        fmt::format("{}: {} {} of {}: {}", m_path, one_line(m_element), m_row + 1, m_count, what));
}

double PlyBody::next_word() {
    constexpr const char* blanks = " \t\r\n\v\f";
    const std::size_t start = std::min(m_rest.find_first_not_of(blanks), m_rest.size());
    m_rest.remove_prefix(start);
    const std::string word(m_rest.substr(0, m_rest.find_first_of(blanks)));
    if (word.empty()) fail("the file ends here; is it truncated?");
    m_rest.remove_prefix(word.size());
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (end != word.c_str() + word.size())
        fail(fmt::format("'{}' is not a number", one_line(word)));
    return value;
}

template <class T>
double PlyBody::next_binary() {
    char bytes[sizeof(T)];
    if (m_rest.size() < sizeof(T)) fail("the file ends here; is it truncated?");
    std::memcpy(bytes, m_rest.data(), sizeof(T));
    m_rest.remove_prefix(sizeof(T));
    constexpr bool little_machine = std::endian::native == std::endian::little;
    if (little_machine != (m_format == PlyFormat::little_endian)) {
        std::reverse(bytes, bytes + sizeof(T));
    }
    return double(std::bit_cast<T>(bytes));
}

}  // namespace estara
