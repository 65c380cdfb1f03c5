// From a scene to pictures, as a user does it: what is baked by default looks like direct
// evaluation.
#include "../programs.h"
#include "journeys.h"

namespace estara {
namespace {

using test::done_in;
using test::Image;
using test::Journey;
using test::TemporaryFolder;

class Pictures : public ::testing::TestWithParam<Journey> {
protected:
    std::string scene_file() const {
        const Journey& j = GetParam();
        if (j.scene.find('/') != std::string::npos) return j.scene;
        if (j.scene.find('.') != std::string::npos) return test::model(j.scene);
        done_in(m_folder, "estara-scenes " + j.scene + " -o scene.glb");
        return "scene.glb";
    }

    const TemporaryFolder m_folder;
};

void expect_whole(const Image& image) {
    EXPECT_EQ(image.width(), 320);
    EXPECT_EQ(image.height(), 180);
}

void expect_channels(const Image& exr, const Image& png) {
    EXPECT_EQ(exr.channels(),
              (std::vector<std::string>{"R", "G", "B", "A", "Z", "P.X", "P.Y", "P.Z"}));
    EXPECT_EQ(exr.formats(), (std::vector<std::string>{"half", "half", "half", "half", "float",
                                                       "float", "float", "float"}));
    EXPECT_EQ(png.channels(), (std::vector<std::string>{"R", "G", "B", "A"}));
    EXPECT_EQ(png.formats(), std::vector<std::string>(4, "uint8"));
}

/// 1 where there is something, 0 where there is nothing, and never anything but numbers.
void expect_coverage(const Image& exr, bool fills_the_frame) {
    const int alpha = exr.channel("A"), depth = exr.channel("Z");
    int covered = 0;
    for (int y = 0; y < exr.height(); ++y) {
        for (int x = 0; x < exr.width(); ++x) {
            const float a = exr.at(x, y, alpha);
            EXPECT_TRUE(a >= 0.0f && a <= 1.0f) << a;
            EXPECT_EQ(a > 0.0f, exr.at(x, y, depth) > 0.0f);
            for (const float c : exr.triple(x, y, 0)) {
                EXPECT_TRUE(c >= 0.0f && c < 1000.0f) << c;
                EXPECT_TRUE(a > 0.0f || c == 0.0f) << c;
            }
            covered += a == 1.0f;
        }
    }
    const double share = covered / (320.0 * 180.0);
    if (fills_the_frame) {
        EXPECT_EQ(share, 1.0);
    } else {
        EXPECT_GT(share, 0.1);
        EXPECT_LT(share, 0.9);
        EXPECT_EQ(exr.at(0, 0, alpha), 0.0f);
    }
}

TEST_P(Pictures, OfDefaultGridsAreThoseOfDirectEvaluation) {
    const std::string scene = scene_file();
    std::string grids;
    for (std::size_t i = 0; i < GetParam().bakes.size(); ++i) {
        const std::string file = "grids" + std::to_string(i) + ".vdb";
        const std::string& words = GetParam().bakes[i];
        const std::size_t shader = words.find(' ');
        done_in(m_folder, "estara-bake " + words.substr(0, shader) + " '" + scene + "' -o " + file +
                              " --resolution 320x180 --progress none" +
                              (shader == words.npos ? "" : words.substr(shader)));
        grids += " --grids " + file;
    }
    done_in(m_folder,
            "estara-render --strategy grid '" + scene + "'" + grids + " --frames " +
                GetParam().frames +
                " --resolution 320x180 --aov P --aov depth -o 'f/####.exr' -o 'f/%04d.png'"
                " --compare direct --stats stats.json --progress none");

    const nlohmann::json stats = test::json_of(m_folder / "stats.json");
    const nlohmann::json& summary = stats.at("summary");
    EXPECT_LE(summary.at("error").at("rmse"), 0.01);
    EXPECT_EQ(summary.at("misses"), 0);
    EXPECT_EQ(summary.at("bad_pixels"), 0);
    EXPECT_GT(summary.at("lookups"), 10000);
    for (const nlohmann::json& object : stats.at("objects")) {
        EXPECT_EQ(object.at("strategy"), object.at("shader") == "plastic" ? "direct" : "grid");
    }
    for (const nlohmann::json& frame : stats.at("frames")) {
        ASSERT_EQ(frame.at("files").size(), 2u);
        const Image exr(m_folder / std::string(frame.at("files").at(0)));
        const Image png(m_folder / std::string(frame.at("files").at(1)));
        expect_whole(exr);
        expect_whole(png);
        expect_channels(exr, png);
        expect_coverage(exr, GetParam().fills_the_frame);
    }
}

INSTANTIATE_TEST_SUITE_P(From, Pictures, ::testing::ValuesIn(test::journeys()),
                         [](const auto& named) { return named.param.name; });

}  // namespace
}  // namespace estara
