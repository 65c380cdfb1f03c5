#include "estara/render/options.h"

#include <gtest/gtest.h>

#include "small_scene.h"

namespace estara {
namespace {

using test::error_of;

Options parse(std::vector<const char*> words, std::string* help_text = nullptr) {
    words.insert(words.begin(), "estara-render");
    std::string help;
    Options options = parse_options(int(words.size()), words.data(), help);
    if (help_text != nullptr) *help_text = help;
    return options;
}

std::string error_with(std::vector<const char*> more) {
    std::vector<const char*> words{"a.glb", "-o", "#.exr"};
    words.insert(words.end(), more.begin(), more.end());
    return error_of([&] { parse(words); });
}

TEST(Options, DefaultsAreThoseOfTheStruct) {
    const Options options = parse({"a.glb", "-o", "#.exr"});
    EXPECT_EQ(options.scene, "a.glb");
    ASSERT_EQ(options.outputs.size(), 1u);
    EXPECT_EQ(options.strategy, Strategy::automatic);
    EXPECT_EQ(options.cache_memory, std::uint64_t{2} << 30);
    EXPECT_EQ(options.window, 100);
    EXPECT_FALSE(options.cache_light);
    EXPECT_EQ(options.frame.width, 640);
    EXPECT_EQ(options.frame.height, 360);
    EXPECT_EQ(options.frame.spp, 4);
    EXPECT_FALSE(options.fps);
    EXPECT_FALSE(options.frames || options.ambient || options.resume || options.compare_direct);
}

TEST(Options, AreReadAsWritten) {
    const Options options =
        parse({"--grids",   "a.vdb",    "a.glb",      "-o",           "#.exr",       "-o",
               "#.png",     "--grids",  "b.vdb",      "--aov",        "N",           "--aov",
               "depth",     "--frames", "3-9x2",      "--resolution", "32x16",       "--spp",
               "7",         "--camera", "side",       "--exposure",   "-1.5",        "--ambient",
               "1,0.5,0",   "--shader", "wood",       "--param",      "ringscale=3", "--resume",
               "--compare", "direct",   "--strategy", "grid",         "--seed",      "5",
               "--threads", "2",        "--progress", "none"});
    EXPECT_EQ(options.scene, "a.glb");
    EXPECT_EQ(options.grids, (std::vector<std::string>{"a.vdb", "b.vdb"}));
    EXPECT_EQ(options.outputs.size(), 2u);
    EXPECT_TRUE(options.frame.aovs.normal && options.frame.aovs.depth);
    EXPECT_FALSE(options.frame.aovs.albedo || options.frame.aovs.position);
    EXPECT_EQ(options.frames->count(), 4);
    EXPECT_EQ(options.frame.width, 32);
    EXPECT_EQ(options.frame.height, 16);
    EXPECT_EQ(options.frame.spp, 7);
    EXPECT_EQ(options.camera, "side");
    EXPECT_EQ(options.frame.exposure, -1.5f);
    EXPECT_EQ(*options.ambient, glm::vec3(1.0f, 0.5f, 0.0f));
    EXPECT_EQ(options.shader, "wood");
    EXPECT_EQ(options.params.at(0).name, "ringscale");
    EXPECT_TRUE(options.resume && options.compare_direct);
    EXPECT_EQ(options.strategy, Strategy::grid);
    EXPECT_EQ(options.frame.seed, 5u);
    EXPECT_EQ(options.threads, 2);
    EXPECT_EQ(options.progress, ProgressStyle::none);
}

TEST(Options, HelpShowsDefaultsAndEndsInTwoExamples) {
    std::string help;
    parse({"--help"}, &help);
    for (const char* part :
         {"640x360", "Examples:", "--compare direct", "--strategy NAME=auto", "--window N=100",
          "(default: 2.0 GiB)", "--spp N=4", "--fps N", "--progress STYLE=auto"}) {
        EXPECT_NE(help.find(part), std::string::npos) << part << " is not in\n" << help;
    }
    EXPECT_GT(help.find("Examples:"), help.find("--threads"));
}

TEST(Options, OfTheCacheAreReadAsWritten) {
    const Options options =
        parse({"a.glb", "-o", "#.exr", "--strategy", "cache", "--window", "12", "--cache-memory",
               "64M", "--cache-light", "off", "--aov", "hit", "--aov", "age", "--aov", "occluded"});
    EXPECT_EQ(options.strategy, Strategy::cache);
    EXPECT_EQ(options.window, 12);
    EXPECT_EQ(options.cache_memory, std::uint64_t{64} << 20);
    EXPECT_EQ(options.cache_light, std::optional<bool>(false));
    EXPECT_TRUE(options.frame.aovs.hit && options.frame.aovs.age && options.frame.aovs.occluded);
}

TEST(Options, WrongValuesSayWhatThereIs) {
    EXPECT_EQ(error_with({"--strategy", "grd"}),
              "--strategy: no 'grd'; there are: auto, grid, cache, direct");
    EXPECT_EQ(error_with({"--compare", "grid"}), "--compare: no 'grid'; there is: direct");
    EXPECT_EQ(error_with({"--compare", "direct", "--strategy", "direct"}),
              "--compare direct needs another strategy than direct to compare it with");
    EXPECT_EQ(error_with({"--window", "0"}), "--window 0: must be from 1 to 1048575");
    EXPECT_EQ(error_with({"--cache-light", "maybe"}),
              "--cache-light: no 'maybe'; there are: auto, on, off");
    EXPECT_EQ(error_with({"--ambient=-1,0,0"}), "--ambient -1,0,0: must not be negative");
    EXPECT_EQ(error_with({"--stats", "same.json", "--report", "./same.json"}),
              "--stats same.json and --report ./same.json are the same file");
    EXPECT_EQ(error_with({"--aov", "normal"}),
              "--aov: no 'normal'; there are: albedo, N, P, depth, hit, age, occluded");
    EXPECT_EQ(error_with({"--spp", "0"}), "--spp 0: must be from 1 to 65536");
    EXPECT_EQ(error_with({"--fps", "0"}), "--fps 0: must be above 0");
    EXPECT_EQ(error_with({"--fps", "nan"}), "--fps nan: must be above 0");
    EXPECT_EQ(error_with({"--exposure", "nan"}), "--exposure nan: must be from -100 to 100");
    EXPECT_EQ(error_with({"--threads", "-1"}), "--threads -1: must be from 0 to 4096");
    EXPECT_EQ(error_with({"-o", "#.tif"}), "-o #.tif: the name must end in .exr or .png");
    EXPECT_EQ(error_with({"-o", "#.exr"}), "-o #.exr: given twice");
    EXPECT_EQ(error_with({"--param", "ringscale=3"}),
              "--param NAME=VALUE needs --shader; of the shaders in the scene it is --param "
              "SHADER.NAME=VALUE");
}

TEST(Options, UnknownOnesAndMissingOnesPointToHelp) {
    EXPECT_EQ(error_with({"--gridz", "a.vdb"}),
              "no option --gridz (did you mean --grids?); --help lists the options");
    EXPECT_EQ(error_with({"--colour"}), "no option --colour; --help lists the options");
    EXPECT_EQ(error_with({"b.glb"}), "one word too many: 'b.glb'; --help lists the options");
    EXPECT_EQ(error_with({"--spp", "many"}),
              "--spp = many: not a number in its range; --help lists the options");
    EXPECT_EQ(error_of([] {
                  parse({"-o", "#.exr"});
              }),
              "SCENE is required; --help lists the options");
    EXPECT_EQ(error_of([] { parse({"a.glb"}); }), "--output is required; --help lists the options");
}

TEST(Options, AovsNeedAnExr) {
    EXPECT_EQ(error_of([] {
                  parse({"a.glb", "-o", "#.png", "--aov", "N"});
              }),
              "--aov needs an .exr output: PNG holds the colour only");
}

TEST(Options, SeveralFramesNeedANumberInTheName) {
    const Options options = parse({"a.glb", "-o", "one.exr"});
    EXPECT_EQ(error_of([&] { check_outputs(options, {1, 1, 1}); }), "no error");
    EXPECT_EQ(error_of([&] {
                  check_outputs(options, {1, 9, 2});
              }),
              "-o one.exr: 5 frames need a number in the name, as in frames/####.exr or "
              "frames/%04d.exr");
}

}  // namespace
}  // namespace estara
