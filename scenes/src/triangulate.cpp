#include "triangulate.h"

#include <cmath>

namespace estara {
namespace {

using glm::dvec2;
using glm::dvec3;

/// Sum of cross products around the polygon: twice its area, along its normal (Sutherland,
/// Sproull & Schumacker 1974, "A Characterization of Ten Hidden-Surface Algorithms": Newell).
dvec3 newell_normal(std::span<const dvec3> P, std::span<const std::uint32_t> order) {
    dvec3 sum(0.0);
    const dvec3 origin = P[order[0]];
    for (std::size_t i = 0; i < order.size(); ++i) {
        sum += glm::cross(P[order[i]] - origin, P[order[(i + 1) % order.size()]] - origin);
    }
    return sum;
}

double turn(const dvec2& a, const dvec2& b, const dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The polygon on the plane across the largest component of its normal, counter-clockwise.
std::vector<dvec2> flattened(std::span<const dvec3> P, const dvec3& normal) {
    const dvec3 size = glm::abs(normal);
    int drop = size.x > size.y ? 0 : 1;
    if (size.z > size[drop]) drop = 2;
    const int u = (drop + 1) % 3, v = (drop + 2) % 3;
    const double sign = normal[drop] < 0.0 ? -1.0 : 1.0;
    std::vector<dvec2> flat;
    flat.reserve(P.size());
    for (const dvec3& p : P) flat.emplace_back(p[u], sign * p[v]);
    return flat;
}

class Clipper {
public:
    Clipper(std::vector<dvec2> flat, std::vector<std::uint32_t> order)
        : m_flat(std::move(flat)), m_left(std::move(order)) {}

    void run(std::vector<glm::uvec3>& out) {
        std::size_t at = 0;
        while (m_left.size() > 3) {
            at = next_ear(at % m_left.size());
            out.emplace_back(before(at), m_left[at], after(at));
            m_left.erase(m_left.begin() + std::ptrdiff_t(at));
        }
        out.emplace_back(m_left[0], m_left[1], m_left[2]);
    }

private:
    std::uint32_t before(std::size_t i) const {
        return m_left[(i + m_left.size() - 1) % m_left.size()];
    }
    std::uint32_t after(std::size_t i) const { return m_left[(i + 1) % m_left.size()]; }

    /// The first ear from `start` on; if there is none, a corner whose loss changes least.
    std::size_t next_ear(std::size_t start) const {
        std::size_t flattest = start;
        double least = INFINITY;
        for (std::size_t k = 0; k < m_left.size(); ++k) {
            const std::size_t i = (start + k) % m_left.size();
            const double size = turn(m_flat[before(i)], m_flat[m_left[i]], m_flat[after(i)]);
            if (size > 0.0 && is_empty(i)) return i;
            if (std::abs(size) < least) {
                least = std::abs(size);
                flattest = i;
            }
        }
        return flattest;
    }

    bool is_empty(std::size_t ear) const {
        const dvec2 &a = m_flat[before(ear)], &b = m_flat[m_left[ear]], &c = m_flat[after(ear)];
        for (const std::uint32_t other : m_left) {
            const dvec2& p = m_flat[other];
            if (p == a || p == b || p == c) continue;
            if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
        }
        return true;
    }

    std::vector<dvec2> m_flat;
    std::vector<std::uint32_t> m_left;  ///< corners that are not cut off yet, in order
};

bool is_convex(const std::vector<dvec2>& flat, const std::vector<std::uint32_t>& order) {
    int turns_left = 0;
    double around = 0.0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const dvec2 &a = flat[order[i]], &b = flat[order[(i + 1) % order.size()]],
                    &c = flat[order[(i + 2) % order.size()]];
        if (turn(a, b, c) < 0.0) return false;
        turns_left += turn(a, b, c) > 0.0 ? 1 : 0;
        const dvec2 d = b - a, e = c - b;
        around += std::atan2(d.x * e.y - d.y * e.x, glm::dot(d, e));
    }
    return turns_left > 0 && around < 7.0;  // once around, not twice
}

}  // namespace

bool triangulate(std::span<const dvec3> places, std::vector<glm::uvec3>& out) {
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        if (order.empty() || places[order.back()] != places[i]) order.push_back(i);
    }
    while (order.size() > 1 && places[order.front()] == places[order.back()]) order.pop_back();
    if (order.size() < 3) return false;
    if (order.size() == 3) {
        out.emplace_back(order[0], order[1], order[2]);
        return true;
    }
    // Clipping ears takes the square of the corners' number.
    constexpr std::size_t most_corners = 20000;
    std::vector<dvec2> flat = flattened(places, newell_normal(places, order));
    if (order.size() > most_corners || is_convex(flat, order)) {
        for (std::size_t i = 2; i < order.size(); ++i) {
            out.emplace_back(order[0], order[i - 1], order[i]);
        }
        return true;
    }
    Clipper(std::move(flat), std::move(order)).run(out);
    return true;
}

bool triangulate(std::span<const std::uint32_t> corners, std::span<const glm::vec3> P,
                 std::vector<glm::uvec3>& out) {
    std::vector<dvec3> places;
    for (const std::uint32_t corner : corners) places.emplace_back(P[corner]);
    const std::size_t first = out.size();
    const bool any = triangulate(places, out);
    for (std::size_t t = first; t < out.size(); ++t) {
        out[t] = {corners[out[t].x], corners[out[t].y], corners[out[t].z]};
    }
    return any;
}

}  // namespace estara
