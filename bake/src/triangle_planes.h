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
/// plane and, for each edge, how far beside it and how far along it is in the plane. A point
/// outside the triangle's prism is nearest to an edge. Without division or case, so that a loop
/// over points becomes wide.
///
/// Computed in double and kept as float, so points and triangle are to be given from a place
/// nearby: numbers that are small in the end are sums of terms as large as the point's coordinates,
/// however large the triangle is.
///
/// A degenerate triangle, thinner than 1e-12 of its length, has no normal: it lies in any plane
/// through its longest edge, has no inside and no side, and all its edges run along that one.
struct alignas(32) TrianglePlanes {
    static constexpr int height = 0, beside = 1, along = 4;

    /// Number k at p is x[k] p.x + y[k] p.y + z[k] p.z + w[k].
    std::array<float, 8> x{}, y{}, z{}, w{};
    std::array<float, 3> start, end;  ///< the numbers `along` of an edge's ends
    float inside;                     ///< all `beside` are at most that above the inside
    float faces;                      ///< 1; 0 for a degenerate triangle

    ESTARA_KERNEL explicit TrianglePlanes(const std::array<glm::dvec3, 3>& v) noexcept {
        const std::array<glm::dvec3, 3> edge{v[1] - v[0], v[2] - v[1], v[0] - v[2]};
        std::array<double, 3> length, inverse;
        glm::dvec3 longest(1.0, 0.0, 0.0);
        double most = 0.0;
        for (std::size_t e = 0; e < 3; ++e) {
            length[e] = std::sqrt(glm::dot(edge[e], edge[e]));
            inverse[e] = 1.0 / length[e];
            longest = length[e] > most ? edge[e] * inverse[e] : longest;
            most = std::max(most, length[e]);
        }
        glm::dvec3 normal = glm::cross(edge[0], edge[1]);
        const double area2 = std::sqrt(glm::dot(normal, normal));
        const bool degenerate = !(area2 > 1e-12 * most * most);
        if (!degenerate) {
            normal *= 1.0 / area2;
            inside = 0.0f;
            faces = 1.0f;
        } else {
            const glm::dvec3 other =
                std::abs(longest.x) < 0.5 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
            normal = glm::cross(longest, other);
            normal *= 1.0 / std::sqrt(glm::dot(normal, normal));
            inside = -std::numeric_limits<float>::infinity();
            faces = 0.0f;
        }
        set(height, normal, v[0]);
        for (std::size_t e = 0; e < 3; ++e) {
            const glm::dvec3 way = degenerate ? longest : edge[e] * inverse[e];
            set(beside + int(e), glm::cross(way, normal), v[e]);
            set(along + int(e), way, glm::dvec3(0.0));
            const double from = glm::dot(way, v[e]), to = glm::dot(way, v[(e + 1) % 3]);
            start[e] = float(std::min(from, to));
            end[e] = float(std::max(from, to));
        }
    }

private:
    /// Number k becomes the coordinate along a unit vector, from a point on.
    ESTARA_KERNEL void set(int k, const glm::dvec3& unit, const glm::dvec3& from) noexcept {
        const auto i = std::size_t(k);
        x[i] = float(unit.x);
        y[i] = float(unit.y);
        z[i] = float(unit.z);
        w[i] = float(-glm::dot(unit, from));
    }
};

}  // namespace estara
