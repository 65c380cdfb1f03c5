// The loop over a block's triangles, against each test done by itself.
#include "block_loops.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

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

/// Triangles in and around a block at 64, from a tenth of a voxel to some blocks large; some are
/// segments, points, in a plane of cell faces, or a thousand blocks large.
Mesh random_triangles(int count) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    const auto vector = [&] {
        return glm::vec3(uniform(random), uniform(random), uniform(random));
    };
    Mesh mesh;
    for (int n = 0; n < count; ++n) {
        const float size = std::exp2(4.0f * uniform(random)) * (n % 16 == 12 ? 8192.0f : 1.0f);
        const glm::vec3 center = glm::vec3(68.0f) + 6.0f * vector();
        std::array<glm::vec3, 3> v{center + size * vector(), center + size * vector(),
                                   center + size * vector()};
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
    static NearestTriangles nearest;
    CellRows cells;
    voxelize({mesh, unit_lattice, origin, {&triangle, 1}}, cells, nearest);
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
    const Mesh mesh = random_triangles(200);
    const std::vector<std::uint32_t> numbers = all_of(mesh);
    static NearestTriangles nearest;
    nearest.clear();
    CellRows all_cells;
    voxelize({mesh, unit_lattice, origin, numbers}, all_cells, nearest);

    std::vector<double> expected(512, std::numeric_limits<double>::infinity());
    for (const std::uint32_t t : numbers) {
        const CellRows cells = cells_of(mesh, t);
        const Triangle v = unit_lattice.corners(mesh, t);
        for (int bit = 0; bit < 512; ++bit) {
            const glm::ivec3 voxel(bit >> 6, (bit >> 3) & 7, bit & 7);
            if (((cells.corners(std::size_t(voxel.x), std::size_t(voxel.y)) >> voxel.z) & 1) == 0) {
                continue;
            }
            double& e = expected[std::size_t(bit)];
            e = std::min(e, distance_to_triangle(glm::dvec3(origin + voxel), v));
        }
    }
    for (std::size_t bit = 0; bit < 512; ++bit) {
        const double distance = nearest.distance[bit];
        if (std::isinf(expected[bit])) {
            EXPECT_TRUE(std::isinf(distance));
            continue;
        }
        EXPECT_NEAR(distance, expected[bit], 5e-6) << bit;
        const Triangle v = unit_lattice.corners(mesh, nearest.triangle[bit]);
        const glm::dvec3 voxel(origin +
                               glm::ivec3(int(bit) >> 6, (int(bit) >> 3) & 7, int(bit) & 7));
        constexpr double tie = 1e-5;
        EXPECT_NEAR(distance_to_triangle(voxel, v), distance, tie + 5e-6) << bit;
    }
}

TEST(BlockLoops, GiveTheSameBitsOnEveryInstructionSet) {
    const Mesh mesh = random_triangles(500);
    const std::vector<std::uint32_t> numbers = all_of(mesh);
    const BlockInput in{mesh, unit_lattice, origin, numbers};
    static NearestTriangles baseline, wide;
    CellRows baseline_cells;
    baseline.clear();
    voxelize(in, baseline_cells, baseline, InstructionSet::baseline);
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
        CellRows cells;
        wide.clear();
        voxelize(in, cells, wide, set);
        EXPECT_EQ(cells.rows, baseline_cells.rows);
        EXPECT_EQ(std::memcmp(&wide, &baseline, sizeof wide), 0);
    }
}

}  // namespace
}  // namespace estara
