// What is written to a .vdb file is what is read from it.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>

#include "estara/grids/texture_grid.h"
#include "estara/grids/vdb_sampler.h"
#include "example_grids.h"

namespace estara {
namespace {

/// Length and text, as a .vdb file stores names.
std::string stored(const std::string& text) {
    std::string bytes(4, '\0');
    bytes[0] = char(text.size());
    return bytes + text;
}

TEST(VdbFile, GivesBackWhatWasWritten) {
    const TemporaryFolder folder;
    const TextureGrid grid = complete_grid();
    for (const Compression how : {Compression::zip, Compression::blosc, Compression::none}) {
        const std::uint64_t size = write_vdb(folder.file("a.vdb"), {grid}, {how, false});
        EXPECT_EQ(size, std::filesystem::file_size(folder.file("a.vdb")));
        const std::vector<TextureGrid> read = read_vdb(folder.file("a.vdb"));
        ASSERT_EQ(read.size(), 1u);
        expect_same(read[0], grid);
    }
    EXPECT_EQ(folder.entries(), std::vector<std::string>{"a.vdb"});
}

TEST(VdbFile, GivesBackHalfFloatsThatWereRoundedBefore) {
    const TemporaryFolder folder;
    TextureGrid grid = complete_grid();
    const std::uint64_t full = write_vdb(folder.file("a.vdb"), {grid}, {Compression::none, false});
    write_vdb(folder.file("rounded_by_writing.vdb"), {grid}, {Compression::zip, true});
    round_to_half(grid);
    const std::uint64_t half = write_vdb(folder.file("a.vdb"), {grid}, {Compression::none, true});
    EXPECT_LT(half, full * 2 / 3);
    expect_same(read_vdb(folder.file("a.vdb"))[0], grid);
    expect_same(read_vdb(folder.file("rounded_by_writing.vdb"))[0], grid);
}

TEST(VdbFile, PacksWhatIsFlatAndLeavesNoiseAsItIs) {
    const TemporaryFolder folder;
    const auto size = [&](const TextureGrid& grid, Compression how) {
        const std::uint64_t bytes = write_vdb(folder.file("a.vdb"), {grid}, {how, false});
        expect_same(read_vdb(folder.file("a.vdb"))[0], grid);
        return bytes;
    };
    TextureGrid flat = complete_grid(), noise = flat;
    flat.distance.clear();  // which is never packed
    noise.distance.clear();
    std::minstd_rand random;
    std::uint64_t leaves = 0;
    for (std::size_t n = 0; n < flat.levels.size(); ++n) {
        leaves += flat.levels[n].blocks.size() * flat.channels.size();
        for (auto& plane : noise.levels[n].planes) {
            for (float& value : plane) value = float(random());
        }
        for (auto& plane : flat.levels[n].planes) {
            for (float& value : plane) value = value > 0.5f ? 0.75f : 0.25f;
        }
    }
    EXPECT_LT(size(flat, Compression::zip), size(flat, Compression::none) / 2);
    const std::uint64_t packed = size(noise, Compression::zip);
    const std::uint64_t plain = size(noise, Compression::none);
    EXPECT_GT(packed, plain);
    EXPECT_LT(packed, plain + 16 * leaves);  // a leaf's size, and a few nodes'
}

TEST(VdbFile, HoldsSeveralObjects) {
    const TemporaryFolder folder;
    const std::vector<TextureGrid> grids = {complete_grid("saucer", 0.1),
                                            complete_grid("vase.001")};
    write_vdb(folder.file("a.vdb"), grids, {});
    const std::vector<TextureGrid> read = read_vdb(folder.file("a.vdb"));
    ASSERT_EQ(read.size(), 2u);
    expect_same(read[0], grids[0]);
    expect_same(read[1], grids[1]);
    const VdbSampler sampler(folder.file("a.vdb"), "vase.001");
    EXPECT_EQ(sampler.levels(), int(grids[1].levels.size()));
    EXPECT_EQ(error_of([&] { VdbSampler s(folder.file("a.vdb"), "cup"); }),
              folder.file("a.vdb") + ": no object \"cup\"; it has: \"saucer\", \"vase.001\"");
}

TEST(VdbFile, NamesGridsByChannelObjectAndLevel) {
    const TemporaryFolder folder;
    write_vdb(folder.file("a.vdb"), {complete_grid(), complete_grid("vase")}, {});
    const std::string bytes = read_bytes(folder.file("a.vdb"));
    const std::string colors = stored("Tree_vec3s_5_4_3"), numbers = stored("Tree_float_5_4_3");
    for (const char* name : {"color", "color_level_1", "color_vase", "color_vase_level_1"}) {
        EXPECT_NE(bytes.find(stored(name) + colors), std::string::npos) << name;
    }
    for (const char* name : {"specular", "specular_level_1", "specular_vase", "surface", "density",
                             "surface_vase", "density_vase"}) {
        EXPECT_NE(bytes.find(stored(name) + numbers), std::string::npos) << name;
    }
    EXPECT_EQ(bytes.find(stored("surface_level_1")), std::string::npos);
}

/// Light on the sphere: other voxels, levels and channels than complete_grid() has.
TextureGrid light_grid(const std::string& object) {
    TextureGrid grid = sphere_grid({}, 0.11, {{"irradiance", 3}, {"irradiance_mask", 1}});
    grid.object = object;
    grid.shader = "irradiance";
    grid.lights_digest = "00112233445566aa";
    grid.tool_version = "0.1.0";
    grid.distance.clear();
    add_levels(grid);
    return grid;
}

TEST(VdbFile, HoldsSeveralShadersOfAnObjectUnderPlainNames) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.vdb");
    const std::vector<TextureGrid> grids = {complete_grid("vase"), light_grid("vase")};
    write_vdb(path, grids, {});
    const std::vector<TextureGrid> read = read_vdb(path);
    ASSERT_EQ(read.size(), 2u);
    expect_same(read[0], grids[1]);  // "irradiance" before "wood"
    expect_same(read[1], grids[0]);
    const std::string bytes = read_bytes(path);
    for (const char* name : {"color", "irradiance", "irradiance_mask_level_1", "density"}) {
        EXPECT_NE(bytes.find(stored(name)), std::string::npos);
    }
    EXPECT_EQ(bytes.find("_vase"), std::string::npos);
    EXPECT_EQ(VdbSampler(path, "").levels(), int(grids[0].levels.size()));
    EXPECT_EQ(VdbSampler(path, "vase", "irradiance").levels(), int(grids[1].levels.size()));
    EXPECT_EQ(error_of([&] { VdbSampler s(path, "vase", "stone"); }),
              path + ": object \"vase\" has no colours of shader \"stone\"");
}

TEST(VdbFile, HoldsSeveralShadersOfSeveralObjects) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.vdb");
    const std::vector<TextureGrid> grids = {light_grid("cup"), complete_grid("cup"),
                                            complete_grid("vase"), light_grid("vase")};
    write_vdb(path, grids, {});
    const std::vector<TextureGrid> read = read_vdb(path);
    ASSERT_EQ(read.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
        expect_same(read[i], grids[i == 2 ? 3 : i == 3 ? 2 : i]);
    }
}

TEST(VdbFile, HasSurfaceAndDensityOnlyWithDistances) {
    const TemporaryFolder folder;
    write_vdb(folder.file("a.vdb"), {light_grid("")}, {});
    const std::string bytes = read_bytes(folder.file("a.vdb"));
    EXPECT_EQ(bytes.find(stored("surface")), std::string::npos);
    EXPECT_EQ(bytes.find(stored("density")), std::string::npos);
}

TEST(VdbFile, CanBeWrittenAgainFromWhatWasRead) {
    const TemporaryFolder folder;
    write_vdb(folder.file("a.vdb"), {complete_grid()}, {});
    const std::vector<TextureGrid> read = read_vdb(folder.file("a.vdb"));
    write_vdb(folder.file("b.vdb"), read, {});
    expect_same(read_vdb(folder.file("b.vdb"))[0], read[0]);
}

TEST(VdbFile, KeepsAnEmptyListOfParameters) {
    const TemporaryFolder folder;
    TextureGrid grid = complete_grid();
    grid.params.clear();
    grid.errors.clear();
    write_vdb(folder.file("a.vdb"), {grid}, {});
    expect_same(read_vdb(folder.file("a.vdb"))[0], grid);
}

TEST(VdbFile, DiffersOnlyInItsRandomIdWhateverTheThreadCount) {
    const TemporaryFolder folder;
    const TextureGrid grid = complete_grid();
    const auto written_with = [&](int threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        std::size_t(threads));
        write_vdb(folder.file("a.vdb"), {grid}, {});
        return read_bytes(folder.file("a.vdb"));
    };
    std::string one = written_with(1), four = written_with(4);
    ASSERT_EQ(one.size(), four.size());
    EXPECT_NE(one.substr(21, 36), four.substr(21, 36));
    one.erase(21, 36);
    four.erase(21, 36);
    EXPECT_TRUE(one == four);
}

}  // namespace
}  // namespace estara
