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

/// Drops the vertices that no triangle uses: primitives often share one large list.
void drop_unused_vertices(Mesh& mesh) {
    constexpr std::uint32_t unused = ~0u;
    std::vector<std::uint32_t> place(mesh.P.size(), unused);
    for (const glm::uvec3& t : mesh.triangles) {
        for (int k = 0; k < 3; ++k) place[t[k]] = 0;
    }
    std::uint32_t used = 0;
    for (std::size_t i = 0; i < place.size(); ++i) {
        if (place[i] == unused) continue;
        place[i] = used;
        mesh.P[used] = mesh.P[i];
        if (!mesh.N.empty()) mesh.N[used] = mesh.N[i];
        if (mesh.has_uv()) mesh.uv[used] = mesh.uv[i];
        ++used;
    }
    mesh.P.resize(used);
    if (!mesh.N.empty()) mesh.N.resize(used);
    if (mesh.has_uv()) mesh.uv.resize(used);
    for (glm::uvec3& t : mesh.triangles) t = {place[t.x], place[t.y], place[t.z]};
}

}  // namespace

bool has_triangles(const tinygltf::Primitive& primitive) {
    return primitive.mode == TINYGLTF_MODE_TRIANGLES ||
           primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
           primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

Mesh read_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                    const std::string& where) {
    const std::vector<float> P = attribute(model, primitive, "POSITION", 3, where);
    const std::vector<float> N = attribute(model, primitive, "NORMAL", 3, where);
    const std::vector<float> uv = attribute(model, primitive, "TEXCOORD_0", 2, where);
    const std::size_t vertices = P.size() / 3;
    check_count(N, 3, vertices, "normals", where);
    check_count(uv, 2, vertices, "texture coordinates", where);

    Mesh mesh;
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
    drop_unused_vertices(mesh);
    mend_normals(mesh);
    return mesh;
}

}  // namespace estara
