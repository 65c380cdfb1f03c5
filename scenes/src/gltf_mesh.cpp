// Triangles of a glTF primitive.
#include <fmt/format.h>

#include <numeric>

#include "gltf.h"

namespace estara {
namespace {

/// Values of an attribute, or none if the primitive has no such.
std::vector<float> attribute(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                             const char* name, int components, const std::string& where) {
    const auto found = primitive.attributes.find(name);
    if (found == primitive.attributes.end()) return {};
    return read_floats(model, found->second, components, fmt::format("{}: {}", where, name));
}

void check_count(const std::vector<float>& values, std::size_t components, std::size_t vertices,
                 const char* name, const std::string& where) {
    if (values.empty() || values.size() == components * vertices) return;
    throw Error(fmt::format("{}: {} {} for {} vertices", where, values.size() / components, name,
                            vertices));
}

/// The order of the corners: glTF 2.0, 3.7.2.1.
std::vector<glm::uvec3> triangles_of(const std::vector<std::uint32_t>& v, int mode) {
    std::vector<glm::uvec3> triangles;
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        for (std::size_t i = 0; i + 2 < v.size(); i += 3) {
            triangles.emplace_back(v[i], v[i + 1], v[i + 2]);
        }
        return triangles;
    }
    for (std::size_t i = 0; i + 2 < v.size(); ++i) {
        const glm::uvec3 t = mode == TINYGLTF_MODE_TRIANGLE_STRIP
                                 ? glm::uvec3(v[i], v[i + 1 + i % 2], v[i + 2 - i % 2])
                                 : glm::uvec3(v[i + 1], v[i + 2], v[0]);
        // Repeated vertices only lead a strip elsewhere.
        if (t.x != t.y && t.y != t.z && t.z != t.x) triangles.push_back(t);
    }
    return triangles;
}

/// Of an array with `each` values a vertex, those of vertices that have a place.
template <class T>
void keep_used(std::vector<T>& values, const std::vector<std::uint32_t>& place, int each = 1) {
    if (values.empty()) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < place.size(); ++i) {
        if (place[i] == ~0u) continue;
        for (int k = 0; k < each; ++k)
            values[kept++] = values[i * std::size_t(each) + std::size_t(k)];
    }
    values.resize(kept);
}

/// Drops the vertices that no triangle uses: primitives often share one large list.
void drop_unused_vertices(Object& object) {
    Mesh& mesh = object.mesh;
    std::vector<std::uint32_t> place(mesh.P.size(), ~0u);
    for (const glm::uvec3& t : mesh.triangles) {
        for (int k = 0; k < 3; ++k) place[t[k]] = 0;
    }
    std::uint32_t used = 0;
    for (std::uint32_t& p : place) {
        if (p != ~0u) p = used++;
    }
    if (used == place.size()) return;
    keep_used(mesh.P, place);
    keep_used(mesh.N, place);
    keep_used(mesh.uv, place);
    for (MorphTarget& target : object.bends.targets) {
        keep_used(target.P, place);
        keep_used(target.N, place);
    }
    Influences& influences = object.bends.influences;
    keep_used(influences.joint, place, influences.count);
    keep_used(influences.weight, place, influences.count);
    for (glm::uvec3& t : mesh.triangles) t = {place[t.x], place[t.y], place[t.z]};
}

}  // namespace

bool has_triangles(const tinygltf::Primitive& primitive) {
    return primitive.mode == TINYGLTF_MODE_TRIANGLES ||
           primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
           primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

void read_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                    const std::string& where, Object& object) {
    const std::vector<float> P = attribute(model, primitive, "POSITION", 3, where);
    const std::vector<float> N = attribute(model, primitive, "NORMAL", 3, where);
    const std::vector<float> uv = attribute(model, primitive, "TEXCOORD_0", 2, where);
    const std::size_t vertices = P.size() / 3;
    check_count(N, 3, vertices, "normals", where);
    check_count(uv, 2, vertices, "texture coordinates", where);

    Mesh& mesh = object.mesh;
    for (std::size_t i = 0; i < vertices; ++i) {
        mesh.P.emplace_back(P[3 * i], P[3 * i + 1], P[3 * i + 2]);
        if (!N.empty()) mesh.N.emplace_back(N[3 * i], N[3 * i + 1], N[3 * i + 2]);
        if (!uv.empty()) mesh.uv.emplace_back(uv[2 * i], uv[2 * i + 1]);
    }
    std::vector<std::uint32_t> order(vertices);
    std::iota(order.begin(), order.end(), 0u);
    if (primitive.indices != -1) order = read_indices(model, primitive.indices, where);
    for (const std::uint32_t index : order) {
        if (index < vertices) continue;
        throw Error(fmt::format("{}: there is no vertex {}; it has {}, counted from 0", where,
                                index, vertices));
    }
    mesh.triangles = triangles_of(order, primitive.mode);
    if (mesh.triangles.empty()) throw Error(fmt::format("{}: no triangles", where));
    object.bends = read_deformation(model, primitive, vertices, where);
    drop_unused_vertices(object);
    mend_normals(mesh);
}

}  // namespace estara
