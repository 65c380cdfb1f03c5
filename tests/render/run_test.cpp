#include "estara/render/run.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "read_image.h"
#include "small_scene.h"

namespace estara {
namespace {

using test::error_of;
using test::Folder;
using test::object;
using test::read_image;
using test::scene_of;
using test::sphere;

Scene ball() { return scene_of({object("ball", sphere(1.0f, 8), "wood")}); }

Options small(const std::string& output) {
    Options options;
    options.scene = "test.glb";
    options.outputs = {FilePattern(output)};
    options.frame.width = 48;
    options.frame.height = 32;
    options.frame.spp = 1;
    options.strategy = Strategy::grid;
    options.progress = ProgressStyle::none;
    return options;
}

RunRecord run_quietly(const Options& options, std::vector<std::string>* said = nullptr) {
    return run(options, ball(), [&](const std::string& message) {
        if (said != nullptr) said->push_back(message);
    });
}

TEST(Run, WritesEachFrameOfEachPattern) {
    const Folder folder;
    Options options = small(folder / "new/##.exr");
    options.outputs.emplace_back(folder / "%03d.png");
    options.frames = {2, 6, 2};
    const RunRecord record = run_quietly(options);
    for (const char* name :
         {"new/02.exr", "new/04.exr", "new/06.exr", "002.png", "004.png", "006.png"}) {
        EXPECT_GT(std::filesystem::file_size(folder / name), 0u) << name;
    }
    EXPECT_EQ(record.frames.size(), 3u);
    EXPECT_EQ(result_line(record).substr(0, 12), "3 frames -> ");
}

TEST(Run, SaysWhichShadersAreEvaluatedDirectly) {
    const Folder folder;
    std::vector<std::string> said;
    run_quietly(small(folder / "a.exr"), &said);
    EXPECT_EQ(said,
              std::vector<std::string>{"shader 'wood' is evaluated directly: no grid for ball"});
    said.clear();
    Options options = small(folder / "a.exr");
    options.strategy = Strategy::direct;
    run_quietly(options, &said);
    EXPECT_EQ(said, std::vector<std::string>{});
}

TEST(Run, PassesOnTheWarningsOfTheScene) {
    const Folder folder;
    Scene scene = scene_of({object("ball", sphere(1.0f, 8))});
    scene.warnings = {"no light"};
    std::vector<std::string> said;
    run(small(folder / "a.exr"), scene, [&](const std::string& text) { said.push_back(text); });
    EXPECT_EQ(said, std::vector<std::string>{"warning: no light"});
}

TEST(Run, WarnsOfPixelsThatAreNoNumbers) {
    const Folder folder;
    Scene scene = scene_of({object("ball", sphere(1.0f, 8))});
    scene.ambient = glm::vec3(std::numeric_limits<float>::quiet_NaN());
    std::vector<std::string> said;
    const RunRecord record =
        run(small(folder / "a.exr"), scene, [&](const std::string& text) { said.push_back(text); });
    EXPECT_EQ(said, std::vector<std::string>{
                        "warning: " + std::to_string(record.frames[0].cost.bad_pixels) +
                        " pixels are not a finite number, written as 0"});
}

TEST(Run, ResumesWithTheFramesThatAreMissing) {
    const Folder folder;
    Options options = small(folder / "#.exr");
    options.outputs.emplace_back(folder / "#.png");
    options.frames = {1, 3, 1};
    run_quietly(options);
    const std::string third = test::text_of(folder / "3.exr");
    std::filesystem::remove(folder / "2.png");
    std::filesystem::copy_file(folder / "3.exr", folder / "1.exr",
                               std::filesystem::copy_options::overwrite_existing);
    options.resume = true;
    const RunRecord record = run_quietly(options);
    ASSERT_EQ(record.frames.size(), 1u);
    EXPECT_EQ(record.frames[0].frame, 2);
    EXPECT_EQ(record.skipped, 2);
    EXPECT_TRUE(std::filesystem::exists(folder / "2.png"));
    EXPECT_EQ(test::text_of(folder / "1.exr"), third);  // untouched
    EXPECT_EQ(test::text_of(folder / "3.exr"), third);

    const RunRecord nothing = run_quietly(options);
    EXPECT_EQ(result_line(nothing), "0 frames -> " + (folder / "#.exr") + ", " +
                                        (folder / "#.png") + ", 3 frames already there");
}

TEST(Run, ResumesWholeWindowsOfTheCache) {
    const Folder folder;
    Options options = small(folder / "#.exr");
    options.frames = {1, 6, 1};
    options.strategy = Strategy::cache;
    options.window = 3;
    run_quietly(options);
    const std::vector<float> fifth = read_image(folder / "5.exr").pixels;
    std::filesystem::remove(folder / "5.exr");
    options.resume = true;
    const RunRecord record = run_quietly(options);
    ASSERT_EQ(record.frames.size(), 3u);  // 4 to 6: a frame's points are those of the ones before
    EXPECT_EQ(record.frames[0].frame, 4);
    EXPECT_TRUE(read_image(folder / "5.exr").pixels == fifth);
}

TEST(Run, GivesTheSamePicturesWindowByWindow) {
    const Folder folder;
    Options options = small(folder / "whole#.exr");
    options.frames = {1, 4, 1};
    options.strategy = Strategy::cache;
    options.window = 2;
    const RunRecord whole = run_quietly(options);
    EXPECT_EQ(whole.frames[0].cost.reuse.hits, 0u);
    EXPECT_GT(whole.frames[1].cost.reuse.hits, 0u);
    EXPECT_EQ(whole.frames[2].cost.reuse.hits, 0u);  // the second window
    options.outputs = {FilePattern(folder / "part#.exr")};
    options.frames = {3, 4, 1};
    run_quietly(options);
    const std::vector<float> part = read_image(folder / "part4.exr").pixels;
    EXPECT_FALSE(part.empty());
    EXPECT_TRUE(part == read_image(folder / "whole4.exr").pixels);
}

TEST(Run, TakesAWindowLongerThanTheAnimation) {
    const Folder folder;
    Options options = small(folder / "#.exr");
    options.frames = {1, 3, 1};
    options.strategy = Strategy::cache;
    options.window = 1000000;
    const RunRecord record = run_quietly(options);
    ASSERT_EQ(record.frames.size(), 3u);
    EXPECT_EQ(record.frames[2].cost.reuse.hits, record.frames[2].cost.samples);  // all stands still
}

TEST(Run, ChoosesByMeasurementAndSaysWhy) {
    const Folder folder;
    Options options = small(folder / "#.exr");
    options.frames = {1, 4, 1};
    options.strategy = Strategy::automatic;
    std::vector<std::string> said;
    const RunRecord record = run_quietly(options, &said);
    ASSERT_EQ(said.size(), 1u);
    EXPECT_EQ(said[0].substr(0, 12), "auto: wood: ");
    EXPECT_NE(said[0].find("that depend on the view"), std::string::npos) << said[0];
    ASSERT_TRUE(record.objects[0].choice);
    EXPECT_EQ(record.objects[0].choice->chosen, record.objects[0].strategy);
    EXPECT_GT(record.objects[0].choice->times.vi, 0.0);
    options.frames = {1, 1, 1};  // one frame, no grid: there is nothing to choose
    said.clear();
    EXPECT_EQ(run_quietly(options, &said).objects[0].strategy, Strategy::direct);
    EXPECT_EQ(said, std::vector<std::string>{});
}

TEST(Run, DoesNotTakeABrokenOrASmallerImageForDone) {
    const Folder folder;
    Options options = small(folder / "#.exr");
    options.frames = {1, 2, 1};
    run_quietly(options);
    std::ofstream(folder / "1.exr") << "";
    options.resume = true;
    EXPECT_EQ(run_quietly(options).frames.size(), 1u);
    options.frame.width += 1;
    EXPECT_EQ(run_quietly(options).frames.size(), 2u);
}

TEST(Run, LeavesNoTemporaryFile) {
    const Folder folder;
    run_quietly(small(folder / "a.exr"));
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "")) {
        EXPECT_EQ(entry.path().filename(), "a.exr");
        ++files;
    }
    EXPECT_EQ(files, 1);
}

TEST(Run, FailsBeforeRenderingWhereItCannotWrite) {
    const Folder folder;
    std::ofstream(folder / "file") << "x";
    Options options = small(folder / "file/#.exr");
    options.grids = {"this would be the next error"};
    const std::string text = error_of([&] { run_quietly(options); });
    EXPECT_NE(text.find(folder / "file"), std::string::npos) << text;
    EXPECT_EQ(text.find("next error"), std::string::npos) << text;
}

TEST(Run, FailsWhenTheDiskIsFull) {
    if (!std::filesystem::exists("/dev/full")) FAIL() << "this system has no /dev/full";
    const Folder folder;
    Options options = small(folder / "a.exr");
    options.stats = "/dev/full/stats.json";
    EXPECT_NE(error_of([&] { run_quietly(options); }), "no error");
    EXPECT_FALSE(std::filesystem::exists(folder / "a.exr"));
}

TEST(Run, ListsTheCamerasThereAre) {
    const Folder folder;
    Options options = small(folder / "a.exr");
    options.camera = "mian";
    EXPECT_EQ(error_of([&] { run_quietly(options); }),
              "test.glb: no camera 'mian'; the scene has: main");
}

TEST(Run, ComparesDirectWithItselfWithoutAnyDifference) {
    const Folder folder;
    Options options = small(folder / "#.exr");
    options.frames = {1, 2, 1};
    options.compare_direct = true;
    const RunRecord record = run_quietly(options);
    for (const FrameRecord& frame : record.frames) EXPECT_EQ(frame.error->max, 0.0);
    const std::string text = comparison_text(record);
    EXPECT_EQ(text.substr(0, text.find(" (p99.9")),
              "against direct, 2 frames: RMSE 0, p99.9 0, max 0, PSNR inf dB");
    EXPECT_NE(result_line(record).find("; against direct: RMSE 0,"), std::string::npos);
}

TEST(Run, WritesStatisticsAndReport) {
    const Folder folder;
    Options options = small(folder / "f/#.exr");
    options.outputs.emplace_back(folder / "f/a #.png");
    options.frames = {1, 2, 1};
    options.compare_direct = true;
    options.stats = folder / "stats.json";
    options.report = folder / "r/report.html";
    run_quietly(options);
    const nlohmann::json json = nlohmann::json::parse(test::text_of(options.stats));
    EXPECT_EQ(json.at("settings").at("width"), 48);
    EXPECT_EQ(json.at("objects").at(0).at("shader"), "wood");
    EXPECT_EQ(json.at("objects").at(0).at("strategy"), "direct");
    EXPECT_GT(json.at("objects").at(0).at("filter_width"), 0.0);
    EXPECT_EQ(json.at("frames").size(), 2u);
    EXPECT_EQ(json.at("frames").at(1).at("cost").at("primary_rays"), 48 * 32);
    EXPECT_EQ(json.at("frames").at(1).at("error").at("rmse"), 0.0);
    EXPECT_GT(json.at("summary").at("frame_seconds").at("median"), 0.0);
    EXPECT_GT(json.at("peak_memory_bytes"), 0);
    const std::string page = test::text_of(options.report);
    EXPECT_NE(page.find("<img src=\"../f/a%202.png\""), std::string::npos) << page;
}

}  // namespace
}  // namespace estara
