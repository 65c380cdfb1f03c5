// Wavefront OBJ. tinyobjloader reads it; but it takes "nan" for 0 and leaves out faces whose
// indices are wrong, so the numbers are checked here first, by line.
#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <string_view>

#include "loaders.h"

namespace estara {
namespace {

/// One line, taken apart at blanks.
class Words {
public:
    explicit Words(std::string_view line) : m_rest(line) {}
    /// The next word, or an empty one at the end.
    std::string_view next() {
        const std::size_t start = m_rest.find_first_not_of(" \t");
        if (start == std::string_view::npos) return {};
        m_rest.remove_prefix(start);
        const std::string_view word = m_rest.substr(0, m_rest.find_first_of(" \t"));
        m_rest.remove_prefix(word.size());
        return word;
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

/// Checks the text of a file line by line.
class ObjCheck {
public:
    explicit ObjCheck(const std::string& path) : m_path(path) {}

    void run(std::string_view text) {
        while (!text.empty()) {
            const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
            ++m_line;
            check_line(text.substr(0, end));
            const bool both = text.substr(end, 2) == "\r\n";
            text.remove_prefix(std::min(text.size(), end + (both ? 2 : 1)));
        }
        for (const Counted& c : m_counted) {
            if (c.largest > c.count) out_of_range(c, c.largest, c.largest_line);
        }
    }

private:
    void check_line(std::string_view line) {
        Words words(line);
        const std::string_view kind = words.next();
        if (kind == "v") check_numbers(m_counted[0], 3, words);
        if (kind == "vt") check_numbers(m_counted[1], 1, words);
        if (kind == "vn") check_numbers(m_counted[2], 3, words);
        if (kind == "f" || kind == "l" || kind == "p") {
            for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
                check_corner(word);
            }
        }
    }

    void check_numbers(Counted& counted, int needed, Words words) {
        ++counted.count;
        for (int k = 0; k < 3; ++k) {
            const std::string word(words.next());
            if (word.empty() && k >= needed) return;
            char* end = nullptr;
            const float value = float(std::strtod(word.c_str(), &end));
            if (!word.empty() && *end == '\0' && std::isfinite(value)) continue;
            throw Error(fmt::format(
                "{}: line {}: {} {}: {}", m_path, m_line, counted.noun, counted.count,
                word.empty() ? fmt::format("{} numbers, it needs {}", k, needed)
                             : fmt::format("'{}' is not a finite number", one_line(word))));
        }
    }

    /// "1", "1/2", "1//3" or "1/2/3".
    void check_corner(std::string_view word) {
        std::string_view rest = word;
        for (int k = 0; k < 3; ++k) {
            const std::string number(rest.substr(0, rest.find('/')));
            const bool left_out = number.empty() && k == 1 && rest.size() > 1;
            if (!left_out) check_index(m_counted[std::size_t(k)], number, word);
            if (number.size() == rest.size()) return;
            rest.remove_prefix(number.size() + 1);
        }
        not_an_index(word);
    }

    void check_index(Counted& counted, const std::string& number, std::string_view word) {
        char* end = nullptr;
        const long long index = std::strtoll(number.c_str(), &end, 10);
        if (number.empty() || *end != '\0' || index == 0) not_an_index(word);
        if (index < -counted.count || index > std::numeric_limits<int>::max()) {
            out_of_range(counted, index, m_line);
        }
        if (index > counted.largest) {
            counted.largest = index;
            counted.largest_line = m_line;
        }
    }

    [[noreturn]] void not_an_index(std::string_view word) const {
        throw Error(
            fmt::format("{}: line {}: '{}' is not a corner; it is written 1, 1/2, 1//3 or "
                        "1/2/3, counting from 1",
                        m_path, m_line, one_line(std::string(word))));
    }

    [[noreturn]] void out_of_range(const Counted& c, std::int64_t index, std::int64_t line) const {
        throw Error(fmt::format("{}: line {}: there is no {} {}; the file has {}", m_path, line,
                                c.noun, index, c.count));
    }

    std::string m_path;
    std::int64_t m_line = 0;
    std::array<Counted, 3> m_counted{Counted{"vertex"}, Counted{"texture coordinate"},
                                     Counted{"normal"}};
};

/// Corners of all shapes, three a triangle.
std::vector<tinyobj::index_t> corners(const std::vector<tinyobj::shape_t>& shapes) {
    std::vector<tinyobj::index_t> all;
    for (const tinyobj::shape_t& shape : shapes) {
        all.insert(all.end(), shape.mesh.indices.begin(), shape.mesh.indices.end());
    }
    return all;
}

std::vector<glm::vec3> triples(const std::vector<float>& values) {
    std::vector<glm::vec3> result(values.size() / 3);
    for (std::size_t i = 0; i < result.size(); ++i) {
        result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    }
    return result;
}

/// Gives every different (position, normal, texture coordinate) a vertex of its own.
class VertexTable {
public:
    VertexTable(const tinyobj::attrib_t& attrib, bool has_uv, std::vector<glm::vec3> positions,
                std::vector<glm::vec3> normals)
        : m_uv(has_uv ? attrib.texcoords : std::vector<float>{}),
          m_positions(std::move(positions)),
          m_normals(std::move(normals)),
          m_first(m_positions.size()) {}

    std::uint32_t vertex(const tinyobj::index_t& corner, int normal) {
        std::vector<Known>& known = m_first[std::size_t(corner.vertex_index)];
        const int uv = m_uv.empty() ? -1 : corner.texcoord_index;
        for (const Known& k : known) {
            if (k.normal == normal && k.uv == uv) return k.vertex;
        }
        const std::uint32_t vertex = std::uint32_t(m_mesh.P.size());
        known.push_back({normal, uv, vertex});
        m_mesh.P.push_back(m_positions[std::size_t(corner.vertex_index)]);
        m_mesh.N.push_back(m_normals[std::size_t(normal)]);
        if (!m_uv.empty()) {
            const std::size_t at = 2 * std::size_t(std::max(uv, 0));
            m_mesh.uv.push_back(uv < 0 ? glm::vec2(0.0f) : glm::vec2(m_uv[at], m_uv[at + 1]));
        }
        return vertex;
    }

    Mesh take(std::vector<glm::uvec3> triangles) {
        m_mesh.triangles = std::move(triangles);
        return std::move(m_mesh);
    }

private:
    struct Known {
        int normal, uv;
        std::uint32_t vertex;
    };
    std::vector<float> m_uv;
    std::vector<glm::vec3> m_positions, m_normals;
    std::vector<std::vector<Known>> m_first;  // by position
    Mesh m_mesh;
};

Mesh mesh_of(const tinyobj::attrib_t& attrib, const std::vector<tinyobj::index_t>& all) {
    const auto every = [&](auto test) { return std::all_of(all.begin(), all.end(), test); };
    const bool has_normals = every([](const auto& c) { return c.normal_index >= 0; });
    const bool has_uv = !every([](const auto& c) { return c.texcoord_index < 0; });

    std::vector<glm::vec3> P = triples(attrib.vertices), N = triples(attrib.normals);
    if (!has_normals) {
        // Computed on the positions, so that a seam of the texture is none of the shading.
        std::vector<glm::uvec3> triangles;
        for (std::size_t i = 0; i + 2 < all.size(); i += 3) {
            triangles.emplace_back(all[i].vertex_index, all[i + 1].vertex_index,
                                   all[i + 2].vertex_index);
        }
        N = smooth_normals(P, triangles);
    }
    VertexTable table(attrib, has_uv, std::move(P), std::move(N));
    std::vector<glm::uvec3> triangles;
    for (std::size_t i = 0; i + 2 < all.size(); i += 3) {
        glm::uvec3 t{};
        for (int k = 0; k < 3; ++k) {
            const tinyobj::index_t& corner = all[i + std::size_t(k)];
            t[k] = table.vertex(corner, has_normals ? corner.normal_index : corner.vertex_index);
        }
        triangles.push_back(t);
    }
    return table.take(std::move(triangles));
}

}  // namespace

Mesh read_obj(const std::string& path) {
    std::string text = read_file(path);
    ObjCheck(path).run(text);

    tinyobj::attrib_t attrib;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warnings, errors;
    std::istringstream stream(std::move(text));
    if (!tinyobj::LoadObj(&attrib, &shapes, &materials, &warnings, &errors, &stream)) {
        throw Error(fmt::format("{}: cannot be read as OBJ: {}", path, one_line(errors)));
    }
    const std::vector<tinyobj::index_t> all = corners(shapes);
    if (all.empty()) {
        throw Error(fmt::format("{}: no triangles; it has {} vertices and no face", path,
                                attrib.vertices.size() / 3));
    }
    Mesh mesh = mesh_of(attrib, all);
    mend_normals(mesh);
    return mesh;
}

}  // namespace estara
