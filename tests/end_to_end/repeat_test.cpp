// Runs of estara-render that belong together: resumed, repeated, with other threads, other names.
#include <cmath>
#include <regex>
#include <sstream>

#include "../programs.h"
#include "../shapes.h"

namespace estara {
namespace {

using test::done_in;
using test::Image;
using test::TemporaryFolder;

const std::string small = " --resolution 160x90 --spp 4 --progress none ";

/// tumble.glb and its wood.vdb, coarse but good enough to compare runs.
class Runs : public ::testing::Test {
protected:
    void SetUp() override {
        done_in(m_folder, "estara-scenes tumble -o tumble.glb");
        done_in(m_folder,
                "estara-bake wood tumble.glb -o wood.vdb --voxel-size 0.02 --progress none");
    }

    std::string render(const std::string& options) const {
        const bool chosen = options.find("--strategy") != std::string::npos;
        return done_in(m_folder, "estara-render tumble.glb" + small + options +
                                     (chosen ? "" : " --strategy grid"));
    }
    void expect_equal(const std::string& a, const std::string& b) const {
        EXPECT_EQ(test::difference(Image(m_folder / a), Image(m_folder / b)).max, 0.0)
            << a << ' ' << b;
    }
    bool exists(const std::string& name) const { return std::filesystem::exists(m_folder / name); }

    const TemporaryFolder m_folder;
};

std::string digest(const TemporaryFolder& folder, const std::string& file) {
    std::istringstream lines(done_in(folder, "vdb_print -l " + file));
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("estara_digest: ")) return line;
    }
    ADD_FAILURE() << file << " has no digest";
    return "";
}

TEST_F(Runs, GiveTheSameBitsForAnyNumberOfThreads) {
    for (const std::string n : {"1", "2", "7"}) {
        done_in(m_folder,
                "estara-bake wood tumble.glb --voxel-size 0.01 --progress none --threads " + n +
                    " -o " + n + ".vdb");
        EXPECT_EQ(digest(m_folder, n + ".vdb"), digest(m_folder, "1.vdb"));
        render("--grids wood.vdb --frames 9 --aov albedo --aov P --aov N --aov depth --threads " +
               n + " -o " + n + ".exr");
        expect_equal(n + ".exr", "1.exr");
    }
}

TEST_F(Runs, OfGridAndDirectAreTheSameWithoutGrids) {
    render("--frames 5 --strategy grid -o grid.exr");
    render("--frames 5 --strategy direct -o direct.exr");
    render("--frames 5 --strategy grid --grids wood.vdb -o baked.exr");
    expect_equal("grid.exr", "direct.exr");
    EXPECT_GT(test::difference(Image(m_folder / "baked.exr"), Image(m_folder / "direct.exr")).max,
              0.0);
}

TEST_F(Runs, ResumeWithTheFramesThatAreMissing) {
    render("--frames 1-4 -o 'f/####.exr'");
    std::filesystem::rename(m_folder / "f/0002.exr", m_folder / "second.exr");
    const std::string fourth = test::text_of(m_folder / "f/0004.exr");
    std::ofstream(m_folder / "f/0003.exr", std::ios::binary) << fourth;  // it shall stay
    const std::string out = render("--frames 1-4 -o 'f/####.exr' --resume --stats stats.json");
    EXPECT_TRUE(out.starts_with("1 frame -> f/####.exr, 3 frames already there: ")) << out;
    EXPECT_EQ(test::json_of(m_folder / "stats.json").at("skipped_frames"), 3);
    expect_equal("f/0002.exr", "second.exr");
    EXPECT_TRUE(test::text_of(m_folder / "f/0003.exr") == fourth);
    EXPECT_EQ(test::files_under(m_folder / "f").size(), 4u);
}

TEST_F(Runs, NameFramesAsAsked) {
    render("--frames 8-12x2 -o 'a/####.png' -o 'b.%04d.png' -o '#.png' -o 'c%d.exr'");
    for (const char* name : {"a/0008.png", "a/0010.png", "a/0012.png", "b.0008.png", "b.0010.png",
                             "8.png", "10.png", "12.png", "c8.exr", "c12.exr"}) {
        EXPECT_TRUE(exists(name)) << name;
    }
    EXPECT_FALSE(exists("a/0009.png"));
    expect_equal("a/0010.png", "b.0010.png");
}

TEST_F(Runs, OfAFrameAloneAndAmongOthersAreTheSame) {
    render("--frames 1-4 --grids wood.vdb -o 'all.#.exr'");
    render("--frames 3 --grids wood.vdb -o one.exr");
    expect_equal("all.3.exr", "one.exr");
}

TEST_F(Runs, DescribeThemselvesInStatisticsAndReport) {
    render(
        "--frames 1-4 --grids wood.vdb -o 'f/#.exr' -o 'f/a #.png' --compare direct "
        "--stats stats.json --report pages/report.html");
    const nlohmann::json stats = test::json_of(m_folder / "stats.json");
    for (const char* key : {"program", "version", "settings", "objects", "frames", "summary",
                            "skipped_frames", "seconds", "peak_memory_bytes"}) {
        EXPECT_TRUE(stats.contains(key)) << key;
    }
    const auto knot = std::find_if(stats.at("objects").begin(), stats.at("objects").end(),
                                   [](const auto& o) { return o.at("object") == "knot"; });
    for (const char* key :
         {"strategy", "filter_width", "grid", "voxel_size", "levels", "grid_bytes"}) {
        EXPECT_TRUE(knot->contains(key)) << key;
    }
    EXPECT_EQ(knot->at("grid"), "wood.vdb");
    ASSERT_EQ(stats.at("frames").size(), 4u);
    for (const nlohmann::json& frame : stats.at("frames")) {
        for (const char* key :
             {"seconds", "evaluation_seconds", "view_seconds", "ray_seconds", "primary_rays",
              "shadow_rays", "samples", "lookups", "misses", "bad_pixels"}) {
            EXPECT_TRUE(frame.at("cost").contains(key)) << key;
            EXPECT_TRUE(frame.at("direct").contains(key)) << key;
        }
        EXPECT_EQ(frame.at("cost").at("primary_rays"), 160 * 90 * 4);
        EXPECT_EQ(frame.at("cost").at("misses"), 0);
        EXPECT_EQ(frame.at("direct").at("lookups"), 0);
        for (const char* key : {"rmse", "p99.9", "max", "psnr"}) {
            EXPECT_TRUE(frame.at("error").contains(key)) << key;
        }
    }
    for (const char* file : {"f/1.exr", "f/a 4.png"}) EXPECT_TRUE(exists(file)) << file;
}

TEST_F(Runs, MakeAReportThatNeedsNothingButThePictures) {
    render("--frames 1-2 --grids wood.vdb -o 'f/a #.png' --report pages/report.html");
    const std::string page = test::text_of(m_folder / "pages/report.html");
    EXPECT_TRUE(page.starts_with("<!DOCTYPE html>")) << page;
    EXPECT_TRUE(page.ends_with("</html>\n"));
    for (const char* outside : {"http:", "https:", "<script", "<link", "@import"}) {
        EXPECT_EQ(page.find(outside), std::string::npos) << outside;
    }
    const std::regex source("src=\"([^\"]*)\"");
    int pictures = 0;
    for (std::sregex_iterator i(page.begin(), page.end(), source), end; i != end; ++i, ++pictures) {
        const std::string path = std::regex_replace((*i)[1].str(), std::regex("%20"), " ");
        EXPECT_TRUE(exists("pages/" + path)) << path;
    }
    EXPECT_EQ(pictures, 2);
}

}  // namespace
}  // namespace estara
