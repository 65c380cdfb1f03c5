// Wavefront OBJ: objects, groups and materials as objects.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "obj_file.h"
#include "triangulate.h"

namespace estara {
namespace {

/// A triangle of corners of the file.
struct Triangle {
    std::array<std::uint32_t, 3> corner;
    std::uint32_t face;
};

class ObjReader {
public:
    explicit ObjReader(const std::string& path) : m_path(path) {
        m_file = parse_obj(path, read_file(path));
        cut_faces();
        if (m_triangles.empty()) fail_without_triangles();
        find_normals();
    }

    std::vector<Object> objects(std::vector<std::string>& warnings) {
        read_material_files(warnings);
        std::vector<std::vector<std::uint32_t>> of_part(m_file.parts.size());
        for (std::uint32_t t = 0; t < m_triangles.size(); ++t) {
            of_part[std::size_t(m_file.faces[m_triangles[t].face].part)].push_back(t);
        }
        std::map<std::string, int> materials_of;  // of each name
        for (const ObjPart& part : m_file.parts) ++materials_of[part.name];
        std::vector<Object> objects;
        for (std::size_t p = 0; p < of_part.size(); ++p) {
            if (of_part[p].empty()) continue;
            const ObjPart& part = m_file.parts[p];
            Object object;
            object.mesh_name = part.name.empty() ? stem() : part.name;
            object.name = object.mesh_name;
            if (materials_of[part.name] > 1 && !part.material.empty()) {
                object.name += "." + part.material;
            }
            object.mesh = mesh_of(of_part[p]);
            mend_normals(object.mesh);
            wear(object, part.material, warnings);
            objects.push_back(std::move(object));
        }
        tell_left_out(warnings);
        return objects;
    }

private:
    std::string stem() const { return std::filesystem::path(m_path).stem().string(); }
    const ObjCorner& corner(std::uint32_t index) const { return m_file.corners[index]; }

    void cut_faces() {
        std::vector<glm::dvec3> places;
        std::vector<glm::uvec3> cut;
        for (std::uint32_t f = 0; f < m_file.faces.size(); ++f) {
            const ObjFace& face = m_file.faces[f];
            places.clear();
            cut.clear();
            for (std::uint32_t k = 0; k < face.count; ++k) {
                places.emplace_back(m_file.positions[std::size_t(corner(face.first + k).position)]);
            }
            if (!triangulate(places, cut)) {
                if (m_degenerate++ == 0) m_degenerate_line = face.line;
                continue;
            }
            for (const glm::uvec3& t : cut) {
                m_triangles.push_back({{face.first + t.x, face.first + t.y, face.first + t.z}, f});
            }
        }
    }

    [[noreturn]] void fail_without_triangles() const {
        const std::string faces =
            m_degenerate == 0
                ? "no face"
                : fmt::format("{} with fewer than three different corners, the first in line {}",
                              m_degenerate == 1 ? "a face" : fmt::format("{} faces", m_degenerate),
                              m_degenerate_line);
        throw Error(fmt::format("{}: no triangles; it has {} vertices and {}", m_path,
                                m_file.positions.size(), faces));
    }

    /// Computed on the positions, so that a seam of the texture is none of the shading. Faces of
    /// one smoothing group share normals; without any word of smoothing all do.
    void find_normals() {
        std::map<std::pair<std::int32_t, int>, std::uint32_t> shared;  // by position and group
        std::vector<glm::vec3> P;
        std::vector<glm::uvec3> triangles;
        m_smooth_of.resize(3 * m_triangles.size());
        for (std::size_t t = 0; t < m_triangles.size(); ++t) {
            const ObjFace& face = m_file.faces[m_triangles[t].face];
            // A flat face is a group of its own.
            const int group = !m_file.has_smoothing ? 0
                              : face.smoothing > 0  ? face.smoothing
                                                    : -1 - int(m_triangles[t].face);
            glm::uvec3 corners;
            for (int k = 0; k < 3; ++k) {
                const std::int32_t at = corner(m_triangles[t].corner[std::size_t(k)]).position;
                const auto [place, is_new] =
                    shared.try_emplace({at, group}, std::uint32_t(P.size()));
                if (is_new) P.push_back(m_file.positions[std::size_t(at)]);
                corners[k] = place->second;
                m_smooth_of[3 * t + std::size_t(k)] = place->second;
            }
            triangles.push_back(corners);
        }
        m_smooth = smooth_normals(P, triangles);
    }

    /// Every different (position, normal, texture coordinate) gets a vertex of its own.
    Mesh mesh_of(const std::vector<std::uint32_t>& triangles) const {
        const auto every = [&](auto test) {
            return std::all_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
                return std::all_of(m_triangles[t].corner.begin(), m_triangles[t].corner.end(),
                                   [&](std::uint32_t c) { return test(corner(c)); });
            });
        };
        const bool has_normals = every([](const ObjCorner& c) { return c.normal >= 0; });
        const bool has_uv = !every([](const ObjCorner& c) { return c.uv < 0; });
        std::map<std::array<std::int64_t, 3>, std::uint32_t> vertices;
        Mesh mesh;
        for (const std::uint32_t t : triangles) {
            glm::uvec3 corners;
            for (int k = 0; k < 3; ++k) {
                const ObjCorner& c = corner(m_triangles[t].corner[std::size_t(k)]);
                const std::int64_t normal =
                    has_normals ? c.normal : std::int64_t(m_smooth_of[3 * t + std::size_t(k)]);
                const auto [place, is_new] = vertices.try_emplace(
                    {c.position, normal, has_uv ? c.uv : -1}, std::uint32_t(mesh.P.size()));
                corners[k] = place->second;
                if (!is_new) continue;
                mesh.P.push_back(m_file.positions[std::size_t(c.position)]);
                mesh.N.push_back(has_normals ? m_file.normals[std::size_t(normal)]
                                             : m_smooth[std::size_t(normal)]);
                if (has_uv) {
                    mesh.uv.push_back(c.uv < 0 ? glm::vec2(0.0f) : m_file.uvs[std::size_t(c.uv)]);
                }
            }
            mesh.triangles.push_back(corners);
        }
        return mesh;
    }

    void wear(Object& object, const std::string& material, std::vector<std::string>& warnings) {
        if (material.empty()) return;
        const auto color = m_colors.find(material);
        if (color != m_colors.end()) object.base_color = color->second;
        object.choice.where =
            fmt::format("{}: material \"{}\"", m_path, one_line(material, longest_name));
        object.choice.name = shader_named(material);
        const std::string meant = object.wears_shader() ? "" : shader_almost_named(material);
        if (meant.empty() || !m_told.insert(material).second) return;
        warnings.push_back(almost_named(object.choice.where, meant));
    }

    /// Of material files the diffuse colours.
    void read_material_files(std::vector<std::string>& warnings) {
        const std::filesystem::path folder = std::filesystem::path(m_path).parent_path();
        for (const std::string& name : m_file.material_files) {
            const std::filesystem::path file(name);
            const bool outside = file.is_absolute() || name.find("..") != std::string::npos;
            std::error_code code;
            if (outside || !std::filesystem::is_regular_file(folder / file, code)) {
                warnings.push_back(
                    fmt::format("{}: material file {}: {}; its colours are not used", m_path,
                                one_line(name, longest_name),
                                outside ? "outside the scene's folder" : "not found"));
                continue;
            }
            take_colors(read_file((folder / file).string()));
        }
    }

    void take_colors(const std::string& text) {
        std::istringstream lines(text);
        std::string material;
        for (std::string line; std::getline(lines, line);) {
            std::istringstream words(line);
            std::string key;
            words >> key;
            if (key == "newmtl") {
                std::getline(words >> std::ws, material);
                while (!material.empty() && (material.back() == '\r' || material.back() == ' ')) {
                    material.pop_back();
                }
            }
            glm::vec3 color;
            if (key != "Kd" || !(words >> color.r >> color.g >> color.b)) continue;
            m_colors[material] = glm::clamp(color, glm::vec3(0.0f), glm::vec3(1.0f));
        }
    }

    void tell_left_out(std::vector<std::string>& warnings) const {
        const auto tell = [&](int count, const std::string& what) {
            if (count == 0) return;
            warnings.push_back(fmt::format("{}: not shown: {} {}", m_path, count, what));
        };
        tell(m_degenerate, fmt::format("faces with fewer than three different corners, the first "
                                       "in line {}",
                                       m_degenerate_line));
        tell(m_file.lines_and_points, "lines and points");
        tell(m_file.curves, "curves and curved surfaces");
        tell(m_file.colours, "vertex colours");
    }

    std::string m_path;
    ObjFile m_file;
    std::vector<Triangle> m_triangles;
    int m_degenerate = 0;
    std::int64_t m_degenerate_line = 0;
    std::vector<glm::vec3> m_smooth;
    std::vector<std::uint32_t> m_smooth_of;     ///< by triangle and corner: index into m_smooth
    std::map<std::string, glm::vec3> m_colors;  ///< by material
    std::set<std::string> m_told;
};

}  // namespace

std::vector<Object> read_obj(const std::string& path, std::vector<std::string>& warnings) {
    return ObjReader(path).objects(warnings);
}

}  // namespace estara
