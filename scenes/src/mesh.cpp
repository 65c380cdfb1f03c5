// Points, bounds and fingerprint of a triangle mesh.
#include "estara/scenes/mesh.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>

namespace estara {
namespace {

/// Unit vector along v, or `otherwise` if v has no direction.
glm::vec3 unit_or(const glm::dvec3& v, const glm::vec3& otherwise) noexcept {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? glm::vec3(v / length) : otherwise;
}

/// From a triangle's first corner to the others, in double: their differences and products are then
/// exact enough for slivers and far from the origin.
struct Edges {
    glm::dvec3 to_1, to_2;
};

Edges edges_of(const Mesh& mesh, const glm::uvec3& t) noexcept {
    const glm::dvec3 p0(mesh.P[t.x]);
    return {glm::dvec3(mesh.P[t.y]) - p0, glm::dvec3(mesh.P[t.z]) - p0};
}

/// Change of P with u over a triangle, or a zero vector if uv does not say.
glm::vec3 tangent_along_u(const Edges& edges, const glm::dvec2& uv1,
                          const glm::dvec2& uv2) noexcept {
    const double det = uv1.x * uv2.y - uv2.x * uv1.y;
    if (det == 0.0) return glm::vec3(0.0f);
    const glm::dvec3 t = (uv2.y * edges.to_1 - uv1.y * edges.to_2) / det;
    const double length = glm::length(t);
    // Outside of this a shader that squares the length in float would get 0 or infinity.
    if (!(length > 1e-15 && length < 1e15)) return glm::vec3(0.0f);
    return glm::vec3(t);
}

glm::vec3 face_normal(const Edges& edges) noexcept {
    return unit_or(glm::cross(edges.to_1, edges.to_2), glm::vec3(0.0f, 0.0f, 1.0f));
}

template <class T>
void feed(XXH3_state_t* state, const std::vector<T>& values) {
    const std::uint64_t count = values.size();
    XXH3_64bits_update(state, &count, sizeof count);
    XXH3_64bits_update(state, values.data(), values.size() * sizeof(T));
}

}  // namespace

Box bounds(const Mesh& mesh) {
    if (mesh.triangles.empty()) return {};
    const glm::vec3 first = mesh.P[mesh.triangles.front().x];
    Box box{first, first};
    for (const glm::uvec3& t : mesh.triangles) {
        for (int k = 0; k < 3; ++k) {
            box.min = glm::min(box.min, mesh.P[t[k]]);
            box.max = glm::max(box.max, mesh.P[t[k]]);
        }
    }
    return box;
}

double finest_voxel_size(const Mesh& mesh) {
    const Box box = bounds(mesh);
    const glm::dvec3 extent = glm::dvec3(box.max) - glm::dvec3(box.min);
    const glm::vec3 largest = glm::max(glm::abs(box.min), glm::abs(box.max));
    const double ulp = double(std::max({largest.x, largest.y, largest.z})) * 0x1p-23;
    return std::max(16.1 * ulp, std::max({extent.x, extent.y, extent.z}) / 131000.0);
}

double area(const Mesh& mesh) {
    double sum = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 p0(mesh.P[t.x]);
        sum += 0.5 *
               glm::length(glm::cross(glm::dvec3(mesh.P[t.y]) - p0, glm::dvec3(mesh.P[t.z]) - p0));
    }
    return sum;
}

std::vector<glm::vec3> face_normals(const Mesh& mesh) {
    std::vector<glm::vec3> normals(mesh.triangles.size());
    for (std::size_t t = 0; t < normals.size(); ++t) {
        normals[t] = face_normal(edges_of(mesh, mesh.triangles[t]));
    }
    return normals;
}

MeshPoint mesh_point(const Mesh& mesh, std::uint32_t triangle, float b1, float b2) noexcept {
    const glm::uvec3 t = mesh.triangles[triangle];
    const float b0 = 1.0f - b1 - b2;
    const Edges edges = edges_of(mesh, t);

    MeshPoint point{};
    point.triangle = triangle;
    point.P = b0 * mesh.P[t.x] + b1 * mesh.P[t.y] + b2 * mesh.P[t.z];
    point.Ng = face_normal(edges);
    point.N = point.Ng;
    if (!mesh.N.empty()) {
        const glm::vec3 n = b0 * mesh.N[t.x] + b1 * mesh.N[t.y] + b2 * mesh.N[t.z];
        // Opposite normals cancel; what is left of them then is rounding error.
        if (glm::dot(n, n) > 1e-8f) point.N = glm::normalize(n);
    }
    if (mesh.has_uv()) point.uv = b0 * mesh.uv[t.x] + b1 * mesh.uv[t.y] + b2 * mesh.uv[t.z];
    return point;
}

glm::vec3 tangent_without_uv(const glm::vec3& N) noexcept {
    const glm::dvec3 n(N);
    const glm::dvec3 east = glm::cross(glm::dvec3(0.0, 1.0, 0.0), n);
    // Below this sine the direction is rounding error.
    if (glm::length(east) > 1e-4) return unit_or(east, glm::vec3(1.0f, 0.0f, 0.0f));
    return unit_or(glm::cross(n, glm::dvec3(0.0, 0.0, 1.0)), glm::vec3(1.0f, 0.0f, 0.0f));
}

glm::vec3 face_tangent(const Mesh& mesh, std::uint32_t triangle) noexcept {
    if (!mesh.has_uv()) return glm::vec3(0.0f);
    const glm::uvec3 t = mesh.triangles[triangle];
    const glm::dvec2 uv0(mesh.uv[t.x]);
    return tangent_along_u(edges_of(mesh, t), glm::dvec2(mesh.uv[t.y]) - uv0,
                           glm::dvec2(mesh.uv[t.z]) - uv0);
}

glm::vec3 tangent(const Mesh& mesh, const MeshPoint& point) noexcept {
    const glm::vec3 dPdu = face_tangent(mesh, point.triangle);
    return dPdu == glm::vec3(0.0f) ? tangent_without_uv(point.N) : dPdu;
}

std::string mesh_digest(const Mesh& mesh) {
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(),
                                                                         &XXH3_freeState);
    if (!state) throw std::bad_alloc();
    XXH3_64bits_reset(state.get());
    feed(state.get(), mesh.P);
    feed(state.get(), mesh.N);
    feed(state.get(), mesh.uv);
    feed(state.get(), mesh.triangles);
    return fmt::format("{:016x}", XXH3_64bits_digest(state.get()));
}

}  // namespace estara
