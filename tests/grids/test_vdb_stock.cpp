// OpenVDB's own reader and writer against ours: the format is theirs.
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <map>

#include "estara/grids/texture_grid.h"
#include "example_grids.h"

namespace estara {
namespace {

using openvdb::FloatGrid;
using openvdb::GridBase;
using openvdb::Vec3s;
using openvdb::Vec3SGrid;

openvdb::GridPtrVec read_by_openvdb(const std::string& path) {
    openvdb::initialize();
    openvdb::io::File file(path);
    file.open(false);
    return *file.getGrids();
}

/// All values and states are the same: of voxels, active or not, and of tiles.
template <class GridT>
void expect_same_tree(const GridT& a, const GridT& b) {
    EXPECT_EQ(a.background(), b.background());
    ASSERT_TRUE(a.tree().hasSameTopology(b.tree()));
    auto q = b.tree().cbeginValueAll();
    std::size_t differ = 0;
    for (auto p = a.tree().cbeginValueAll(); p; ++p, ++q) {
        if (p.getCoord() != q.getCoord() || *p != *q || p.isValueOn() != q.isValueOn()) ++differ;
    }
    EXPECT_EQ(differ, 0u);
    EXPECT_FALSE(q);
}

/// A grid as OpenVDB would make it, voxel by voxel.
template <class GridT, class Value>
typename GridT::Ptr built(const GridLevel& level, const typename GridT::ValueType& background,
                          const Value& value) {
    auto grid = GridT::create(background);
    auto accessor = grid->getAccessor();
    for (const Block& block : level.blocks) {
        std::uint64_t row = block.first;
        for_each_bit(block.active, [&](int x, int y, int z) {
            const openvdb::Coord at(block.origin.x + x, block.origin.y + y, block.origin.z + z);
            accessor.setValue(at, value(row++));
        });
    }
    return grid;
}

/// The grids of a complete_grid(): color, specular and their levels, surface, density.
void expect_grids_of(const TextureGrid& from, const openvdb::GridPtrVec& grids) {
    std::map<std::string, GridBase::Ptr> named;
    for (const GridBase::Ptr& grid : grids) named[grid->getName()] = grid;
    ASSERT_EQ(named.size(), 2 * from.levels.size() + 2);
    for (std::size_t n = 0; n < from.levels.size(); ++n) {
        const std::string suffix = n == 0 ? "" : "_level_" + std::to_string(n);
        SCOPED_TRACE(suffix);
        const auto& planes = from.levels[n].planes;
        const auto color = openvdb::gridPtrCast<Vec3SGrid>(named["color" + suffix]);
        ASSERT_TRUE(color);
        EXPECT_EQ(color->getGridClass(), openvdb::GRID_UNKNOWN);
        EXPECT_EQ(color->getVectorType(), openvdb::VEC_INVARIANT);
        expect_same_tree(
            *color, *built<Vec3SGrid>(from.levels[n], color->background(), [&](std::uint64_t row) {
                return Vec3s(planes[0][row], planes[1][row], planes[2][row]);
            }));
        const auto specular = openvdb::gridPtrCast<FloatGrid>(named["specular" + suffix]);
        ASSERT_TRUE(specular);
        expect_same_tree(*specular,
                         *built<FloatGrid>(from.levels[n], specular->background(),
                                           [&](std::uint64_t row) { return planes[3][row]; }));
    }
    const auto density = openvdb::gridPtrCast<FloatGrid>(named["density"]);
    ASSERT_TRUE(density);
    EXPECT_EQ(density->getGridClass(), openvdb::GRID_FOG_VOLUME);
    expect_same_tree(*density,
                     *built<FloatGrid>(from.levels[0], 0.0f, [](std::uint64_t) { return 1.0f; }));
    EXPECT_EQ(named["surface"]->getGridClass(), openvdb::GRID_LEVEL_SET);
}

TEST(StockOpenVdb, FindsEveryVoxelThatWasWritten) {
    const TemporaryFolder folder;
    TextureGrid grid = complete_grid();
    for (const Compression how : {Compression::zip, Compression::blosc, Compression::none}) {
        write_vdb(folder.file("a.vdb"), {grid}, {how, false});
        expect_grids_of(grid, read_by_openvdb(folder.file("a.vdb")));
    }
    round_to_half(grid);
    write_vdb(folder.file("a.vdb"), {grid}, {Compression::zip, true});
    expect_grids_of(grid, read_by_openvdb(folder.file("a.vdb")));
}

TEST(StockOpenVdb, FindsTheInsideOfAClosedSurfaceFilled) {
    const TemporaryFolder folder;
    // Over 128 voxels across, and over the planes where OpenVDB's largest nodes meet.
    TextureGrid grid = sphere_grid({}, 0.015, {{"color", 3}});
    for (Block& block : grid.levels[0].blocks) block.origin += glm::ivec3(4096 - 64, 0, 4096 - 80);
    grid.shader = "plain";
    grid.tool_version = "0.1.0";
    write_vdb(folder.file("a.vdb"), {grid}, {});
    expect_same(read_vdb(folder.file("a.vdb"))[0], grid);  // whose blocks have another order
    const openvdb::GridPtrVec grids = read_by_openvdb(folder.file("a.vdb"));
    const auto surface = openvdb::gridPtrCast<FloatGrid>(openvdb::findGridByName(grids, "surface"));
    ASSERT_TRUE(surface);
    const auto expected = built<FloatGrid>(grid.levels[0], float(3.0 * grid.voxel_size),
                                           [&](std::uint64_t row) { return grid.distance[row]; });
    openvdb::tools::signedFloodFill(expected->tree());
    expect_same_tree(*surface, *expected);
    const openvdb::Coord center = surface->transform().worldToIndexNodeCentered(
        openvdb::Vec3d(0.3, -0.2, 0.1) + 0.015 * openvdb::Vec3d(4096 - 64, 0, 4096 - 80));
    EXPECT_EQ(surface->getConstAccessor().getValue(center), -surface->background());
}

TEST(StockOpenVdb, GivesStatistics) {
    const TemporaryFolder folder;
    const TextureGrid grid = complete_grid();
    write_vdb(folder.file("a.vdb"), {grid}, {});
    for (const GridBase::Ptr& read : read_by_openvdb(folder.file("a.vdb"))) {
        const GridBase::Ptr again = read->deepCopyGrid();
        again->addStatsMetadata();
        for (const char* name : {GridBase::META_FILE_BBOX_MIN, GridBase::META_FILE_BBOX_MAX,
                                 GridBase::META_FILE_MEM_BYTES, GridBase::META_FILE_VOXEL_COUNT}) {
            ASSERT_TRUE((*read)[name]) << name;
            EXPECT_TRUE(*(*read)[name] == *(*again)[name]) << read->getName() << ' ' << name;
        }
    }
}

TEST(ReadVdb, ReadsWhatOpenVdbHasSavedAgain) {
    using namespace openvdb::io;
    const TemporaryFolder folder;
    for (const bool half : {false, true}) {
        TextureGrid grid = complete_grid();
        if (half) round_to_half(grid);
        write_vdb(folder.file("a.vdb"), {grid}, {Compression::zip, half});
        const openvdb::GridPtrVec grids = read_by_openvdb(folder.file("a.vdb"));
        for (const std::uint32_t flags :
             {COMPRESS_ZIP | COMPRESS_ACTIVE_MASK, COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK,
              COMPRESS_ZIP | COMPRESS_NONE, COMPRESS_NONE | COMPRESS_NONE}) {
            File file(folder.file("b.vdb"));
            file.setCompression(flags);
            file.write(grids);
            file.close();
            const std::vector<TextureGrid> read = read_vdb(folder.file("b.vdb"));
            ASSERT_EQ(read.size(), 1u);
            expect_same(read[0], grid);
        }
    }
}

TEST(ReadVdb, TakesNoPrunedGrid) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.vdb");
    write_vdb(path, {complete_grid("", 0.1)}, {});
    const openvdb::GridPtrVec grids = read_by_openvdb(path);
    const auto color = openvdb::gridPtrCast<Vec3SGrid>(openvdb::findGridByName(grids, "color"));
    for (const openvdb::Index level : {1u, 2u, 3u}) {  // of 8, 128 and 4096 voxels a side
        const Vec3SGrid::Ptr changed = color->deepCopy();
        changed->tree().addTile(level, openvdb::Coord(4096), Vec3s(1.0f), true);
        openvdb::GridPtrVec others = grids;
        std::replace(others.begin(), others.end(), GridBase::Ptr(color), GridBase::Ptr(changed));
        openvdb::io::File(path).write(others);
        EXPECT_EQ(error_of([&] { read_vdb(path); }),
                  path + ": grid \"color\" was pruned; bake it again")
            << level;
    }
}

}  // namespace
}  // namespace estara
