// Where a mesh lies among its voxels.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "estara/scenes/mesh.h"

namespace estara {

/// A triangle's corners, index space.
inline std::array<glm::dvec3, 3> triangle_corners(const Mesh& mesh, std::size_t triangle,
                                                  const glm::dvec3& origin,
                                                  double voxel_size) noexcept {
    const glm::uvec3& t = mesh.triangles[triangle];
    std::array<glm::dvec3, 3> v;
    for (int i = 0; i < 3; ++i) {
        v[std::size_t(i)] = (glm::dvec3(mesh.P[t[i]]) - origin) / voxel_size;
    }
    return v;
}

struct Lattice {
    double voxel_size;
    glm::dvec3 origin;  ///< object position of voxel (0, 0, 0)
    double slack;       ///< how much larger than one voxel a cell is taken, on each side, in voxels

    std::array<glm::dvec3, 3> corners(const Mesh& mesh, std::size_t triangle) const noexcept {
        return triangle_corners(mesh, triangle, origin, voxel_size);
    }
};

}  // namespace estara
