// Levels of detail.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>

#include "estara/grids/vdb_sampler.h"
#include "example_grids.h"

namespace estara {
namespace {

using Voxel = std::tuple<int, int, int>;

template <class F>
void for_each_voxel(const std::vector<Block>& blocks, const F& f) {
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        std::uint64_t row = blocks[b].first;
        for (int i = 0; i < 512; ++i) {
            if (!blocks[b].active.test(i)) continue;
            f(blocks[b].origin + glm::ivec3(i >> 6, (i >> 3) & 7, i & 7), row++);
        }
    }
}

std::set<Voxel> cells_of(const GridLevel& level) {
    std::set<Voxel> cells;
    for (std::size_t b = 0; b < level.blocks.size(); ++b) {
        const glm::ivec3 o = level.blocks[b].origin;
        for (int i = 0; i < 512; ++i) {
            if (level.cells[b].test(i)) {
                cells.insert({o.x + (i >> 6), o.y + ((i >> 3) & 7), o.z + (i & 7)});
            }
        }
    }
    return cells;
}

std::map<Voxel, float> voxels_of(const GridLevel& level, std::size_t plane) {
    std::map<Voxel, float> voxels;
    for_each_voxel(level.blocks, [&](const glm::ivec3& v, std::uint64_t row) {
        voxels[{v.x, v.y, v.z}] = level.planes[plane][row];
    });
    return voxels;
}

TEST(Levels, CellsAreTheParentsOfTheFinerLevelsCells) {
    const TextureGrid grid = complete_grid();
    ASSERT_GE(grid.levels.size(), 3u);
    for (std::size_t n = 1; n < grid.levels.size(); ++n) {
        std::set<Voxel> parents;
        for (const auto& [x, y, z] : cells_of(grid.levels[n - 1])) {
            parents.insert({x >> 1, y >> 1, z >> 1});
        }
        EXPECT_EQ(cells_of(grid.levels[n]), parents) << "level " << n;
    }
}

TEST(Levels, ActiveVoxelsAreTheCornersOfCells) {
    const TextureGrid grid = complete_grid();
    for (const GridLevel& level : grid.levels) {
        std::set<Voxel> corners, active;
        for (const auto& [x, y, z] : cells_of(level)) {
            for (int i = 0; i < 8; ++i) {
                corners.insert({x + (i >> 2), y + ((i >> 1) & 1), z + (i & 1)});
            }
        }
        for (const auto& [voxel, value] : voxels_of(level, 0)) active.insert(voxel);
        EXPECT_EQ(active, corners);
    }
}

TEST(Levels, BlocksAscendAndRowsFollowOneAnother) {
    for (const GridLevel& level : complete_grid().levels) {
        std::uint64_t row = 0;
        Voxel last{-1, -1, -1};
        for (const Block& block : level.blocks) {
            const Voxel origin{block.origin.x, block.origin.y, block.origin.z};
            EXPECT_LT(last, origin);
            EXPECT_EQ(block.first, row);
            EXPECT_GT(block.active.count(), 0);
            last = origin;
            row += std::uint64_t(block.active.count());
        }
        for (const auto& plane : level.planes) EXPECT_EQ(plane.size(), row);
    }
}

TEST(Levels, ValuesAreTentWeightedMeansOfActiveVoxels) {
    const TextureGrid grid = complete_grid();
    for (std::size_t n = 1; n < grid.levels.size(); ++n) {
        for (std::size_t c = 0; c < 4; ++c) {
            const std::map<Voxel, float> fine = voxels_of(grid.levels[n - 1], c);
            for (const auto& [voxel, value] : voxels_of(grid.levels[n], c)) {
                const auto [x, y, z] = voxel;
                double sum = 0.0, weights = 0.0;
                for (int i = 0; i < 27; ++i) {
                    const int dx = i / 9 - 1, dy = i / 3 % 3 - 1, dz = i % 3 - 1;
                    const auto tap = fine.find({2 * x + dx, 2 * y + dy, 2 * z + dz});
                    if (tap == fine.end()) continue;
                    const double w = std::exp2(3 - std::abs(dx) - std::abs(dy) - std::abs(dz));
                    sum += w * tap->second;
                    weights += w;
                }
                ASSERT_GT(weights, 0.0);
                ASSERT_FLOAT_EQ(value, float(sum / weights));
            }
        }
    }
}

TEST(Levels, KeepAConstantConstant) {
    TextureGrid grid = sphere_grid({}, 0.04, {{"color", 3}},
                                   [](const glm::dvec3&, int c) { return 0.1f + 0.3f * float(c); });
    add_levels(grid);
    ASSERT_GE(grid.levels.size(), 3u);
    for (const GridLevel& level : grid.levels) {
        for (std::size_t c = 0; c < 3; ++c) {
            for (const float v : level.planes[c]) ASSERT_EQ(v, 0.1f + 0.3f * float(c));
        }
    }
}

TEST(Levels, EndWithTheFirstOfAtMostSixteenVoxelsASide) {
    const TextureGrid grid = complete_grid("", 0.02);
    for (std::size_t n = 0; n < grid.levels.size(); ++n) {
        glm::ivec3 low(1 << 30), high(0);
        for_each_voxel(grid.levels[n].blocks, [&](const glm::ivec3& v, std::uint64_t) {
            low = glm::min(low, v);
            high = glm::max(high, v);
        });
        const glm::ivec3 extent = high - low + 1;
        const int widest = std::max({extent.x, extent.y, extent.z});
        EXPECT_EQ(widest <= 16, n + 1 == grid.levels.size()) << "level " << n;
    }
}

TEST(Levels, EveryTapOfASurfaceLookupIsActiveOnEveryLevel) {
    const TemporaryFolder folder;
    const Sphere sphere;
    write_vdb(folder.file("s.vdb"), {complete_grid("", 0.013)}, {});
    const VdbSampler sampler(folder.file("s.vdb"), "");
    ASSERT_GE(sampler.levels(), 4);
    float value[4];
    for (const glm::vec3& P : sphere.random_points(100'000)) {
        for (int n = 0; n < sampler.levels(); ++n) {
            ASSERT_TRUE(sampler.lookup(P, n, value))
                << "level " << n << " at " << P.x << ' ' << P.y << ' ' << P.z;
        }
    }
}

TEST(Levels, AreTheSameForAnyThreadCount) {
    TextureGrid one, four;
    {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
        one = complete_grid("", 0.02);
    }
    {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
        four = complete_grid("", 0.02);
    }
    expect_same(one, four);
}

TEST(Levels, NeedCells) {
    TextureGrid grid = sphere_grid({}, 0.1, {{"color", 3}});
    grid.levels[0].cells.clear();
    EXPECT_THROW(add_levels(grid), std::invalid_argument);
    grid.levels.clear();
    EXPECT_THROW(add_levels(grid), std::invalid_argument);
}

TEST(RoundToHalf, MovesAColourByAtMostTwoToTheMinusTwelve) {
    TextureGrid grid = complete_grid();
    const TextureGrid before = grid;
    round_to_half(grid);
    bool moved = false;
    for (std::size_t i = 0; i < grid.levels[0].planes[0].size(); ++i) {
        const float a = before.levels[0].planes[0][i], b = grid.levels[0].planes[0][i];
        ASSERT_LE(std::abs(a - b), std::ldexp(1.0f, -12));
        moved = moved || a != b;
    }
    EXPECT_TRUE(moved);
    const TextureGrid once = grid;
    round_to_half(grid);
    expect_same(once, grid);
}

TEST(RoundToHalf, KeepsLargeValuesFinite) {
    TextureGrid grid = complete_grid();
    grid.levels[0].planes[0][0] = 1e30f;
    grid.levels[0].planes[0][1] = -1e30f;
    grid.levels[0].planes[0][2] = 65504.0f;
    round_to_half(grid);
    EXPECT_EQ(grid.levels[0].planes[0][0], 65504.0f);
    EXPECT_EQ(grid.levels[0].planes[0][1], -65504.0f);
    EXPECT_EQ(grid.levels[0].planes[0][2], 65504.0f);
}

}  // namespace
}  // namespace estara
