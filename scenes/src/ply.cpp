// Meshes in PLY files: polygons or triangle strips, with normals and texture coordinates if given.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <span>

#include "loaders.h"
#include "ply_file.h"
#include "triangulate.h"

namespace estara {
namespace {

/// What a property of a vertex is: its place in x y z nx ny nz u v, or -1.
int slot(const PlyProperty& property) {
    if (property.list_size) return -1;
    static constexpr std::array<std::array<std::string_view, 3>, 8> names{
        {{"x", "x", "x"},
         {"y", "y", "y"},
         {"z", "z", "z"},
         {"nx", "nx", "nx"},
         {"ny", "ny", "ny"},
         {"nz", "nz", "nz"},
         {"u", "s", "texture_u"},
         {"v", "t", "texture_v"}}};
    for (std::size_t i = 0; i < names.size(); ++i) {
        for (const std::string_view name : names[i]) {
            if (property.name == name) return int(i);
        }
    }
    return -1;
}

class MeshReader {
public:
    MeshReader(const std::string& path, std::string_view file, std::vector<std::string>& warnings)
        : m_path(path),
          m_warnings(warnings),
          m_header(read_ply_header(path, file)),
          m_body(path, file, m_header) {}

    Mesh run() {
        for (const PlyElement& element : m_header.elements) {
            if (element.name == "vertex") m_vertices = element.count;
        }
        for (const PlyElement& element : m_header.elements) read_element(element);
        cut_polygons();
        tell_of_colours();
        if (m_mesh.triangles.empty()) {
            throw Error(fmt::format("{}: no triangles; it has {} vertices", m_path, m_vertices));
        }
        if (m_mesh.N.empty()) m_mesh.N = smooth_normals(m_mesh.P, m_mesh.triangles);
        mend_normals(m_mesh);
        return std::move(m_mesh);
    }

private:
    void read_element(const PlyElement& element) {
        m_body.begin(element);
        if (element.properties.empty()) return;
        if (element.name == "vertex") return read_vertices(element);
        const bool strips = element.name == "tristrips";
        const bool used = strips || element.name == "face";
        for (std::uint64_t row = 0; row < element.count; ++row) {
            m_body.begin_row(row);
            for (const PlyProperty& p : element.properties) {
                const bool corners = p.name == "vertex_indices" || p.name == "vertex_index";
                if (!used || !corners || !p.list_size) {
                    m_body.skip(p);
                } else {
                    strips ? read_strip(p) : read_polygon(p);
                }
            }
        }
    }

    void read_vertices(const PlyElement& element) {
        std::vector<int> slots;
        std::array<bool, 8> given{};
        for (const PlyProperty& p : element.properties) {
            slots.push_back(slot(p));
            if (slots.back() >= 0) given[std::size_t(slots.back())] = true;
        }
        if (!given[0] || !given[1] || !given[2]) {
            throw Error(fmt::format("{}: its vertices have no x, y and z", m_path));
        }
        const bool has_normals = given[3] && given[4] && given[5];
        const bool has_uv = given[6] && given[7];
        for (std::uint64_t row = 0; row < element.count; ++row) {
            m_body.begin_row(row);
            const std::array<float, 8> v = read_vertex(element, slots);
            m_mesh.P.emplace_back(v[0], v[1], v[2]);
            if (has_normals) m_mesh.N.emplace_back(v[3], v[4], v[5]);
            if (has_uv) m_mesh.uv.emplace_back(v[6], v[7]);
        }
    }

    std::array<float, 8> read_vertex(const PlyElement& element, const std::vector<int>& slots) {
        std::array<float, 8> v{};
        for (std::size_t i = 0; i < slots.size(); ++i) {
            const PlyProperty& p = element.properties[i];
            if (slots[i] < 0) {
                m_body.skip(p);
                continue;
            }
            const double value = m_body.next(p.type);
            const float rounded = float(value);
            if (!std::isfinite(rounded)) {
                m_body.fail(fmt::format("{} is {}, not a finite number", p.name, value));
            }
            v[std::size_t(slots[i])] = rounded;
        }
        return v;
    }

    /// A vertex's index, or nothing for the -1 between strips.
    std::optional<std::uint32_t> read_index(PlyType type, bool may_restart) {
        const double index = m_body.next(type);
        if (may_restart && index == -1.0) return std::nullopt;
        if (!(index >= 0.0 && index < double(m_vertices)) || index != std::floor(index) ||
            index >= 4294967295.0) {
            m_body.fail(fmt::format("there is no vertex {}; the file has {}, counted from 0", index,
                                    m_vertices));
        }
        return std::uint32_t(index);
    }

    /// Polygons are cut once the positions are known: an element "face" may come first.
    void read_polygon(const PlyProperty& p) {
        const std::uint64_t corners = m_body.next_length(*p.list_size, p.type);
        for (std::uint64_t k = 0; k < corners; ++k) {
            m_corners.push_back(*read_index(p.type, false));
        }
        m_polygon_ends.push_back(m_corners.size());
    }

    void cut_polygons() {
        std::size_t first = 0, degenerate = 0;
        for (const std::size_t end : m_polygon_ends) {
            const std::span<const std::uint32_t> corners(m_corners.data() + first, end - first);
            degenerate += triangulate(corners, m_mesh.P, m_mesh.triangles) ? 0 : 1;
            first = end;
        }
        if (degenerate == 0 || m_mesh.triangles.empty()) return;
        m_warnings.push_back(fmt::format(
            "{}: not shown: {} faces with fewer than three different corners", m_path, degenerate));
    }

    void read_strip(const PlyProperty& p) {
        const std::uint64_t length = m_body.next_length(*p.list_size, p.type);
        std::uint64_t in_strip = 0;
        std::uint32_t a = 0, b = 0;  // the two vertices before
        for (std::uint64_t k = 0; k < length; ++k) {
            const std::optional<std::uint32_t> v = read_index(p.type, true);
            if (!v) {
                in_strip = 0;
                continue;
            }
            // Repeated vertices only lead the strip elsewhere.
            if (in_strip >= 2 && a != b && b != *v && a != *v) {
                // Every second triangle is wound the other way.
                in_strip % 2 == 0 ? m_mesh.triangles.emplace_back(a, b, *v)
                                  : m_mesh.triangles.emplace_back(b, a, *v);
            }
            a = b;
            b = *v;
            ++in_strip;
        }
    }

    void tell_of_colours() {
        for (const PlyElement& element : m_header.elements) {
            for (const PlyProperty& p : element.properties) {
                if (p.name != "red" && p.name != "diffuse_red") continue;
                m_warnings.push_back(fmt::format("{}: not shown: colours of the element '{}'",
                                                 m_path, one_line(element.name, longest_name)));
            }
        }
    }

    std::string m_path;
    std::vector<std::string>& m_warnings;
    std::vector<std::uint32_t> m_corners;     ///< of all polygons
    std::vector<std::size_t> m_polygon_ends;  ///< in m_corners
    PlyHeader m_header;
    PlyBody m_body;
    std::uint64_t m_vertices = 0;
    Mesh m_mesh;
};

}  // namespace

Mesh read_ply(const std::string& path, std::vector<std::string>& warnings) {
    const std::string file = read_file(path);
    return MeshReader(path, file, warnings).run();
}

}  // namespace estara
