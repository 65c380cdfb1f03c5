// A triangle prepared for many tests against equal boxes.
#pragma once

#include <algorithm>
#include <array>
#include <glm/glm.hpp>

namespace estara {

/// Schwarz & Seidel 2010, section 3.1: a box [p, p + size]^3 meets a triangle if their bounds meet,
/// the triangle's plane meets the box, and their projections on the three coordinate planes meet.
/// What does not depend on p is computed once. Touching counts. A degenerate triangle is tested as
/// the segment or point it is: its edges run both ways, so the half planes still bound it.
class TriangleBox {
public:
    /// @param v     corners, index space
    /// @param size  edge of the boxes, > 0
    TriangleBox(const std::array<glm::dvec3, 3>& v, double size) : m_size(size) {
        m_min = glm::min(v[0], glm::min(v[1], v[2]));
        m_max = glm::max(v[0], glm::max(v[1], v[2]));
        m_n = glm::cross(v[1] - v[0], v[2] - v[0]);
        const glm::dvec3 far(m_n.x > 0 ? size : 0.0, m_n.y > 0 ? size : 0.0,
                             m_n.z > 0 ? size : 0.0);
        m_d_far = glm::dot(m_n, far - v[0]);
        m_d_near = glm::dot(m_n, glm::dvec3(size) - far - v[0]);
        for (int plane = 0; plane < 3; ++plane) {
            const int a = plane, b = (plane + 1) % 3, c = (plane + 2) % 3;  // projected along c
            const double side = m_n[c] < 0.0 ? -1.0 : 1.0;
            for (int e = 0; e < 3; ++e) {
                const glm::dvec3 edge = v[(e + 1) % 3] - v[e];
                Edge& out = m_edges[plane][e];
                out.a = -edge[b] * side;
                out.b = edge[a] * side;
                out.d = -(out.a * v[e][a] + out.b * v[e][b]) + std::max(0.0, size * out.a) +
                        std::max(0.0, size * out.b);
            }
        }
    }

    const glm::dvec3& min() const noexcept { return m_min; }
    const glm::dvec3& max() const noexcept { return m_max; }

    /// Whether [p, p + size]^3 meets the triangle.
    bool meets(const glm::dvec3& p) const noexcept {
        for (int c = 0; c < 3; ++c) {
            if (p[c] > m_max[c] || p[c] + m_size < m_min[c]) return false;
        }
        const double s = glm::dot(m_n, p);
        if ((s + m_d_far) * (s + m_d_near) > 0.0) return false;
        for (int plane = 0; plane < 3; ++plane) {
            for (const Edge& e : m_edges[plane]) {
                if (e.a * p[plane] + e.b * p[(plane + 1) % 3] + e.d < 0.0) return false;
            }
        }
        return true;
    }

private:
    struct Edge {
        double a, b, d;
    };
    double m_size;
    glm::dvec3 m_min, m_max, m_n;
    double m_d_far, m_d_near;
    std::array<std::array<Edge, 3>, 3> m_edges;
};

}  // namespace estara
