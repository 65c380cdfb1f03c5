// Vertex normals for meshes that come without good ones.
#include <cmath>

#include "loaders.h"

namespace estara {
namespace {

/// Angle between two vectors, radians; 0 if either has no length.
double angle(const glm::dvec3& a, const glm::dvec3& b) {
    // atan2 keeps its digits near 0 and pi, where acos of a cosine loses them.
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

void add_triangle(const std::vector<glm::vec3>& P, const glm::uvec3& t,
                  std::vector<glm::dvec3>& sums) {
    const glm::dvec3 p[3] = {P[t.x], P[t.y], P[t.z]};
    const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double length = glm::length(n);
    if (!(length > 0.0)) return;
    for (int k = 0; k < 3; ++k) {
        sums[t[k]] += n * (angle(p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]) / length);
    }
}

}  // namespace

std::vector<glm::vec3> smooth_normals(const std::vector<glm::vec3>& P,
                                      const std::vector<glm::uvec3>& triangles) {
    std::vector<glm::dvec3> sums(P.size(), glm::dvec3(0.0));
    for (const glm::uvec3& t : triangles) add_triangle(P, t, sums);
    std::vector<glm::vec3> normals(P.size(), glm::vec3(0.0f, 0.0f, 1.0f));
    for (std::size_t i = 0; i < P.size(); ++i) {
        const double length = glm::length(sums[i]);
        // What opposite triangles leave of each other is rounding error.
        if (length > 1e-9) normals[i] = glm::vec3(sums[i] / length);
    }
    return normals;
}

void mend_normals(Mesh& mesh) {
    std::vector<glm::vec3> smooth;
    for (std::size_t i = 0; i < mesh.N.size(); ++i) {
        const glm::dvec3 n(mesh.N[i]);
        const double length = glm::length(n);
        if (length > 0.0) {
            mesh.N[i] = glm::vec3(n / length);
            continue;
        }
        if (smooth.empty()) smooth = smooth_normals(mesh.P, mesh.triangles);
        mesh.N[i] = smooth[i];
    }
}

}  // namespace estara
