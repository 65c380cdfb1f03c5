#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "estara/bake/surface_band.h"

namespace estara {

namespace {

/// The number of each vertex among those that differ in position: a hash table with linear probing.
std::vector<std::uint32_t> number_by_position(const std::vector<glm::vec3>& P) {
    constexpr std::uint32_t none = ~std::uint32_t{0};
    const std::size_t mask = std::bit_ceil(2 * P.size() + 1) - 1;
    std::vector<std::uint32_t> slots(mask + 1, none), number(P.size());
    const auto hash = [](const glm::vec3& p) {
        std::uint64_t h = 0;
        for (int c = 0; c < 3; ++c) {
            const float value = p[c] + 0.0f;  // -0 is where 0 is
            h = (h ^ std::bit_cast<std::uint32_t>(value)) * 0x9e3779b97f4a7c15u;
            h ^= h >> 32;
        }
        return std::size_t(h);
    };
    for (std::uint32_t i = 0; i < P.size(); ++i) {
        std::size_t at = hash(P[i]) & mask;
        while (slots[at] != none && P[slots[at]] != P[i]) at = (at + 1) & mask;
        if (slots[at] == none) slots[at] = i;
        number[i] = slots[at];
    }
    return number;
}

}  // namespace

bool is_closed(const Mesh& mesh) {
    // Every edge, listed at its lower vertex as the higher one: a counting sort.
    struct Edge {
        std::uint32_t high;
        bool ascending;
        bool operator<(const Edge& o) const noexcept {
            return high != o.high ? high < o.high : ascending < o.ascending;
        }
    };
    const std::vector<std::uint32_t> number = number_by_position(mesh.P);
    const auto for_each_edge = [&](auto&& f) {
        for (const glm::uvec3& t : mesh.triangles) {
            const std::array<std::uint32_t, 3> c{number[t.x], number[t.y], number[t.z]};
            if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
            for (std::size_t e = 0; e < 3; ++e) {
                const std::uint32_t a = c[e], b = c[(e + 1) % 3];
                f(std::min(a, b), Edge{std::max(a, b), a < b});
            }
        }
    };
    std::vector<std::size_t> first(mesh.P.size() + 1, 0);
    for_each_edge([&](std::uint32_t low, const Edge&) { ++first[low + 1]; });
    for (std::size_t i = 0; i < mesh.P.size(); ++i) first[i + 1] += first[i];
    std::vector<Edge> edges(first.back());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for_each_edge([&](std::uint32_t low, const Edge& edge) { edges[next[low]++] = edge; });

    for (std::size_t v = 0; v < mesh.P.size(); ++v) {
        const std::size_t end = first[v + 1];
        std::sort(edges.begin() + std::ptrdiff_t(first[v]), edges.begin() + std::ptrdiff_t(end));
        for (std::size_t i = first[v]; i < end; i += 2) {
            if (i + 1 == end) return false;
            const bool pair =
                edges[i].high == edges[i + 1].high && edges[i].ascending != edges[i + 1].ascending;
            const bool third = i + 2 < end && edges[i + 2].high == edges[i].high;
            if (!pair || third) return false;
        }
    }
    return !edges.empty();
}

}  // namespace estara
