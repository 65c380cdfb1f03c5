// What tests ask of meshes that are read from files.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "estara/scenes/load.h"

namespace estara::test {

/// Positive if the triangles' normals point outwards.
inline double signed_volume(const Mesh& mesh) {
    double six_volumes = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
        six_volumes += glm::dot(glm::dvec3(mesh.P[t.x]),
                                glm::cross(glm::dvec3(mesh.P[t.y]), glm::dvec3(mesh.P[t.z])));
    }
    return six_volumes / 6.0;
}

/// Share of the triangles whose vertex normals all lie on the side of the geometric one.
inline double smooth_share(const Mesh& mesh) {
    std::size_t agree = 0;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const MeshPoint point = mesh_point(mesh, t, 1.0f / 3, 1.0f / 3);
        bool all = true;
        for (int k = 0; k < 3; ++k) {
            all = all && glm::dot(mesh.N[mesh.triangles[t][k]], point.Ng) > 0.0f;
        }
        agree += all ? 1 : 0;
    }
    return double(agree) / double(mesh.triangles.size());
}

inline void expect_unit(const std::vector<glm::vec3>& normals) {
    for (const glm::vec3& n : normals) ASSERT_NEAR(glm::length(n), 1.0f, 1e-5f);
}

}  // namespace estara::test
