// Meshes that the tests of bake/ are made with.
#pragma once

#include <cmath>
#include <numbers>

#include "estara/scenes/mesh.h"

namespace estara::test {

/// A sphere of 2 n^2 quads with poles at +-y, wound outwards; uv runs once around.
inline Mesh sphere(int n, float radius, const glm::vec3& center = glm::vec3(0.0f)) {
    Mesh mesh;
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= 2 * n; ++j) {
            const float theta = std::numbers::pi_v<float> * float(i) / float(n);
            // The last column repeats the first exactly, so that the seam is closed.
            const float phi = std::numbers::pi_v<float> * float(j % (2 * n)) / float(n);
            const float ring = i == 0 || i == n ? 0.0f : std::sin(theta);
            mesh.P.push_back(center + radius * glm::vec3(ring * std::cos(phi), std::cos(theta),
                                                         ring * std::sin(phi)));
            mesh.uv.emplace_back(float(j) / float(2 * n), float(i) / float(n));
        }
    }
    const auto row = unsigned(2 * n + 1);
    for (unsigned i = 0; i < unsigned(n); ++i) {
        for (unsigned j = 0; j < unsigned(2 * n); ++j) {
            const unsigned a = i * row + j;
            mesh.triangles.emplace_back(a, a + 1, a + row);
            mesh.triangles.emplace_back(a + 1, a + row + 1, a + row);
        }
    }
    return mesh;
}

/// A square [0, side]^2 in the plane z = height, facing +z.
inline Mesh square(float side, float height = 0.0f) {
    Mesh mesh;
    mesh.P = {{0, 0, height}, {side, 0, height}, {side, side, height}, {0, side, height}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

inline Mesh joined(const Mesh& a, const Mesh& b) {
    Mesh mesh = a;
    mesh.uv.clear();
    mesh.P.insert(mesh.P.end(), b.P.begin(), b.P.end());
    for (const glm::uvec3& t : b.triangles) mesh.triangles.push_back(t + unsigned(a.P.size()));
    return mesh;
}

}  // namespace estara::test
