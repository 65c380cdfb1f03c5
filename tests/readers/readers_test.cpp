// Programs that have never heard of us read what estara-bake has written.
#include <cmath>
#include <map>
#include <ostream>
#include <set>
#include <sstream>

#include "../programs.h"
#include "../shapes.h"

namespace estara {
namespace {

using test::done_in;
using test::Image;
using test::TemporaryFolder;

/// A bake, and what is to be found in its file.
struct Baked {
    std::string name;
    std::string mesh;                 ///< "sphere", a model, or "still-life"
    std::string command;              ///< shader and options; SCENE stands for the file
    std::vector<std::string> floats;  ///< channels of one number beside `color`
    std::vector<std::string> objects{""};
    std::string compression = "zip";
    bool half = false;

    friend void PrintTo(const Baked& baked, std::ostream* out) { *out << baked.name; }
};

std::vector<Baked> bakes() {
    const std::string fine = " --voxel-size 0.04";
    const std::string stone =
        "stone SCENE --param scale=0.3 --param Cs=0.6,0.3,0.1 --param graincolor=0.2,0.1,0.05" +
        fine;
    return {
        {"Wood", "sphere", "wood SCENE --param ringscale=3" + fine, {"specular"}},
        {"Stone", "sphere", stone, {}},
        {"Greenmarble", "sphere", "greenmarble SCENE" + fine, {}},
        {"Plastic", "sphere", "plastic SCENE --param Cs=0.1,0.2,0.6" + fine, {}},
        {"CobblestoneSolid", "sphere", "cobblestone SCENE --param txtscale=3" + fine, {}},
        {"CobblestoneOnUv", "spot.obj", "cobblestone SCENE --voxel-size 0.02", {}},
        {"Half", "sphere", stone + " --half", {}, {""}, "zip", true},
        {"Blosc", "sphere", stone + " --compression blosc", {}, {""}, "blosc"},
        {"Uncompressed", "sphere", stone + " --compression none", {}, {""}, ""},
        {"OneOfManyObjects",
         "still-life",
         "wood SCENE --object bowl --voxel-size 0.02",
         {"specular"}},
        {"SeveralObjects",
         "still-life",
         "wood SCENE --voxel-size 0.02",
         {"specular"},
         {"_plinth", "_bowl", "_goblet", "_egg"}},
    };
}

void require(const std::string& program, const std::string& package) {
    const TemporaryFolder folder;
    ASSERT_EQ(test::run_in(folder, "command -v " + program).status, 0)
        << program << " is missing: install the Debian package " << package;
}

/// Bakes into bake.vdb.
void bake(const TemporaryFolder& folder, const Baked& baked) {
    std::string command = baked.command, scene = "$MODELS/" + baked.mesh;
    if (baked.mesh == "sphere") {
        test::write_sphere(folder / "sphere.obj");
        scene = "sphere.obj";
    } else if (baked.mesh == "still-life") {
        done_in(folder, "estara-scenes still-life -o still-life.glb");
        scene = "still-life.glb";
    } else {
        test::model(baked.mesh);
    }
    command.replace(command.find("SCENE"), 5, "\"" + scene + "\"");
    done_in(folder, "estara-bake " + command + " -o bake.vdb --progress none");
}

/// "Name: x" and the lines "key: value" after it, for each grid that vdb_print -l lists.
std::map<std::string, std::map<std::string, std::string>> metadata(const TemporaryFolder& folder) {
    std::map<std::string, std::map<std::string, std::string>> grids;
    std::istringstream lines(done_in(folder, "vdb_print -l bake.vdb"));
    std::string name;
    for (std::string line; std::getline(lines, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("Name: ")) name = line.substr(6);
        if (name.empty() || colon == std::string::npos) continue;
        const std::string key = line.substr(std::min(line.find_first_not_of(' '), colon));
        grids[name][key.substr(0, key.find(": "))] = line.substr(colon + 2);
    }
    return grids;
}

/// Name and type of each grid, as vdb_print lists them.
std::map<std::string, std::string> types(const TemporaryFolder& folder) {
    std::map<std::string, std::string> found;
    std::istringstream lines(done_in(folder, "vdb_print bake.vdb"));
    for (std::string line, name, type; std::getline(lines, line);) {
        std::istringstream words(line);
        words >> name >> type;
        EXPECT_TRUE(found.emplace(name, type).second) << name << " is there twice";
    }
    return found;
}

std::string level_name(const std::string& channel, const std::string& object, int level) {
    return channel + object + (level == 0 ? "" : "_level_" + std::to_string(level));
}

class Readers : public ::testing::TestWithParam<Baked> {
protected:
    void SetUp() override { bake(m_folder, GetParam()); }
    const TemporaryFolder m_folder;
};

TEST_P(Readers, VdbPrintListsEachGridWithItsTypeAndMetadata) {
    ASSERT_NO_FATAL_FAILURE(require("vdb_print", "libopenvdb-tools"));
    auto grids = metadata(m_folder);
    std::map<std::string, std::string> expected;
    for (const std::string& object : GetParam().objects) {
        auto& color = grids["color" + object];
        const int levels = std::stoi("0" + color["estara_levels"]);
        EXPECT_GE(levels, 2);
        for (int level = 0; level < levels; ++level) {
            expected[level_name("color", object, level)] = "vec3s";
            for (const std::string& channel : GetParam().floats) {
                expected[level_name(channel, object, level)] = "float";
            }
        }
        expected["surface" + object] = expected["density" + object] = "float";
        EXPECT_EQ(color["estara_shader"],
                  GetParam().command.substr(0, color["estara_shader"].size()));
        EXPECT_EQ(color["is_saved_as_half_float"], GetParam().half ? "true" : "false");
        const std::string compression = GetParam().compression;
        EXPECT_EQ(color["file_compression"],
                  compression.empty() ? "active values" : compression + " + active values");
        EXPECT_EQ(color["vector_type"], "invariant");
        EXPECT_EQ(color["class"], "unknown");
        EXPECT_EQ(grids["surface" + object]["class"], "level set");
        EXPECT_EQ(grids["density" + object]["class"], "fog volume");
        EXPECT_EQ(color["creator"].substr(0, 12), "estara-bake ");
        EXPECT_LT(std::stod(color["estara_error_rmse"]), 0.2);
    }
    EXPECT_EQ(types(m_folder), expected);
}

TEST_P(Readers, NanovdbTakesEachGrid) {
    ASSERT_NO_FATAL_FAILURE(require("nanovdb_convert", "libnanovdb-tools"));
    ASSERT_NO_FATAL_FAILURE(require("nanovdb_validate", "libnanovdb-tools"));
    done_in(m_folder, "nanovdb_convert bake.vdb bake.nvdb");
    const std::string text = done_in(m_folder, "nanovdb_validate -v bake.nvdb");
    for (const auto& [name, type] : types(m_folder)) {
        EXPECT_NE(text.find("Grid named \"" + name + "\": passed"), std::string::npos) << text;
    }
}

TEST_P(Readers, OpenImageIoFindsRedGreenAndBlue) {
    ASSERT_NO_FATAL_FAILURE(require("iinfo", "openimageio-tools"));
    const std::string text = done_in(m_folder, "iinfo -v bake.vdb");
    const std::string color = "color" + GetParam().objects.front();
    // The labels r, g and b are given to grids of the very name only.
    const std::string labels =
        color == "color" ? "color.r, color.g, color.b" : "color_bowl.x, color_bowl.y, color_bowl.z";
    EXPECT_NE(text.find("channel list: " + labels), std::string::npos) << text;
    EXPECT_NE(text.find("volume float openvdb"), std::string::npos) << text;
}

INSTANTIATE_TEST_SUITE_P(Of, Readers, ::testing::ValuesIn(bakes()),
                         [](const auto& named) { return named.param.name; });

struct Statistics {
    int hits = 0;
    std::array<double, 3> mean{}, min{1e9, 1e9, 1e9}, max{-1e9, -1e9, -1e9};
};

bool is_black(const std::array<float, 3>& c) {
    return c[0] == 0.0f && c[1] == 0.0f && c[2] == 0.0f;
}

/// Of the pixels that show something; the background of vdb_render is black.
Statistics statistics(const Image& image) {
    Statistics s;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const auto color = image.triple(x, y, 0);
            if (is_black(color)) continue;
            ++s.hits;
            for (int c = 0; c < 3; ++c) {
                s.mean[c] += color[c];
                s.min[c] = std::min<double>(s.min[c], color[c]);
                s.max[c] = std::max<double>(s.max[c], color[c]);
            }
        }
    }
    for (double& m : s.mean) m /= std::max(1, s.hits);
    return s;
}

/// "[0.1, 0.2, 0.3]" as vdb_print writes a colour.
std::array<double, 3> color_of(const std::string& text) {
    std::array<double, 3> color{};
    EXPECT_EQ(std::sscanf(text.c_str(), "[%lf, %lf, %lf]", &color[0], &color[1], &color[2]), 3)
        << text;
    return color;
}

/// What vdb_render shows are colours of the grid, and their mean has the hue of the grid's mean.
void expect_colors_of(const Statistics& s, std::map<std::string, std::string>& color) {
    const auto mean = color_of(color["Background value"]);
    const auto min = color_of(color["Min value"]), max = color_of(color["Max value"]);
    const double sum = mean[0] + mean[1] + mean[2], seen = s.mean[0] + s.mean[1] + s.mean[2];
    for (int c = 0; c < 3; ++c) {
        EXPECT_GE(s.min[c], min[c] - 1e-5);
        EXPECT_LE(s.max[c], max[c] + 1e-5);
        EXPECT_NEAR(s.mean[c] / seen, mean[c] / sum, 0.03);
    }
    EXPECT_NEAR(seen / sum, 1.0, 0.25);  // only one side is seen
}

/// The sphere seen along -z, 120 pixels for 3 units: a disc of 40 pixels' radius, and no hole in
/// it.
void expect_a_disc(const Image& image) {
    for (int y = 0; y < 120; ++y) {
        for (int x = 0; x < 120; ++x) {
            const double r = std::hypot(x + 0.5 - 60.0, y + 0.5 - 60.0);
            if (r >= 38.0 && r <= 42.0) continue;  // two pixels, three voxels of doubt
            EXPECT_EQ(is_black(image.triple(x, y, 0)), r > 42.0) << x << ' ' << y;
        }
    }
}

class VdbRender : public Readers {};

TEST_P(VdbRender, ShowsTheSurfaceInItsColors) {
    ASSERT_NO_FATAL_FAILURE(require("vdb_render", "libopenvdb-tools"));
    auto grids = metadata(m_folder);
    const bool is_sphere = GetParam().mesh == "sphere";
    const std::string camera = is_sphere ? "-camera ortho -frame 3 -translate 2,1,3 -lookat 2,1,-3"
                                         : "-translate 2,2,3 -lookat 0,0,0";
    for (const std::string& object : GetParam().objects) {
        done_in(m_folder, "vdb_render bake.vdb out.exr -shader matte -res 120x120 -name surface" +
                              object + " -color color" + object + " " + camera);
        const Image image(m_folder / "out.exr");
        const Statistics s = statistics(image);
        EXPECT_GT(s.hits, 100) << object;
        expect_colors_of(s, grids["color" + object]);
        if (is_sphere) expect_a_disc(image);
    }
}

INSTANTIATE_TEST_SUITE_P(Of, VdbRender, ::testing::ValuesIn(bakes()),
                         [](const auto& named) { return named.param.name; });

}  // namespace
}  // namespace estara
