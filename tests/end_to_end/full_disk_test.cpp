// What cannot be written whole is not written at all, is told, and leaves what was there.
#include "../programs.h"

namespace estara {
namespace {

using test::done_in;
using test::Ran;
using test::run_in;
using test::TemporaryFolder;

struct Output {
    std::string name;
    std::string command;  ///< writes the file
    std::string file;

    friend void PrintTo(const Output& o, std::ostream* out) { *out << o.name; }
};

std::vector<Output> outputs() {
    const std::string render =
        "estara-render scene.glb --spp 1 --strategy direct --progress none --frames ";
    const std::string tiny = "1-48 --resolution 8x8 -o 'f/#.png' ";  // images smaller than the text
    return {
        {"Png", render + "1 --resolution 320x180 -o a.png", "a.png"},
        {"Exr", render + "1 --resolution 320x180 -o a.exr", "a.exr"},
        {"Stats", render + tiny + "--stats a.json", "a.json"},
        {"Report", render + tiny + "--report a.html", "a.html"},
        {"Vdb", "estara-bake wood scene.glb --voxel-size 0.1 --progress none -o a.vdb", "a.vdb"},
        {"Scene", "estara-scenes tumble -o a.glb", "a.glb"},
    };
}

class FullDisk : public ::testing::TestWithParam<Output> {};

// A limit on the size of files stands for the disk: a write fails half way.
TEST_P(FullDisk, KeepsTheOldFileAndSaysSo) {
    const Output& o = GetParam();
    const TemporaryFolder folder;
    done_in(folder, "estara-scenes tumble -o scene.glb");
    done_in(folder, o.command + " > log");
    const auto size = std::filesystem::file_size(folder / o.file);
    const auto before = test::files_under(folder.path());
    done_in(folder, "printf old > '" + o.file + "'");
    // Of 1024 bytes in bash; others' outputs of the same command must fit.
    const std::string limit = std::to_string(std::max<std::uintmax_t>(1, size / 2048));
    const Ran ran = run_in(folder, "ulimit -f " + limit + "\n" + o.command);
    EXPECT_EQ(ran.status, 1) << ran.err;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
    EXPECT_NE(ran.err.find(o.file), std::string::npos) << ran.err;
    EXPECT_EQ(test::text_of(folder / o.file), "old");
    EXPECT_EQ(test::files_under(folder.path()), before) << "a temporary file was left";
}

INSTANTIATE_TEST_SUITE_P(Of, FullDisk, ::testing::ValuesIn(outputs()),
                         [](const auto& named) { return named.param.name; });

}  // namespace
}  // namespace estara
