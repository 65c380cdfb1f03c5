// Which boxes of a regular lattice a triangle meets, solved row by row.
#pragma once

#include <algorithm>
#include <array>
#include <glm/glm.hpp>
#include <limits>

#include "estara/shaders/kernel.h"

namespace estara {

/// Largest whole number that is not above x; |x| < 2^31. (std::floor is a call before SSE4.1.)
ESTARA_KERNEL int floor_to_int(double x) noexcept {
    const int whole = int(x);
    return whole - int(x < double(whole));
}
ESTARA_KERNEL int ceil_to_int(double x) noexcept { return -floor_to_int(-x); }

/// Eight rows side by side. 0 to 7 as numbers: converting whole ones would halve the loops' width,
/// because 16 of those fill the vector that holds 8 doubles.
inline constexpr std::array<double, 8> lanes{0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};

/// The numbers from lo to hi; none if lo > hi.
struct Range {
    double lo = -std::numeric_limits<double>::infinity();
    double hi = std::numeric_limits<double>::infinity();
};

/// A range for each of eight rows.
struct Ranges {
    std::array<double, 8> lo, hi;
};

/// Makes a range smaller; a bound that is not a number does nothing.
ESTARA_KERNEL void clip(Range& range, const Range& by) noexcept {
    range.lo = by.lo > range.lo ? by.lo : range.lo;
    range.hi = by.hi < range.hi ? by.hi : range.hi;
}

/// Box i (three whole numbers) spans start + i to start + i + size in each axis: boxes of size 1
/// share faces, larger ones overlap.
///
/// Schwarz & Seidel 2010, section 3.1: a box meets a triangle if their bounds meet, the triangle's
/// plane meets the box, and their projections on the three coordinate planes meet. All of these
/// are linear in i. Differs: each inequality is solved for z (those in the xy plane for y) instead
/// of being tested for every box, so a row of boxes costs no more than one. Touching counts.
/// Rounding moves a bound by some 1e-10 boxes where coordinates are below 2^18: start and size must
/// have that much to spare.
///
/// A degenerate triangle is tested as the segment or point it is: its edges run both ways, so the
/// half planes still bound it.
class TriangleBoxes {
public:
    ESTARA_KERNEL TriangleBoxes(const std::array<glm::dvec3, 3>& v, double start,
                                double size) noexcept {
        const glm::dvec3 low = glm::min(v[0], glm::min(v[1], v[2])) - (start + size);
        const glm::dvec3 high = glm::max(v[0], glm::max(v[1], v[2])) - start;
        for (int c = 0; c < 3; ++c) bounds[std::size_t(c)] = {low[c], high[c]};

        const std::array<glm::dvec3, 3> edge{v[1] - v[0], v[2] - v[1], v[0] - v[2]};
        m_n = glm::cross(edge[0], edge[1]);
        // What is left of the normal of a segment is rounding, and its plane anywhere.
        const double scale = glm::dot(edge[0], edge[0]) + glm::dot(edge[1], edge[1]);
        if (glm::dot(m_n, m_n) <= 1e-24 * scale * scale) m_n = glm::dvec3(0.0);
        if (m_n.z < 0.0) m_n = -m_n;
        double far = 0.0, near = 0.0;  // of the box's corners along the normal
        for (int c = 0; c < 3; ++c) {
            far += std::max(0.0, size * m_n[c]);
            near += std::min(0.0, size * m_n[c]);
        }
        const double offset =
            m_n.x * (start - v[0].x) + m_n.y * (start - v[0].y) + m_n.z * (start - v[0].z);
        m_far = offset + far;
        m_near = offset + near;
        m_inverse = 1.0 / (m_n.z + 0.0);  // -0.0 becomes 0.0, as in Edge

        const glm::dvec3 winding = glm::cross(edge[0], edge[1]);
        for (int e = 0; e < 3; ++e) {
            const auto i = std::size_t(e);
            m_y_of_x[i] = Edge(edge[i].x, edge[i].y, v[i].x, v[i].y, winding.z, start, size);
            m_z_of_x[i] = Edge(edge[i].x, edge[i].z, v[i].x, v[i].z, -winding.y, start, size);
            m_z_of_y[i] = Edge(edge[i].y, edge[i].z, v[i].y, v[i].z, winding.x, start, size);
        }
    }

    /// By axis: no box outside is met.
    std::array<Range, 3> bounds;

    /// A box (x, y, z) meets the triangle if x, y and z are within bounds, y in y_of_x(x) and z in
    /// z_of_x(x), z_of_y(y) and z_of_plane(x, y).
    ESTARA_KERNEL Range y_of_x(double x) const noexcept { return solve(m_y_of_x, x); }
    ESTARA_KERNEL Range z_of_x(double x) const noexcept { return solve(m_z_of_x, x); }
    ESTARA_KERNEL Range z_of_y(double y) const noexcept { return solve(m_z_of_y, y); }
    ESTARA_KERNEL Range z_of_plane(double x, double y) const noexcept {
        const double s = m_n.x * x + m_n.y * y;
        return {-(s + m_far) * m_inverse, -(s + m_near) * m_inverse};
    }

    /// z_of_y() for y, y + 1, ... y + 7, within bounds.
    ESTARA_KERNEL Ranges z_of_rows(double y) const noexcept {
        Ranges z;
        z.lo.fill(bounds[2].lo);
        z.hi.fill(bounds[2].hi);
        for (const Edge& e : m_z_of_y) {
            std::array<double, 8> t;
            for (std::size_t i = 0; i < 8; ++i) {
                t[i] = (e.known * (y + lanes[i]) + e.rest) * e.inverse;
            }
            if (e.lower) {
                for (std::size_t i = 0; i < 8; ++i) z.lo[i] = -t[i] > z.lo[i] ? -t[i] : z.lo[i];
            } else {
                for (std::size_t i = 0; i < 8; ++i) z.hi[i] = t[i] < z.hi[i] ? t[i] : z.hi[i];
            }
        }
        return z;
    }

    /// The z for which boxes (x, y, z), (x, y + 1, z), ... (x, y + 7, z) meet the triangle.
    /// @param rows  z_of_rows(y)
    ESTARA_KERNEL Ranges z_of_boxes(double x, double y, const Ranges& rows) const noexcept {
        const Range zs = z_of_x(x);
        Range ys = bounds[1];
        clip(ys, y_of_x(x));
        Ranges z;
        for (std::size_t i = 0; i < 8; ++i) {
            const double at = y + lanes[i];
            const double s = m_n.x * x + m_n.y * at;
            const double plane_lo = -(s + m_far) * m_inverse, plane_hi = -(s + m_near) * m_inverse;
            const double lo = zs.lo > rows.lo[i] ? zs.lo : rows.lo[i];
            const double hi = zs.hi < rows.hi[i] ? zs.hi : rows.hi[i];
            const bool inside = (at >= ys.lo) & (at <= ys.hi);
            z.lo[i] = plane_lo > lo ? plane_lo : lo;
            const double top = plane_hi < hi ? plane_hi : hi;
            z.hi[i] = inside ? top : -std::numeric_limits<double>::infinity();
        }
        return z;
    }

private:
    /// The inequality known * a + solved * b + rest >= 0 of boxes (a, b) on an edge's inner side in
    /// a projection, solved for b. If `solved` is 0 the bound is infinite or, where the edge itself
    /// is touched, not a number: comparisons with that are false and leave a range as it is.
    struct Edge {
        double known, rest, inverse;
        bool lower;  ///< it bounds b from below

        Edge() = default;
        ESTARA_KERNEL Edge(double da, double db, double a, double b, double winding, double start,
                           double size) noexcept {
            const double side = winding < 0.0 ? -1.0 : 1.0;
            known = -db * side;
            const double solved = da * side;
            rest = known * (start - a) + solved * (start - b) + std::max(0.0, size * known) +
                   std::max(0.0, size * solved);
            lower = solved >= 0.0;
            inverse = 1.0 / (lower ? solved + 0.0 : -solved);  // + 0.0: -0.0 becomes 0.0
        }
    };

    ESTARA_KERNEL static Range solve(const std::array<Edge, 3>& edges, double a) noexcept {
        Range range;
        for (const Edge& e : edges) {
            const double t = (e.known * a + e.rest) * e.inverse;
            range.lo = e.lower && -t > range.lo ? -t : range.lo;
            range.hi = !e.lower && t < range.hi ? t : range.hi;
        }
        return range;
    }

    glm::dvec3 m_n;  ///< with z >= 0
    double m_far, m_near, m_inverse;
    std::array<Edge, 3> m_y_of_x, m_z_of_x, m_z_of_y;
};

}  // namespace estara
