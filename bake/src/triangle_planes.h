// A triangle prepared for the distances of many points.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

#include "estara/shaders/kernel.h"

namespace estara {

/// The distance from a triangle, by numbers that are linear in the point: its height above the
/// plane and, for each edge, how far beside it and how far from its middle it is in the plane. A
/// point outside the triangle's prism is nearest to an edge. Without division or case, so that a
/// loop over points becomes wide.
///
/// A degenerate triangle has no normal: it lies in any plane through its longest edge, has no
/// inside and no side.
struct alignas(64) TrianglePlanes {
    static constexpr int height = 0, beside = 1, along = 4, count = 7;

    /// Number k at p is x[k] p.x + y[k] p.y + z[k] p.z + w[k].
    std::array<double, 8> x{}, y{}, z{}, w{};
    std::array<double, 3> half;  ///< an edge's length
    double inside;               ///< all `beside` are at most that if the point is above the inside
    double faces;                ///< 1; 0 for a degenerate triangle

    TrianglePlanes() = default;
    ESTARA_KERNEL explicit TrianglePlanes(const std::array<glm::dvec3, 3>& v) noexcept {
        const std::array<glm::dvec3, 3> edge{v[1] - v[0], v[2] - v[1], v[0] - v[2]};
        std::array<double, 3> length, inverse;
        glm::dvec3 longest(1.0, 0.0, 0.0);
        double most = 0.0;
        for (std::size_t e = 0; e < 3; ++e) {
            length[e] = std::sqrt(glm::dot(edge[e], edge[e]));
            inverse[e] = 1.0 / length[e];
            half[e] = 0.5 * length[e];
            longest = length[e] > most ? edge[e] * inverse[e] : longest;
            most = std::max(most, length[e]);
        }
        glm::dvec3 normal = glm::cross(edge[0], edge[1]);
        const double area2 = std::sqrt(glm::dot(normal, normal));
        if (area2 > 1e-12 * most * most) {
            normal *= 1.0 / area2;
            inside = 0.0;
            faces = 1.0;
        } else {
            const glm::dvec3 other =
                std::abs(longest.x) < 0.5 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
            normal = glm::cross(longest, other);
            normal *= 1.0 / std::sqrt(glm::dot(normal, normal));
            inside = -std::numeric_limits<double>::infinity();
            faces = 0.0;
        }
        set(height, normal, v[0]);
        for (std::size_t e = 0; e < 3; ++e) {
            const glm::dvec3 way = length[e] > 0.0 ? edge[e] * inverse[e] : longest;
            set(beside + int(e), glm::cross(way, normal), v[e]);
            set(along + int(e), way, v[e] + 0.5 * edge[e]);
        }
    }

private:
    /// Number k becomes the coordinate along a unit vector, from a point on.
    ESTARA_KERNEL void set(int k, const glm::dvec3& unit, const glm::dvec3& from) noexcept {
        const auto i = std::size_t(k);
        x[i] = unit.x;
        y[i] = unit.y;
        z[i] = unit.z;
        w[i] = -(unit.x * from.x + unit.y * from.y + unit.z * from.z);
    }
};

}  // namespace estara
