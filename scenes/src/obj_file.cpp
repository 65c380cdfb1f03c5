#include "obj_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <string_view>

namespace estara {
namespace {

/// One line, taken apart at blanks.
class Words {
public:
    explicit Words(std::string_view line) : m_rest(line) {}
    /// The next word, or an empty one at the end.
    std::string_view next() {
        const std::size_t start = m_rest.find_first_not_of(" \t\v\f");
        if (start == std::string_view::npos) return {};
        m_rest.remove_prefix(start);
        const std::string_view word = m_rest.substr(0, m_rest.find_first_of(" \t\v\f"));
        m_rest.remove_prefix(word.size());
        return word;
    }
    /// All that is left, without blanks around.
    std::string rest() {
        const std::size_t start = m_rest.find_first_not_of(" \t\v\f");
        if (start == std::string_view::npos) return "";
        return std::string(m_rest.substr(start, m_rest.find_last_not_of(" \t\v\f") - start + 1));
    }

private:
    std::string_view m_rest;
};

/// Position, normal or texture coordinates: how many are there, and the largest index used.
struct Counted {
    const char* noun;
    std::int64_t count = 0;
    std::int64_t largest = 0;
    std::int64_t largest_line = 0;
};

class Parser {
public:
    explicit Parser(const std::string& path) : m_path(path) {}

    ObjFile run(std::string_view text) {
        constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
        if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
        std::string joined;  // of lines that are continued
        while (!text.empty()) {
            const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
            std::string_view line = text.substr(0, end);
            const bool both = text.substr(end, 2) == "\r\n";
            text.remove_prefix(std::min(text.size(), end + (both ? 2 : 1)));
            ++m_line;
            const bool goes_on = line.ends_with('\\') && line.find('#') == line.npos;
            if (goes_on) line.remove_suffix(1);
            if (joined.empty() && !goes_on) {
                take_line(line);
                continue;
            }
            joined += line;
            joined += ' ';
            if (goes_on) continue;
            take_line(joined);
            joined.clear();
        }
        if (!joined.empty()) take_line(joined);
        for (const Counted& c : m_counted) {
            if (c.largest > c.count) out_of_range(c, c.largest, c.largest_line);
        }
        return std::move(m_file);
    }

private:
    void take_line(std::string_view line) {
        line = line.substr(0, line.find('#'));
        Words words(line);
        const std::string_view kind = words.next();
        if (kind == "v") return take_position(words);
        if (kind == "vt") {
            const std::array<float, 3> v = numbers(m_counted[1], 1, words);
            m_file.uvs.emplace_back(v[0], v[1]);
        } else if (kind == "vn") {
            const std::array<float, 3> v = numbers(m_counted[2], 3, words);
            m_file.normals.emplace_back(v[0], v[1], v[2]);
        } else if (kind == "f") {
            take_face(words);
        } else if (kind == "l" || kind == "p") {
            for (auto word = words.next(); !word.empty(); word = words.next()) corner(word);
            ++m_file.lines_and_points;
        } else if (kind == "curv" || kind == "curv2" || kind == "surf") {
            ++m_file.curves;
        } else if (kind == "o") {
            m_object = words.rest();
            m_group.clear();
            m_part = -1;
        } else if (kind == "g") {
            m_group = words.rest();
            if (m_group == "default") m_group.clear();
            m_part = -1;
        } else if (kind == "usemtl") {
            m_material = words.rest();
            m_part = -1;
        } else if (kind == "mtllib") {
            m_file.material_files.push_back(words.rest());
        } else if (kind == "s") {
            const std::string group(words.next());
            m_smoothing = group == "off" || group == "null" ? 0 : std::atoi(group.c_str());
            m_file.has_smoothing = true;
        }
    }

    void take_position(Words words) {
        const std::array<float, 3> v = numbers(m_counted[0], 3, words);
        m_file.positions.emplace_back(v[0], v[1], v[2]);
        int count = 0;
        while (!words.next().empty()) ++count;
        if (count >= 6) ++m_file.colours;
    }

    std::array<float, 3> numbers(Counted& counted, int needed, Words words) {
        ++counted.count;
        std::array<float, 3> values{};
        for (int k = 0; k < 3; ++k) {
            const std::string word(words.next());
            if (word.empty() && k >= needed) break;
            char* end = nullptr;
            const float value = float(std::strtod(word.c_str(), &end));
            if (word.empty() || *end != '\0' || !std::isfinite(value)) {
                throw Error(fmt::format(
                    "{}: line {}: {} {}: {}", m_path, m_line, counted.noun, counted.count,
                    word.empty() ? fmt::format("{} numbers, it needs {}", k, needed)
                                 : fmt::format("'{}' is not a finite number",
                                               one_line(word, longest_name))));
            }
            values[std::size_t(k)] = value;
        }
        return values;
    }

    void take_face(Words words) {
        ObjFace face;
        face.first = std::uint32_t(m_file.corners.size());
        for (auto word = words.next(); !word.empty(); word = words.next()) {
            m_file.corners.push_back(corner(word));
        }
        face.count = std::uint32_t(m_file.corners.size()) - face.first;
        face.part = part();
        face.smoothing = m_smoothing;
        face.line = m_line;
        m_file.faces.push_back(face);
    }

    /// The part that faces belong to now.
    int part() {
        if (m_part >= 0) return m_part;
        const std::string both =
            m_object + (m_group.empty() || m_object.empty() ? "" : "_") + m_group;
        // Blender's groups repeat the name of their object.
        const bool repeats = !m_object.empty() && m_group.starts_with(m_object);
        const std::string name = repeats ? m_group : both;
        const auto [place, is_new] = m_parts.try_emplace({name, m_material}, m_file.parts.size());
        if (is_new) m_file.parts.push_back({name, m_material});
        return m_part = int(place->second);
    }

    /// "1", "1/2", "1//3", "1/2/3", and as some write them "1/", "1//" and "1/2/".
    ObjCorner corner(std::string_view word) {
        std::string_view rest = word;
        ObjCorner found;
        for (int k = 0; k < 3; ++k) {
            const std::string number(rest.substr(0, rest.find('/')));
            const bool left_out = number.empty() && k > 0;
            const std::int32_t index =
                left_out ? -1 : take_index(m_counted[std::size_t(k)], number, word);
            (k == 0 ? found.position : k == 1 ? found.uv : found.normal) = index;
            if (number.size() == rest.size()) return found;
            rest.remove_prefix(number.size() + 1);
        }
        not_a_corner(word);
    }

    std::int32_t take_index(Counted& counted, const std::string& number, std::string_view word) {
        char* end = nullptr;
        const long long index = std::strtoll(number.c_str(), &end, 10);
        if (number.empty() || *end != '\0' || index == 0) not_a_corner(word);
        if (index < -counted.count || index > std::numeric_limits<int>::max()) {
            out_of_range(counted, index, m_line);
        }
        if (index > counted.largest) {
            counted.largest = index;
            counted.largest_line = m_line;
        }
        return std::int32_t(index > 0 ? index - 1 : counted.count + index);
    }

    [[noreturn]] void not_a_corner(std::string_view word) const {
        throw Error(
            fmt::format("{}: line {}: '{}' is not a corner; it is written 1, 1/2, 1//3 or "
                        "1/2/3, counting from 1",
                        m_path, m_line, one_line(std::string(word), longest_name)));
    }

    [[noreturn]] void out_of_range(const Counted& c, std::int64_t index, std::int64_t line) const {
        throw Error(fmt::format("{}: line {}: there is no {} {}; the file has {}", m_path, line,
                                c.noun, index, c.count));
    }

    std::string m_path;
    ObjFile m_file;
    std::int64_t m_line = 0;
    std::array<Counted, 3> m_counted{Counted{"vertex"}, Counted{"texture coordinate"},
                                     Counted{"normal"}};
    std::string m_object, m_group, m_material;
    int m_part = -1;  ///< -1: to be looked up
    int m_smoothing = 0;
    std::map<std::pair<std::string, std::string>, std::size_t> m_parts;
};

}  // namespace

ObjFile parse_obj(const std::string& path, std::string_view text) { return Parser(path).run(text); }

}  // namespace estara
