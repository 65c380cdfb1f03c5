// A scene is baked into a folder, once, and rendered with it.
#include "../programs.h"

namespace estara {
namespace {

using test::done_in;
using test::Ran;
using test::run_in;
using test::TemporaryFolder;

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++n;
    return n;
}

const std::string bake = "estara-bake scene.glb -o grids --voxel-size 0.05 --progress none ";
const std::string render =
    "estara-render scene.glb --strategy grid --frames 1 --spp 1 --resolution 64x36 -o a.png "
    "--progress none ";

TEST(SceneBake, BakesWhatIsNeededOnceAndIsRendered) {
    const TemporaryFolder folder;
    done_in(folder, "estara-scenes still-life -o scene.glb");
    const Ran first = run_in(folder, bake + "--stats s.json");
    ASSERT_EQ(first.status, 0) << first.err;
    EXPECT_EQ(first.err, "estara-bake: one colour all over, nothing to bake: plastic\n");
    EXPECT_EQ(
        test::files_under(folder / "grids"),
        (std::vector<std::string>{"cobblestone.vdb", "greenmarble.vdb", "stone.vdb", "wood.vdb"}));
    EXPECT_EQ(test::json_of(folder / "s.json").at("files").size(), 4u);

    const std::string second = done_in(folder, bake);
    EXPECT_EQ(count(second, "fresh, not baked again"), 4u) << second;

    // Folder, files, and the scene behind them: the same picture, without a warning.
    for (const std::string grids : {"--grids grids", "--grids grids/*.vdb"}) {
        const Ran ran = run_in(folder, render + grids);
        EXPECT_EQ(ran.status, 0) << ran.err;
        EXPECT_EQ(ran.err.find("warning"), std::string::npos) << ran.err;
    }
    done_in(folder,
            "estara-render --grids grids/*.vdb scene.glb --frames 1 --spp 1 "
            "--resolution 64x36 -o b.png --progress none");
}

TEST(SceneBake, BakesAgainWhatHasChangedOrIsDamaged) {
    const TemporaryFolder folder;
    done_in(folder, "estara-scenes still-life -o scene.glb");
    done_in(folder, bake);
    done_in(
        folder,
        "head -c 5000 grids/wood.vdb > x; mv x grids/wood.vdb; cp grids/stone.vdb grids/old.vdb");
    const Ran again = run_in(folder, bake + "--param greenmarble.veinfreq=3");
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(count(again.out, "fresh, not baked again"), 2u) << again.out;
    EXPECT_NE(again.err.find("wood.vdb"), std::string::npos) << again.err;
    EXPECT_NE(again.err.find("left as they are, the scene needs none of: old.vdb"),
              std::string::npos)
        << again.err;
    done_in(folder, "rm grids/old.vdb");
    // Without the parameter the grid is stale; with it, it fits.
    const Ran stale = run_in(folder, render + "--grids grids");
    EXPECT_NE(stale.err.find("baked with veinfreq=3"), std::string::npos) << stale.err;
    const Ran fits = run_in(folder, render + "--grids grids --param greenmarble.veinfreq=3");
    EXPECT_EQ(fits.status, 0);
    EXPECT_EQ(fits.err.find("warning"), std::string::npos) << fits.err;
}

}  // namespace
}  // namespace estara
