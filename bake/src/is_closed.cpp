#include <tbb/parallel_sort.h>

#include <array>
#include <tuple>

#include "estara/bake/surface_band.h"

namespace estara {

bool is_closed(const Mesh& mesh) {
    // Vertices at the same position get the same number.
    std::vector<std::uint32_t> order(mesh.P.size()), number(mesh.P.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto key = [&](std::uint32_t i) {
        return std::tie(mesh.P[i].x, mesh.P[i].y, mesh.P[i].z);
    };
    tbb::parallel_sort(order.begin(), order.end(), [&](auto a, auto b) { return key(a) < key(b); });
    for (std::size_t i = 0; i < order.size(); ++i) {
        number[order[i]] =
            i > 0 && key(order[i]) == key(order[i - 1]) ? number[order[i - 1]] : std::uint32_t(i);
    }

    struct Edge {
        std::uint32_t low, high;
        bool ascending;
        bool operator<(const Edge& o) const noexcept {
            return std::tie(low, high, ascending) < std::tie(o.low, o.high, o.ascending);
        }
    };
    std::vector<Edge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles) {
        const std::array<std::uint32_t, 3> c{number[t.x], number[t.y], number[t.z]};
        if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
        for (int e = 0; e < 3; ++e) {
            const std::uint32_t a = c[e], b = c[(e + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), a < b});
        }
    }
    tbb::parallel_sort(edges.begin(), edges.end());
    if (edges.empty() || edges.size() % 2 != 0) return false;
    for (std::size_t i = 0; i < edges.size(); i += 2) {
        const Edge &a = edges[i], &b = edges[i + 1];
        const bool pair = a.low == b.low && a.high == b.high && a.ascending != b.ascending;
        const bool third =
            i + 2 < edges.size() && edges[i + 2].low == a.low && edges[i + 2].high == a.high;
        if (!pair || third) return false;
    }
    return true;
}

}  // namespace estara
