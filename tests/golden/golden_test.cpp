// Pictures look as they did: tests/golden/NAME/command makes picture.exr, which must be golden.exr.
// ESTARA_UPDATE=1 writes golden.exr anew: look at what it has written.
#include <cstdlib>

#include "../programs.h"
#include "../shapes.h"

namespace estara {
namespace {

using test::Image;
using test::TemporaryFolder;

// As idiff -fail 0.004 -failpercent 0.02 -hardfail 0.012. Embree's hit points differ in their last
// bits between instruction sets, so a sample near an edge may fall on its other side. That is one
// of 64 samples of a pixel: 1/64 of the contrast of the edge, measured up to 0.0075 in one pixel.
constexpr float fail = 0.004f;
constexpr double fail_share = 0.0002, hard_fail = 0.012;

class Golden : public ::testing::TestWithParam<std::string> {};

TEST_P(Golden, PictureHasNotChanged) {
    const std::string folder = std::string(ESTARA_CASES) + "/" + GetParam();
    const TemporaryFolder temporary;
    test::write_sphere(temporary / "sphere.obj");
    test::done_in(temporary, test::text_of(folder + "/command"));
    const std::string picture = temporary / "picture.exr", golden = folder + "/golden.exr";
    if (std::getenv("ESTARA_UPDATE") != nullptr) {
        std::filesystem::copy_file(picture, golden,
                                   std::filesystem::copy_options::overwrite_existing);
    }
    ASSERT_TRUE(std::filesystem::exists(golden)) << golden << ": ESTARA_UPDATE=1 writes it";
    const test::Difference d = test::difference(Image(picture), Image(golden), fail);
    const char* advice = "if that is meant, write it anew with ESTARA_UPDATE=1 and look at it";
    EXPECT_LE(d.share, fail_share)
        << "of the pixels differ by more than " << fail << "; " << advice;
    EXPECT_LE(d.max, hard_fail) << advice;
}

INSTANTIATE_TEST_SUITE_P(Pictures, Golden, ::testing::ValuesIn(test::cases_in(ESTARA_CASES)),
                         [](const auto& named) { return named.param; });

}  // namespace
}  // namespace estara
