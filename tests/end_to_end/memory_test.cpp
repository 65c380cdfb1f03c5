// A bake stays within the memory that --max-memory is checked against.
#include "../programs.h"

namespace estara {
namespace {

/// The smallest --max-memory in MiB that a bake is let start with: its own estimate.
int estimated_mib(const test::TemporaryFolder& folder, const std::string& bake) {
    int low = 0, high = 4096;  // low is refused, high is not
    while (high - low > 8) {
        const int middle = (low + high) / 2;
        const test::Ran ran =
            test::run_in(folder, bake + " --dry-run --max-memory " + std::to_string(middle) + "M");
        (ran.status == 0 ? high : low) = middle;
    }
    return high;
}

TEST(Memory, OfABakeIsNoMoreThanEstimated) {
    const test::TemporaryFolder folder;
    const std::string scan = test::model("scan.obj");
    for (const std::string shader : {"greenmarble", "wood"}) {  // three floats and four
        const std::string bake =
            "estara-bake " + shader + " " + scan + " --voxel-size 0.0003 --progress none";
        test::done_in(folder, bake + " -o a.vdb --stats a.json");
        const double peak = test::json_of(folder / "a.json").at("peak_memory").get<double>();
        const double estimate = estimated_mib(folder, bake) * 1048576.0;
        constexpr double program_and_mesh = 100.0 * 1048576.0;  // what the estimate leaves out
        EXPECT_LT(peak, estimate + program_and_mesh) << shader;
        EXPECT_GT(peak, 0.5 * estimate) << shader;  // nor is the estimate of no use
    }
}

}  // namespace
}  // namespace estara
