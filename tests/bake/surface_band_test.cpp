// The band: complete, no larger than needed, and signed.
#include "estara/bake/surface_band.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>
#include <set>
#include <tuple>

#include "estara/scenes/error.h"
#include "shapes.h"

namespace estara {
namespace {

using Voxel = std::tuple<int, int, int>;

template <class Function>
void for_each_voxel(const SurfaceBand& band, Function&& function) {
    for (const Block& block : band.blocks) {
        std::uint64_t row = block.first;
        for_each_bit(block.active, [&](int x, int y, int z) {
            function(block.origin + glm::ivec3(x, y, z), row++);
        });
    }
}

/// The nearest point of every voxel, by row.
std::vector<MeshPoint> points_of(const Mesh& mesh, const SurfaceBand& band) {
    std::vector<MeshPoint> all, points;
    for (std::size_t b = 0; b < band.blocks.size(); ++b) {
        nearest_points(mesh, band, b, points);
        all.insert(all.end(), points.begin(), points.end());
    }
    return all;
}

std::set<Voxel> active_voxels(const SurfaceBand& band) {
    std::set<Voxel> active;
    for_each_voxel(band,
                   [&](const glm::ivec3& v, std::uint64_t) { active.emplace(v.x, v.y, v.z); });
    return active;
}

std::string failure(const Mesh& mesh, double voxel_size) {
    try {
        (void)surface_band(mesh, voxel_size);
        return "no error";
    } catch (const Error& error) {
        return error.what();
    }
}

/// Whether every lookup at random points of the mesh, computed in float, finds its eight voxels.
void expect_complete(const Mesh& mesh, const SurfaceBand& band, int points) {
    const std::set<Voxel> active = active_voxels(band);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> uniform;
    for (int n = 0; n < points; ++n) {
        float b1 = uniform(random), b2 = uniform(random);
        if (b1 + b2 > 1.0f) b1 = 1.0f - b1, b2 = 1.0f - b2;
        const auto triangle = std::uint32_t(random() % mesh.triangles.size());
        const glm::vec3 P = mesh_point(mesh, triangle, b1, b2).P;
        const glm::ivec3 base(glm::floor((glm::dvec3(P) - band.origin) / band.voxel_size));
        for (int corner = 0; corner < 8; ++corner) {
            const glm::ivec3 v = base + glm::ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
            ASSERT_TRUE(active.contains({v.x, v.y, v.z})) << "point " << n << ", corner " << corner;
        }
    }
}

TEST(SurfaceBand, HasAllVoxelsThatALookupCanTouch) {
    for (const Mesh& mesh : {test::sphere(20, 1.0f), test::sphere(3, 1.0f), test::square(1.0f),
                             test::sphere(40, 0.7f, glm::vec3(1000.0f, -2000.0f, 500.0f))}) {
        for (const double size : {0.5, 0.1, 0.0213})
            expect_complete(mesh, surface_band(mesh, size), 5000);
    }
}

TEST(SurfaceBand, HasNoVoxelWithoutASurfaceCellBesideIt) {
    const SurfaceBand band = surface_band(test::sphere(30, 1.0f), 0.05);
    std::set<Voxel> corners;
    for (std::size_t b = 0; b < band.blocks.size(); ++b) {
        for (int bit = 0; bit < 512; ++bit) {
            if (!band.cells[b].test(bit)) continue;
            const glm::ivec3 cell =
                band.blocks[b].origin + glm::ivec3(bit >> 6, (bit >> 3) & 7, bit & 7);
            for (int c = 0; c < 8; ++c)
                corners.emplace(cell.x + (c & 1), cell.y + ((c >> 1) & 1), cell.z + (c >> 2));
        }
    }
    EXPECT_EQ(active_voxels(band), corners);
    EXPECT_EQ(band.voxels(), corners.size());
    EXPECT_EQ(count_voxels(test::sphere(30, 1.0f), 0.05), corners.size());
    // A cell that the sphere crosses has a corner no further from it than its half diagonal, .87
    // voxels; the corner opposite is at most a diagonal further.
    for_each_voxel(band, [&](const glm::ivec3& v, std::uint64_t) {
        const double distance = std::abs(glm::length(glm::dvec3(band.position(v))) - 1.0);
        EXPECT_LE(distance, 0.05 * 1.75 + 0.004);  // .004: the mesh's sagitta
    });
}

TEST(SurfaceBand, OfAnAxisAlignedSquareIsTwoLayers) {
    const SurfaceBand band = surface_band(test::square(1.0f), 0.1);
    std::set<int> layers;
    for_each_voxel(band, [&](const glm::ivec3& v, std::uint64_t) { layers.insert(v.z); });
    EXPECT_EQ(layers, (std::set<int>{8, 9}));
}

// Their normals have zeros of both signs.
TEST(SurfaceBand, IsCompleteForTrianglesInThePlanesOfTheAxes) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> within(-0.3f, 0.3f);
    for (int axis = 0; axis < 3; ++axis) {
        for (const float at : {0.0f, 0.0625f, 0.1f, -0.2f}) {
            Mesh mesh;
            for (std::uint32_t t = 0; t < 60; ++t) {
                const glm::vec3 centre(within(random) * 3.0f, within(random) * 3.0f,
                                       within(random) * 3.0f);
                for (int corner = 0; corner < 3; ++corner) {
                    glm::vec3 p =
                        centre + glm::vec3(within(random), within(random), within(random));
                    p[axis] = at;
                    mesh.P.push_back(p);
                }
                mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
            }
            expect_complete(mesh, surface_band(mesh, 1.0 / 32.0), 2000);
        }
    }
}

TEST(SurfaceBand, KnowsTheDistanceAndTheSide) {
    const Mesh mesh = test::sphere(60, 1.0f, glm::vec3(3.0f, 0.0f, 0.0f));
    const SurfaceBand band = surface_band(mesh, 0.04);
    const std::vector<MeshPoint> points = points_of(mesh, band);
    ASSERT_EQ(points.size(), band.voxels());
    for_each_voxel(band, [&](const glm::ivec3& v, std::uint64_t row) {
        const double expected =
            glm::length(glm::dvec3(band.position(v)) - glm::dvec3(3.0, 0.0, 0.0)) - 1.0;
        constexpr double sagitta = 0.003;  // of the mesh
        if (std::abs(expected) < 0.04) {
            EXPECT_NEAR(band.distance[row], expected, sagitta);
        } else {  // the nearest triangle may not cross a cell around the voxel
            EXPECT_EQ(band.distance[row] > 0.0f, expected > 0.0);
            EXPECT_GT(std::abs(band.distance[row]), std::abs(expected) - sagitta);
            EXPECT_LT(std::abs(band.distance[row]), 0.04 * std::sqrt(3.0) + sagitta);
        }
        EXPECT_NEAR(glm::length(points[row].P - band.position(v)), std::abs(band.distance[row]),
                    1e-5);
    });
}

TEST(SurfaceBand, SignsTheSidesOfSharpEdges) {
    // A tetrahedron: near its edges and corners several triangles are equally near.
    Mesh mesh;
    mesh.P = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    const SurfaceBand band = surface_band(mesh, 0.03);
    for_each_voxel(band, [&](const glm::ivec3& v, std::uint64_t row) {
        const glm::vec3 p = band.position(v);
        const double inside = std::min(
            {double(p.x), double(p.y), double(p.z), (1.0 - p.x - p.y - p.z) / std::sqrt(3.0)});
        if (std::abs(inside) > 1e-5) {
            EXPECT_EQ(band.distance[row]<0.0f, inside> 0.0) << p.x << ' ' << p.y << ' ' << p.z;
        }
    });
}

TEST(SurfaceBand, HoldsThinSheetsOpenAndDegenerateTriangles) {
    expect_complete(
        test::joined(test::square(1.0f), test::square(1.0f, 0.001f)),
        surface_band(test::joined(test::square(1.0f), test::square(1.0f, 0.001f)), 0.02), 5000);
    Mesh mesh = test::square(1.0f);
    mesh.P.push_back({2.0f, 2.0f, 2.0f});
    mesh.triangles.emplace_back(4, 4, 4);  // a point
    mesh.triangles.emplace_back(0, 2, 4);  // a triangle
    mesh.triangles.emplace_back(0, 4, 0);  // a segment
    expect_complete(mesh, surface_band(mesh, 0.05), 5000);
}

TEST(SurfaceBand, IsTheSameForAnyNumberOfThreads) {
    const Mesh mesh = test::sphere(50, 1.0f);
    const auto band_with = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return surface_band(mesh, 0.03);
    };
    const SurfaceBand one = band_with(1), four = band_with(4);
    EXPECT_EQ(one.distance, four.distance);
    EXPECT_EQ(one.triangle, four.triangle);
    EXPECT_EQ(one.cells, four.cells);
    ASSERT_EQ(one.blocks.size(), four.blocks.size());
    for (std::size_t b = 0; b < one.blocks.size(); ++b) {
        EXPECT_EQ(one.blocks[b].origin, four.blocks[b].origin);
        EXPECT_EQ(one.blocks[b].active, four.blocks[b].active);
        EXPECT_EQ(one.blocks[b].first, four.blocks[b].first);
    }
}

TEST(SurfaceBand, RefusesVoxelsThatFloatsCannotTellApart) {
    EXPECT_EQ(failure(test::sphere(8, 1.0f, glm::vec3(1e6f)), 0.01),
              "voxel size 0.01 is too small for coordinates as large as 1e+06, which floats tell "
              "apart by 0.12; "
              "move the object to its own origin");
    EXPECT_EQ(failure(test::sphere(8, 1.0f), 1e-6),
              "voxel size 1e-06 divides the object into 2e+06 voxels a side; at most 131072 are "
              "possible, of 1.52588e-05");
    EXPECT_EQ(failure(test::sphere(8, 1.0f), 0.0), "voxel size 0 is not a positive number");
    EXPECT_EQ(failure(test::sphere(8, 1.0f), std::nan("")),
              "voxel size nan is not a positive number");
}

TEST(SurfaceBand, TellsClosedMeshesFromOpenOnes) {
    EXPECT_TRUE(is_closed(test::sphere(10, 1.0f)));
    EXPECT_FALSE(is_closed(test::square(1.0f)));
    Mesh hole = test::sphere(10, 1.0f);
    hole.triangles.pop_back();
    hole.triangles.erase(hole.triangles.begin() + 100);
    EXPECT_FALSE(is_closed(hole));
    Mesh flipped = test::sphere(10, 1.0f);
    std::swap(flipped.triangles[100].x, flipped.triangles[100].y);
    EXPECT_FALSE(is_closed(flipped));
    EXPECT_FALSE(is_closed(Mesh{}));
}

}  // namespace
}  // namespace estara
