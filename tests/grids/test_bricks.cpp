// The lookup structure of rendering, against OpenVDB's own sampler.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "estara/grids/bricks.h"
#include "estara/grids/vdb_sampler.h"
#include "example_grids.h"

namespace estara {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

/// The 4^3 cells, by their first voxel divided by 4, that a brick holds.
using BrickOrigin = std::array<int, 3>;

BrickOrigin brick_at(const glm::ivec3& cell) { return {cell.x >> 2, cell.y >> 2, cell.z >> 2}; }

/// Bounds of bricks.h for a level, by brick and float: half a code of the brick's range, and
/// rounding.
std::map<BrickOrigin, std::vector<float>> bounds_of(const GridLevel& level,
                                                    const BrickPyramid& bricks) {
    const auto floats = std::size_t(bricks.floats());
    std::map<BrickOrigin, std::vector<std::pair<float, float>>> ranges;
    for (const Block& block : level.blocks) {
        std::uint64_t row = block.first;
        for_each_bit(block.active, [&](int x, int y, int z) {
            const glm::ivec3 voxel = block.origin + glm::ivec3(x, y, z);
            std::set<BrickOrigin> holders;  // a voxel on a seam is in up to eight bricks
            for (int n = 0; n < 8; ++n) {
                holders.insert(brick_at(voxel - glm::ivec3(n >> 2, (n >> 1) & 1, n & 1)));
            }
            for (const BrickOrigin& origin : holders) {
                auto& range = ranges[origin];
                range.resize(floats, {infinity, -infinity});
                for (std::size_t c = 0; c < floats; ++c) {
                    const float v = level.planes[c][row];
                    range[c] = {std::min(range[c].first, v), std::max(range[c].second, v)};
                }
            }
            ++row;
        });
    }
    std::map<BrickOrigin, std::vector<float>> bounds;
    for (const auto& [origin, range] : ranges) {
        for (std::size_t c = 0; c < floats; ++c) {
            const auto [low, high] = range[c];
            const float codes = std::exp2(float(bricks.code_bits(int(c)))) - 1.0f;
            bounds[origin].push_back((high - low) / (2.0f * codes) +
                                     1e-6f * std::max(std::abs(low), std::abs(high)));
        }
    }
    return bounds;
}

glm::ivec3 cell_of(const TextureGrid& grid, const glm::vec3& P, int level) {
    const double per_voxel = 1.0 / std::ldexp(grid.voxel_size, level);
    return glm::ivec3(glm::floor((glm::dvec3(P) - grid.origin) * per_voxel));
}

/// A grid of n floats: a colour first, if there is one.
TextureGrid grid_of(int n, double voxel_size) {
    std::vector<GridChannel> channels;
    if (n >= 3) channels.push_back({"color", 3});
    for (int i = n >= 3 ? 3 : 0; i < n; ++i) channels.push_back({"weight" + std::to_string(i), 1});
    TextureGrid grid = sphere_grid({}, voxel_size, channels);
    add_levels(grid);
    return grid;
}

/// Both samplers on every level, at count points of the sphere.
void expect_like_openvdb(const TextureGrid& grid, const Sphere& sphere, int count) {
    const TemporaryFolder folder;
    write_vdb(folder.file("s.vdb"), {grid}, {});
    const VdbSampler oracle(folder.file("s.vdb"), grid.object);
    const BrickPyramid bricks(read_vdb(folder.file("s.vdb")).front());
    ASSERT_EQ(oracle.levels(), bricks.levels());
    ASSERT_EQ(bricks.floats(), grid.floats());
    const std::vector<glm::vec3> points = sphere.random_points(count);
    for (int n = 0; n < bricks.levels(); ++n) {
        const auto bounds = bounds_of(grid.levels[std::size_t(n)], bricks);
        for (const glm::vec3& P : points) {
            float expected[BrickPyramid::max_floats], got[BrickPyramid::max_floats];
            ASSERT_TRUE(oracle.lookup(P, n, expected));
            ASSERT_TRUE(bricks.lookup(P, n, got));
            const std::vector<float>& bound = bounds.at(brick_at(cell_of(grid, P, n)));
            for (int c = 0; c < grid.floats(); ++c) {
                ASSERT_NEAR(got[c], expected[c], bound[std::size_t(c)])
                    << "level " << n << " float " << c;
            }
        }
    }
}

TEST(BrickPyramid, AgreesWithOpenVdbOnEveryLevel) {
    expect_like_openvdb(complete_grid("", 0.02), {}, 1'000'000);
}

TEST(BrickPyramid, AgreesWithOpenVdbForAnyNumberOfFloats) {
    for (int n = 1; n <= BrickPyramid::max_floats; ++n) {
        expect_like_openvdb(grid_of(n, 0.1), {}, 2'000);
    }
}

TEST(BrickPyramid, AgreesWithOpenVdbFarFromTheOrigin) {
    // Points in float are 0.0005 apart there: a twentieth of a voxel, which the grid allows for.
    const Sphere sphere{{10'000.0, -10'000.0, 10'000.0}, 0.5};
    TextureGrid grid = sphere_grid(sphere, 0.01, {{"color", 3}}, waves, 0.2);
    add_levels(grid);
    expect_like_openvdb(grid, sphere, 20'000);
}

TEST(BrickPyramid, AgreesWithOpenVdbOnAnOpenSurface) {
    const Sphere sphere{{0.0, 0.0, 0.0}, 1.0, true};
    TextureGrid grid = sphere_grid(sphere, 0.05, {{"color", 3}});
    add_levels(grid);
    expect_like_openvdb(grid, sphere, 20'000);
}

TEST(BrickPyramid, ReturnsTheVoxelAtItsCentre) {
    TextureGrid grid = complete_grid("", 0.0625);  // a power of two: positions are exact
    grid.origin = {-2.0, 3.0, 0.5};
    const BrickPyramid bricks(grid);
    int found = 0;
    for (int n = 0; n < bricks.levels(); ++n) {
        const GridLevel& level = grid.levels[std::size_t(n)];
        const auto bounds = bounds_of(level, bricks);
        for (const Block& block : level.blocks) {
            std::uint64_t row = block.first;
            for_each_bit(block.active, [&](int x, int y, int z) {
                const glm::ivec3 v = block.origin + glm::ivec3(x, y, z);
                const glm::dvec3 P = grid.origin + std::ldexp(0.0625, n) * glm::dvec3(v);
                float got[4];
                if (bricks.lookup(glm::vec3(P), n, got)) {  // not a corner of the shell's outside
                    ++found;
                    for (std::size_t c = 0; c < 4; ++c) {
                        ASSERT_NEAR(got[c], level.planes[c][row], bounds.at(brick_at(v))[c]);
                    }
                }
                ++row;
            });
        }
    }
    EXPECT_GT(found, int(grid.levels[0].voxels() * 3 / 4));
}

TEST(BrickPyramid, ReturnsAConstantExactly) {
    TextureGrid grid = sphere_grid({}, 0.05, {{"color", 3}},
                                   [](const glm::dvec3&, int c) { return 0.1f + 0.3f * float(c); });
    add_levels(grid);
    const BrickPyramid bricks(grid);
    for (const glm::vec3& P : Sphere{}.random_points(10'000)) {
        float got[3];
        ASSERT_TRUE(bricks.lookup(P, 0.11f, got));
        for (int c = 0; c < 3; ++c) ASSERT_EQ(got[c], 0.1f + 0.3f * float(c));
    }
}

TEST(BrickPyramid, IsTheMeanAwayFromTheSurface) {
    const TextureGrid grid = complete_grid();
    const BrickPyramid bricks(grid);
    double mean[4] = {};
    for (std::size_t c = 0; c < 4; ++c) {
        for (const float v : grid.levels[0].planes[c]) mean[c] += v;
        mean[c] /= double(grid.levels[0].voxels());
    }
    const auto expect_mean = [&](const float* got) {
        for (int c = 0; c < 4; ++c) EXPECT_FLOAT_EQ(got[c], float(mean[c]));
    };
    const float huge = std::numeric_limits<float>::max();
    for (const glm::vec3& P : {glm::vec3(5.0f), glm::vec3(-5.0f), glm::vec3(0.3f, -0.2f, 9.0f),
                               glm::vec3(1e10f), glm::vec3(huge, 0.0f, 0.0f), glm::vec3(-huge),
                               glm::vec3(infinity), glm::vec3(0.0f, -infinity, 0.0f),
                               glm::vec3(not_a_number), glm::vec3(0.3f, not_a_number, 0.1f)}) {
        float got[4];
        for (int n = 0; n < bricks.levels(); ++n) {
            EXPECT_FALSE(bricks.lookup(P, n, got)) << P.x << ' ' << P.y << ' ' << P.z;
            expect_mean(got);
        }
        EXPECT_FALSE(bricks.lookup(P, 0.3f, got));
        expect_mean(got);
    }
    float got[4];
    EXPECT_FALSE(bricks.lookup(glm::vec3(0.3f, -0.2f, 0.1f), 0, got)) << "centre of the sphere";
    expect_mean(got);
}

TEST(BrickPyramid, IsNeverOutsideTheValuesOfItsVoxelsBesideTheSurface) {
    const TextureGrid grid = complete_grid();
    const BrickPyramid bricks(grid);
    const auto [low, high] =
        std::minmax_element(grid.levels[0].planes[0].begin(), grid.levels[0].planes[0].end());
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-1.5f, 1.5f);
    for (int i = 0; i < 100'000; ++i) {
        float got[4];
        bricks.lookup(glm::vec3(uniform(random), uniform(random), uniform(random)), 0, got);
        ASSERT_GE(got[0], *low - 1e-6f);
        ASSERT_LE(got[0], *high + 1e-6f);
    }
}

TEST(BrickPyramid, LevelFollowsTheFootprint) {
    const BrickPyramid bricks(complete_grid("", 0.0625));
    const auto last = float(bricks.levels() - 1);
    const float bias = BrickPyramid::level_bias;
    EXPECT_FLOAT_EQ(bricks.level_for(0.0625f * std::exp2(1.5f - bias)), 1.5f);
    EXPECT_NEAR(bricks.level_for(0.0625f * std::exp2(-bias)), 0.0f, 5e-7f);
    for (float level = 0.1f; level < last; level += 0.01f) {
        // One level alone, but for the quarter around its middle.
        const float whole = std::floor(level);
        const float share = std::clamp(4.0f * (level - whole - 0.375f), 0.0f, 1.0f);
        EXPECT_NEAR(bricks.level_for(0.0625f * std::exp2(level - bias)), whole + share, 4e-6f);
    }
    EXPECT_EQ(bricks.level_for(1e-30f), 0.0f);
    EXPECT_EQ(bricks.level_for(0.0f), 0.0f);
    EXPECT_EQ(bricks.level_for(-1.0f), 0.0f);
    EXPECT_EQ(bricks.level_for(-infinity), 0.0f);
    EXPECT_EQ(bricks.level_for(not_a_number), 0.0f);
    EXPECT_EQ(bricks.level_for(1e30f), last);
    EXPECT_EQ(bricks.level_for(infinity), last);
}

struct Looked {
    std::vector<float> planes;
    std::vector<std::uint8_t> found;
    bool operator==(const Looked&) const = default;
};

Looked batch(const BrickPyramid& bricks, const std::vector<glm::vec3>& P,
             const std::vector<float>& footprints) {
    Looked looked{std::vector<float>(P.size() * std::size_t(bricks.floats())),
                  std::vector<std::uint8_t>(P.size())};
    bricks.lookup(P, footprints, looked.planes.data(), P.size(), looked.found.data());

    std::vector<float> by_axis(3 * P.size());
    for (std::size_t i = 0; i < P.size(); ++i) {
        for (std::size_t a = 0; a < 3; ++a) by_axis[a * P.size() + i] = P[i][int(a)];
    }
    Looked same = looked;
    std::fill(same.planes.begin(), same.planes.end(), not_a_number);
    bricks.lookup(by_axis.data(), footprints, same.planes.data(), P.size(), same.found.data());
    EXPECT_TRUE(same == looked) << "points by axis";
    return looked;
}

/// On the sphere, beside it, far away and nowhere, with footprints of all levels and none.
std::pair<std::vector<glm::vec3>, std::vector<float>> mixed_points(int count) {
    std::vector<glm::vec3> P = Sphere{}.random_points(count);
    std::vector<float> footprints;
    std::mt19937 random(11);
    std::uniform_real_distribution<float> uniform;
    for (std::size_t i = 0; i < P.size(); ++i) {
        footprints.push_back(std::exp2(12.0f * uniform(random) - 8.0f));
        if (i % 7 == 0) footprints.back() = 0.0f;
        if (i % 50 == 3) footprints.back() = not_a_number;
        if (i % 11 == 5) P[i] += 0.2f * (glm::vec3(uniform(random)) - 0.5f);
        if (i % 101 == 50) P[i].y = not_a_number;
        if (i % 101 == 70) P[i].z = infinity;
        if (i % 101 == 90) P[i] *= 1e30f;
    }
    return {P, footprints};
}

TEST(BrickPyramid, IsTheSameOnEveryInstructionSetAndOneByOne) {
    for (int n = 1; n <= BrickPyramid::max_floats; ++n) {
        const TextureGrid grid = grid_of(n, 0.05);
        const auto [P, footprints] = mixed_points(5'003);
        const BrickPyramid widest(grid);
        const Looked expected = batch(widest, P, footprints);
        EXPECT_GT(std::count(expected.found.begin(), expected.found.end(), 0), 100);
        for (const auto limit :
             {InstructionSet::baseline, InstructionSet::sse42, InstructionSet::avx2}) {
            EXPECT_TRUE(batch(BrickPyramid(grid, limit), P, footprints) == expected)
                << n << " floats, instruction set " << int(limit);
        }
        for (std::size_t i = 0; i < P.size(); ++i) {
            float got[BrickPyramid::max_floats];
            ASSERT_EQ(widest.lookup(P[i], footprints[i], got), expected.found[i] != 0);
            for (std::size_t c = 0; c < std::size_t(n); ++c) {
                ASSERT_EQ(got[c], expected.planes[c * P.size() + i]);
            }
        }
    }
}

TEST(BrickPyramid, AroundPointsIsTheSameAtThem) {
    for (const int n : {3, 5}) {
        const TextureGrid grid = grid_of(n, 0.02);
        const auto [P, footprints] = mixed_points(501);
        const std::vector<float> finest(P.size(), 0.0f);
        const BrickPyramid whole(grid);
        const BrickPyramid part = BrickPyramid::around(grid, P);
        EXPECT_TRUE(batch(part, P, finest) == batch(whole, P, finest));
        EXPECT_EQ(part.levels(), 1);
        EXPECT_LT(part.bytes(), whole.bytes() / 2);
    }
}

TEST(BrickPyramid, TakesAtMost24BytesAVoxelOfThreeFloats) {
    const TextureGrid grid = grid_of(3, 0.01);
    EXPECT_LT(double(BrickPyramid(grid).bytes()), 24.0 * double(grid.levels[0].voxels()));
}

TEST(BrickPyramid, BlendsLevelsWithoutAStep) {
    const TextureGrid grid = complete_grid();
    const BrickPyramid bricks(grid);
    for (const glm::vec3& P : Sphere{}.random_points(200)) {
        float last[4], at_level[4];
        ASSERT_TRUE(bricks.lookup(P, 0.0f, last));
        ASSERT_TRUE(bricks.lookup(P, 0, at_level));
        EXPECT_EQ(last[0], at_level[0]);
        for (float footprint = 0.02f; footprint < 10.0f; footprint *= 1.01f) {
            float got[4];
            ASSERT_TRUE(bricks.lookup(P, footprint, got));
            // 1 % is 0.0144 levels, and neighbouring levels differ by less than 1 here.
            for (int c = 0; c < 4; ++c) ASSERT_NEAR(got[c], last[c], 0.0145f);
            std::copy_n(got, 4, last);
        }
        ASSERT_TRUE(bricks.lookup(P, bricks.levels() - 1, at_level));
        EXPECT_EQ(last[0], at_level[0]);
    }
}

/// A cell at each corner of a cube of the given extent, in a block of its own: voxels 5 to 6, 4 to
/// 5 and 6 to 7 of it.
TextureGrid corners(int extent) {
    TextureGrid grid;
    grid.channels = {{"color", 3}};
    GridLevel& level = grid.levels.emplace_back();
    level.planes.resize(3);
    for (int n = 0; n < 8; ++n) {
        Block block;
        block.origin = (extent - 8) * glm::ivec3(n >> 2, (n >> 1) & 1, n & 1);
        block.first = 8 * std::uint64_t(n);
        for (int v = 0; v < 8; ++v) {
            block.active.set(BlockMask::bit(5 + (v >> 2), 4 + ((v >> 1) & 1), 6 + (v & 1)));
        }
        level.blocks.push_back(block);
        for (auto& plane : level.planes) plane.insert(plane.end(), 8, float(n));
    }
    return grid;
}

TEST(BrickPyramid, StaysSmallWhenBlocksAreFarApart) {
    const int extent = 16384;
    const BrickPyramid bricks(corners(extent));
    EXPECT_LT(bricks.bytes(), 1u << 20);
    for (int n = 0; n < 8; ++n) {
        const glm::ivec3 origin = (extent - 8) * glm::ivec3(n >> 2, (n >> 1) & 1, n & 1);
        float got[3];
        ASSERT_TRUE(bricks.lookup(glm::vec3(origin) + glm::vec3(5.5f, 4.5f, 6.5f), 0, got));
        EXPECT_EQ(got[0], float(n));
    }
    float got[3];
    EXPECT_FALSE(bricks.lookup(glm::vec3(8192.0f), 0, got));
    EXPECT_EQ(got[0], 3.5f);
}

TEST(BrickPyramid, TakesExtentsUpToTwoToTheEighteen) {
    const BrickPyramid bricks(corners(1 << 18));
    EXPECT_LT(bricks.bytes(), 16u << 20);
    float got[3];
    ASSERT_TRUE(bricks.lookup(glm::vec3(262141.5f, 262140.5f, 262142.5f), 0, got));
    EXPECT_EQ(got[0], 7.0f);
    TextureGrid wider = corners((1 << 18) + 8);
    wider.object = "hair";
    EXPECT_EQ(error_of([&] { BrickPyramid(std::move(wider)); }),
              "object \"hair\": 262152 voxels wide, more than 262144; bake it with larger voxels");
}

TEST(BrickPyramid, RefusesMoreFloatsThanALookupReturns) {
    TextureGrid grid = sphere_grid({}, 0.2, {{"color", 3}, {"a", 3}, {"b", 3}});
    grid.object = "vase";
    EXPECT_EQ(error_of([&] { BrickPyramid pyramid(grid); }),
              "object \"vase\": 9 floats a voxel; a lookup takes 1 to 8");
}

TEST(BrickPyramid, RefusesValuesThatAreNotFinite) {
    TextureGrid grid = complete_grid();
    grid.levels[1].planes[3][5] = not_a_number;
    EXPECT_EQ(error_of([&] { BrickPyramid pyramid(grid); }),
              "texture grid: channel \"specular\" has a value on level 1 that is not finite");
}

TEST(BrickPyramid, FindsTheOneValueThatIsNotFinite) {
    TextureGrid grid = complete_grid("", 0.02);
    std::vector<float>& plane = grid.levels[0].planes[1];
    ASSERT_GT(plane.size(), std::size_t{1} << 15);  // some pieces
    constexpr float largest = std::numeric_limits<float>::max();
    const std::string message =
        "texture grid: channel \"color\" has a value on level 0 that is not finite";
    for (const std::size_t row : {std::size_t{0}, plane.size() / 2, plane.size() - 1}) {
        for (const float bad : {not_a_number, infinity, -infinity}) {
            const float good = std::exchange(plane[row], bad);
            EXPECT_EQ(error_of([&] { BrickPyramid pyramid(grid); }), message) << row << ' ' << bad;
            plane[row] = good;
        }
    }
    plane[3] = infinity;
    plane.back() = -infinity;
    EXPECT_EQ(error_of([&] { BrickPyramid pyramid(grid); }), message);
    std::fill(plane.begin(), plane.end(), largest);
    EXPECT_NO_THROW(BrickPyramid pyramid(grid));
}

}  // namespace
}  // namespace estara
