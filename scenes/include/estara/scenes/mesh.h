// Triangle meshes and points on them.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace estara {

/// A triangle mesh in its object's own space. Every index is in range and every coordinate finite
/// (the loader sees to it); degenerate triangles may occur.
struct Mesh {
    std::vector<glm::vec3> P;           ///< vertex positions, object space
    std::vector<glm::vec3> N;           ///< vertex normals, unit; empty: triangles are flat
    std::vector<glm::vec2> uv;          ///< texture coordinates per vertex; empty: none
    std::vector<glm::uvec3> triangles;  ///< indices into P, counter-clockwise seen from outside

    bool has_uv() const noexcept { return !uv.empty(); }
};

struct Box {
    glm::vec3 min{0.0f}, max{0.0f};
    float diagonal() const noexcept { return glm::length(max - min); }
};

/// Bounds of the vertices that triangles use; an empty mesh has the empty box at 0.
Box bounds(const Mesh& mesh);

/// Surface area, object space units squared.
double area(const Mesh& mesh);

/// The smallest voxel that the mesh can be divided into, object space: floats tell sixteenths of it
/// apart at the mesh's coordinates, and it goes 131072 times into the longest side. 0 for a mesh
/// that is one point at the origin.
double finest_voxel_size(const Mesh& mesh);

/// A point on a triangle.
struct MeshPoint {
    glm::vec3 P;             ///< interpolated from the vertices, object space
    glm::vec3 N;             ///< shading normal, unit: interpolated; Ng without, or if they cancel
    glm::vec3 Ng;            ///< geometric normal, unit; (0, 0, 1) on a degenerate triangle
    glm::vec2 uv;            ///< (0, 0) without texture coordinates
    std::uint32_t triangle;  ///< that it lies on
};

/// MeshPoint::Ng of every triangle, for those who ask for many points.
std::vector<glm::vec3> face_normals(const Mesh& mesh);

/// The point (1 - b1 - b2) P0 + b1 P1 + b2 P2 of a triangle.
/// @param b1, b2  barycentric coordinates as Embree's u and v: >= 0, b1 + b2 <= 1
MeshPoint mesh_point(const Mesh& mesh, std::uint32_t triangle, float b1, float b2) noexcept;

/// Change of P with u over a triangle, object space; zero where uv does not say.
glm::vec3 face_tangent(const Mesh& mesh, std::uint32_t triangle) noexcept;

/// A tangent that goes round the y axis, eastwards: it varies smoothly everywhere but at the poles.
/// Unit.
glm::vec3 tangent_without_uv(const glm::vec3& N) noexcept;

/// face_tangent() or, where it is zero, tangent_without_uv(): change of P with u at a point of the
/// mesh, object space. Never zero: some tangent where uv does not give one. Not a part of MeshPoint
/// because few need it and it costs as much as the rest.
glm::vec3 tangent(const Mesh& mesh, const MeshPoint& point) noexcept;

/// 16 hex digits that change whenever a position, texture coordinate, normal or triangle does.
std::string mesh_digest(const Mesh& mesh);

}  // namespace estara
