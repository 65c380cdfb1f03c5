// What a user types wrong, and what estara-bake answers.
#include "estara/bake/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "estara/bake/run.h"
#include "estara/scenes/error.h"
#include "estara/shaders/registry.h"

namespace estara::bake {
namespace {

Options parsed(std::vector<const char*> words, std::string* help = nullptr) {
    words.insert(words.begin(), "estara-bake");
    std::string text;
    const Options options = parse_options(int(words.size()), words.data(), text);
    if (help != nullptr) *help = text;
    return options;
}

std::string failure(const std::vector<const char*>& words) {
    try {
        const Options options = parsed(words);
        run(options, {[](const std::string&) {}, [](const std::string&) {}});
        return "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.status(), ExitStatus::bad_input);
        return error.what();
    }
}

TEST(Options, ReadWhatHelpPromises) {
    const Options o = parsed({"wood",
                              "a.glb",
                              "-o",
                              "b.vdb",
                              "--param",
                              "ringscale=3",
                              "--param",
                              "lightwood=.1,.2,.3",
                              "--object",
                              "v*",
                              "--object",
                              "w",
                              "--voxel-size",
                              "0.5",
                              "--frames",
                              "3-9x2",
                              "--resolution",
                              "320x200",
                              "--max-memory",
                              "2G",
                              "--compression",
                              "none",
                              "--half",
                              "--threads",
                              "3",
                              "--seed",
                              "9"});
    EXPECT_EQ(o.shader, "wood");
    EXPECT_EQ(o.scene, "a.glb");
    EXPECT_EQ(o.output, "b.vdb");
    ASSERT_EQ(o.params.size(), 2u);
    EXPECT_EQ(o.params[1].value, (std::vector<float>{0.1f, 0.2f, 0.3f}));
    EXPECT_EQ(o.objects, (std::vector<std::string>{"v*", "w"}));
    EXPECT_EQ(o.voxel_size, 0.5);
    EXPECT_EQ(o.frames->count(), 4);
    EXPECT_EQ(o.resolution, glm::ivec2(320, 200));
    EXPECT_EQ(o.max_memory, std::uint64_t{2} << 30);
    EXPECT_EQ(o.file.compression, Compression::none);
    EXPECT_TRUE(o.file.half);
    EXPECT_EQ(o.threads, 3);
    EXPECT_EQ(o.seed, 9u);
}

TEST(Options, HelpNamesEveryOptionOfTheDesign) {
    std::string help;
    (void)parsed({"--help"}, &help);
    for (const char* option :
         {"--param", "--object", "--voxel-size", "--max-error", "--frames", "--resolution",
          "--max-memory", "--compression", "--half", "--dry-run", "--stats", "--threads",
          "--progress", "--seed", "--list-shaders", "--describe", "-o,--output", "Examples:"}) {
        EXPECT_THAT(help, testing::HasSubstr(option));
    }
}

TEST(Options, AnswerMistakesInOneLine) {
    EXPECT_EQ(failure({}),
              "give a shader and a scene: estara-bake SHADER SCENE -o FILE.vdb, or a scene alone: "
              "estara-bake SCENE -o FOLDER; --help explains");
    EXPECT_EQ(failure({"wood", "a.glb"}),
              "where to? give -o FILE.vdb (or --dry-run to see what a bake would cost)");
    EXPECT_EQ(failure({"wood", "a.glb", "-o", "a.txt"}),
              "a.txt: grids are written as .vdb; give the name that ending");
    EXPECT_EQ(failure({"wodo", "a.glb", "-o", "a.vdb"}),
              "no shader 'wodo'; there are: " + shader_names());
    EXPECT_EQ(failure({"woood", "a.glb", "-o", "a.vdb"}),
              "no shader 'woood'; did you mean 'wood'? there are: " + shader_names());
    EXPECT_EQ(failure({"--describe", "ston"}),
              "no shader 'ston'; did you mean 'stone'? there are: " + shader_names());
    EXPECT_EQ(
        failure({"wood", "a.glb", "-o", "a.vdb", "--voxel-size", "1", "--max-error", "1"}),
        "--voxel-size and --max-error exclude each other: one sets the voxel, the other finds it");
    EXPECT_EQ(failure({"wood", "a.glb", "-o", "a.vdb", "--voxel-size", "-1"}),
              "--voxel-size -1: must be above 0");
    EXPECT_EQ(failure({"wood", "a.glb", "-o", "a.vdb", "--max-error", "nan"}),
              "--max-error nan: must be above 0");
    EXPECT_EQ(failure({"wood", "a.glb", "-o", "a.vdb", "--compression", "lzma"}),
              "--compression: no 'lzma'; there are: zip, blosc, none");
    EXPECT_THAT(failure({"wood", "a.glb", "-o", "a.vdb", "--voxelsize", "1"}),
                testing::HasSubstr("--voxelsize"));
}

TEST(Options, ListTheShadersAsTheReadmeDoes) {
    std::ifstream file(ESTARA_README);
    const std::string readme{std::istreambuf_iterator<char>(file), {}};
    std::string table;
    run(parsed({"--list-shaders", "--markdown"}),
        {[&](const std::string& text) { table = text; }, [](const std::string&) {}});
    EXPECT_THAT(readme, testing::HasSubstr("<!-- shaders -->\n" + table + "<!-- /shaders -->"));
}

}  // namespace
}  // namespace estara::bake
