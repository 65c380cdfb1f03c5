// The loop over a block's triangles, against each test done by itself.
#include "block_loops.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>
#include <set>
#include <span>
#include <tuple>

namespace estara {
namespace {

using Triangle = std::array<glm::dvec3, 3>;

/// Whether a box meets a triangle: no axis separates them (Akenine-Möller 2001, "Fast 3D
/// Triangle-Box Overlap Testing").
bool meet(const Triangle& v, const glm::dvec3& center, double half) {
    std::vector<glm::dvec3> axes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    axes.push_back(glm::cross(v[1] - v[0], v[2] - v[0]));
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t e = 0; e < 3; ++e) {
            axes.push_back(glm::cross(axes[c], v[(e + 1) % 3] - v[e]));
        }
    }
    return std::none_of(axes.begin(), axes.end(), [&](const glm::dvec3& axis) {
        if (glm::length(axis) < 1e-9) return false;
        const glm::dvec3 n = glm::normalize(axis);
        const double reach = half * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
        const double a = glm::dot(n, v[0] - center), b = glm::dot(n, v[1] - center),
                     c = glm::dot(n, v[2] - center);
        return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
    });
}

double distance_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
    const double length2 = glm::dot(b - a, b - a);
    const double t = length2 > 0.0 ? glm::dot(p - a, b - a) / length2 : 0.0;
    return glm::length(p - glm::mix(a, b, std::clamp(t, 0.0, 1.0)));
}

double distance_to_triangle(const glm::dvec3& p, const Triangle& v) {
    const glm::dvec3 n = glm::cross(v[1] - v[0], v[2] - v[0]);
    bool inside = glm::length(n) > 1e-9;
    double nearest = 1e30;
    for (std::size_t e = 0; e < 3; ++e) {
        const glm::dvec3 &a = v[e], &b = v[(e + 1) % 3];
        inside = inside && glm::dot(glm::cross(b - a, p - a), n) >= 0.0;
        nearest = std::min(nearest, distance_to_segment(p, a, b));
    }
    return inside ? std::abs(glm::dot(glm::normalize(n), p - v[0])) : nearest;
}

/// Some hundreds or thousands of blocks large.
bool is_large(int n) { return n % 16 == 12; }

/// Triangles in and around a block at 64, from a tenth of a voxel to some blocks large; some are
/// segments, points, in a plane of cell faces, or large.
Mesh random_triangles(int count) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    const auto vector = [&] {
        return glm::vec3(uniform(random), uniform(random), uniform(random));
    };
    Mesh mesh;
    for (int n = 0; n < count; ++n) {
        const float size = std::exp2(4.0f * uniform(random)) * (is_large(n) ? 1024.0f : 1.0f);
        const glm::vec3 center = glm::vec3(68.0f) + 6.0f * vector();
        std::array<glm::vec3, 3> v{center + size * vector(), center + size * vector(),
                                   center + size * vector()};
        if (is_large(n)) {  // its inside or, each second time, an edge of it crosses the block
            const float b1 = 0.5f + 0.4f * uniform(random),
                        b2 = n % 32 == 12 ? 0.0f : 0.5f - 0.5f * b1;
            const glm::vec3 shift = center - ((1.0f - b1 - b2) * v[0] + b1 * v[1] + b2 * v[2]);
            for (glm::vec3& corner : v) corner += shift;
        }
        if (n % 16 == 13) v[2] = 0.5f * (v[0] + v[1]);
        if (n % 16 == 14) v[2] = v[1] = v[0];
        if (n % 16 == 15) v[0].z = v[1].z = v[2].z = std::round(center.z);
        for (unsigned i = 0; i < 3; ++i) mesh.P.push_back(v[i]);
        mesh.triangles.emplace_back(3 * n, 3 * n + 1, 3 * n + 2);
    }
    return mesh;
}

constexpr Lattice unit_lattice{1.0, glm::dvec3(0.0), 1e-3};
constexpr glm::ivec3 origin(64);

std::vector<std::uint32_t> all_of(const Mesh& mesh) {
    std::vector<std::uint32_t> numbers(mesh.triangles.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    return numbers;
}

/// The cells that one triangle meets.
CellRows cells_of(const Mesh& mesh, std::uint32_t triangle) {
    CellRows cells;
    voxelize({mesh, unit_lattice, origin, {&triangle, 1}}, cells, nullptr);
    return cells;
}

template <class F>
void for_each_cell(F&& f) {
    for (int x = -1; x < 8; ++x) {
        for (int y = -1; y < 8; ++y) {
            for (int z = -1; z < 8; ++z) f(glm::ivec3(x, y, z));
        }
    }
}

bool marked(const CellRows& cells, const glm::ivec3& c) {
    return ((cells.rows[std::size_t(c.x + 1)][std::size_t(c.y + 1)] >> (c.z + 1)) & 1) != 0;
}

/// Whether a cell around a voxel is marked.
bool is_corner(const CellRows& cells, const glm::ivec3& voxel) {
    for (int n = 0; n < 8; ++n) {
        if (marked(cells, voxel - glm::ivec3(n & 1, (n >> 1) & 1, n >> 2))) return true;
    }
    return false;
}

/// The block's voxels in bit order.
glm::ivec3 voxel_of(int bit) { return {bit >> 6, (bit >> 3) & 7, bit & 7}; }

NearestTriangles& cleared_nearest() {
    static NearestTriangles nearest;
    nearest.clear();
    return nearest;
}

TEST(BlockLoops, MarkTheCellsThatATriangleMeets) {
    const Mesh mesh = random_triangles(800);
    int met = 0;
    for (const std::uint32_t t : all_of(mesh)) {
        const CellRows cells = cells_of(mesh, t);
        const Triangle v = unit_lattice.corners(mesh, t);
        for_each_cell([&](const glm::ivec3& cell) {
            const glm::dvec3 center = glm::dvec3(origin + cell) + 0.5;
            constexpr double half = 0.5 + unit_lattice.slack, rounding = 1e-9;
            if (meet(v, center, half - rounding)) {
                ++met;
                ASSERT_TRUE(marked(cells, cell)) << "triangle " << t;
            } else if (!meet(v, center, half + rounding)) {
                ASSERT_FALSE(marked(cells, cell)) << "triangle " << t;
            }
        });
    }
    EXPECT_GT(met, 4000);
}

TEST(BlockLoops, FindTheNearestOfTheTrianglesThatMeetACellAround) {
    const Mesh mesh = random_triangles(400);
    const std::vector<std::uint32_t> numbers = all_of(mesh);
    // A few at a time, so that each is the nearest somewhere.
    int found = 0, of_large = 0;
    for (std::size_t first = 0; first < numbers.size(); first += 8) {
        const auto some = std::span(numbers).subspan(first, 8);
        NearestTriangles& nearest = cleared_nearest();
        CellRows cells;
        voxelize({mesh, unit_lattice, origin, some}, cells, &nearest);

        std::vector<double> expected(512, std::numeric_limits<double>::infinity());
        std::set<std::tuple<int, int, int>> met;
        for (const std::uint32_t t : some) {
            const CellRows own = cells_of(mesh, t);
            const Triangle v = unit_lattice.corners(mesh, t);
            for_each_cell([&](const glm::ivec3& c) {
                if (marked(own, c)) met.emplace(c.x, c.y, c.z);
            });
            for (int bit = 0; bit < 512; ++bit) {
                const glm::ivec3 voxel = voxel_of(bit);
                if (!is_corner(own, voxel)) continue;
                double& e = expected[std::size_t(bit)];
                e = std::min(e, distance_to_triangle(glm::dvec3(origin + voxel), v));
            }
        }
        for_each_cell([&](const glm::ivec3& c) {
            EXPECT_EQ(marked(cells, c), met.contains({c.x, c.y, c.z}));
        });
        for (int bit = 0; bit < 512; ++bit) {
            const double distance = nearest.distance[std::size_t(bit)];
            if (std::isinf(expected[std::size_t(bit)])) {
                EXPECT_TRUE(std::isinf(distance));
                continue;
            }
            EXPECT_NEAR(distance, expected[std::size_t(bit)], 5e-6) << bit;
            const std::uint32_t t = nearest.triangle[std::size_t(bit)];
            constexpr double tie = 1e-5;
            EXPECT_NEAR(distance_to_triangle(glm::dvec3(origin + voxel_of(bit)),
                                             unit_lattice.corners(mesh, t)),
                        distance, tie + 5e-6)
                << bit;
            ++found;
            of_large += is_large(int(t));
        }
    }
    EXPECT_GT(found, 5000);
    EXPECT_GT(of_large, 2000);
}

TEST(BlockLoops, KeepTheSmallestDistanceOfSheetsThatTie) {
    Mesh mesh;  // two parallel triangles; floats below 1 tell such heights apart
    for (const float z : {0.25f, 0.250009f}) {
        for (const glm::vec2 p : {glm::vec2(-9, -9), glm::vec2(30, -9), glm::vec2(-9, 30)}) {
            mesh.P.emplace_back(p, z);
        }
    }
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    for (const std::vector<std::uint32_t>& order :
         {std::vector<std::uint32_t>{0, 1}, std::vector<std::uint32_t>{1, 0}}) {
        NearestTriangles& nearest = cleared_nearest();
        CellRows cells;
        voxelize({mesh, unit_lattice, glm::ivec3(0), order}, cells, &nearest);
        const auto below = std::size_t((3 << 6) | (3 << 3)), above = below + 1;
        EXPECT_NEAR(nearest.distance[below], mesh.P[0].z, 5e-6);
        EXPECT_NEAR(nearest.distance[above], 1.0 - double(mesh.P[3].z), 5e-6);
    }
}

TEST(BlockLoops, MeasureADegenerateTriangleAsItsLongestEdge) {
    Mesh mesh;  // its shortest edge runs where a normal of the longest one may point
    mesh.P = {{0, 0, 0}, {0, 0, 3e-11f}, {-100, 0, 0}};
    mesh.triangles = {{0, 1, 2}};
    NearestTriangles& nearest = cleared_nearest();
    CellRows cells;
    voxelize({mesh, unit_lattice, glm::ivec3(0), all_of(mesh)}, cells, &nearest);
    int found = 0;
    for (int bit = 0; bit < 512; ++bit) {
        if (std::isinf(nearest.distance[std::size_t(bit)])) continue;
        const glm::dvec3 voxel(voxel_of(bit));
        EXPECT_NEAR(nearest.distance[std::size_t(bit)], glm::length(voxel), 5e-6);
        EXPECT_EQ(nearest.height[std::size_t(bit)], 0.0f);
        ++found;
    }
    EXPECT_EQ(found, 8);
}

TEST(BlockLoops, GiveTheSameBitsOnEveryInstructionSet) {
    const Mesh mesh = random_triangles(500);
    const std::vector<std::uint32_t> numbers = all_of(mesh);
    const BlockInput in{mesh, unit_lattice, origin, numbers};
    static NearestTriangles baseline, wide;
    CellRows baseline_cells;
    baseline.clear();
    voxelize(in, baseline_cells, &baseline, InstructionSet::baseline);
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
        CellRows cells;
        wide.clear();
        voxelize(in, cells, &wide, set);
        EXPECT_EQ(cells.rows, baseline_cells.rows);
        EXPECT_EQ(std::memcmp(&wide, &baseline, sizeof wide), 0);
    }
}

}  // namespace
}  // namespace estara
