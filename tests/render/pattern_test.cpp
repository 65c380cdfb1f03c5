#include <gtest/gtest.h>

#include "estara/render/file_pattern.h"
#include "estara/render/sampling.h"
#include "small_scene.h"

namespace estara {
namespace {

using test::error_of;

TEST(FilePattern, FillsHashesAndPercentD) {
    EXPECT_EQ(FilePattern("frames/####.exr").path(7), "frames/0007.exr");
    EXPECT_EQ(FilePattern("a.%04d.png").path(12), "a.0012.png");
    EXPECT_EQ(FilePattern("a%d.png").path(12), "a12.png");
    EXPECT_EQ(FilePattern("##/##.png").path(123), "123/123.png");
    EXPECT_EQ(FilePattern("####.png").path(-3), "-003.png");
    EXPECT_EQ(FilePattern("one.exr").path(5), "one.exr");
}

TEST(FilePattern, KnowsWhetherFramesGetDifferentNames) {
    EXPECT_TRUE(FilePattern("#.exr").is_numbered());
    EXPECT_TRUE(FilePattern("%d.exr").is_numbered());
    EXPECT_FALSE(FilePattern("one.exr").is_numbered());
}

TEST(FilePattern, KnowsTheFormatByTheEnding) {
    EXPECT_EQ(FilePattern("a.EXR").format(), ImageFormat::exr);
    EXPECT_EQ(FilePattern("a.b.png").format(), ImageFormat::png);
}

TEST(FilePattern, RefusesOtherEndings) {
    EXPECT_EQ(error_of([] { FilePattern("a.jpg"); }),
              "-o a.jpg: the name must end in .exr or .png");
    EXPECT_EQ(error_of([] { FilePattern("frames"); }),
              "-o frames: the name must end in .exr or .png");
}

TEST(FilePattern, RefusesAPercentThatIsNoNumber) {
    for (const std::string bad : {"50%.png", "%s.png", "%0.png", "%5d.png", "%099d.png"}) {
        EXPECT_EQ(error_of([&] { FilePattern{bad}; }),
                  "-o " + bad + ": a % must be %d or %0Nd with N up to 20, as in %04d");
    }
}

TEST(SamplePattern, OneSampleIsTheCentreForAnySeed) {
    for (const unsigned seed : {0u, 1u, 77u}) {
        ASSERT_EQ(sample_pattern(1, seed).size(), 1u);
        EXPECT_EQ(sample_pattern(1, seed)[0], glm::vec2(0.5f));
    }
}

TEST(SamplePattern, LiesInsideThePixelWithItsMeanNearTheCentre) {
    for (const int spp : {2, 3, 4, 5, 16, 64, 100}) {
        for (const unsigned seed : {0u, 1u, 4294967295u}) {
            glm::vec2 mean(0.0f);
            for (const glm::vec2& p : sample_pattern(spp, seed)) {
                EXPECT_TRUE(p.x >= 0.0f && p.x < 1.0f && p.y >= 0.0f && p.y < 1.0f);
                mean += p / float(spp);
            }
            // A shift around the edge moves the mean by at most half the distance of two samples
            // in x; in y sets that are no power of 2 have gaps twice as wide.
            EXPECT_LE(std::abs(mean.x - 0.5f), 0.5f / float(spp) + 1e-5f) << spp << " " << seed;
            EXPECT_LE(std::abs(mean.y - 0.5f), 1.0f / float(spp) + 1e-5f) << spp << " " << seed;
        }
    }
}

TEST(SamplePattern, IsCentredExactlyForPowersOfTwo) {
    for (const int spp : {2, 4, 16, 64}) {
        glm::vec2 mean(0.0f);
        for (const glm::vec2& p : sample_pattern(spp, 0)) mean += p / float(spp);
        EXPECT_EQ(mean, glm::vec2(0.5f)) << spp;
    }
}

TEST(SamplePattern, PutsOneSampleInEachRowAndColumn) {
    for (const unsigned seed : {0u, 9u}) {
        std::vector<int> rows(16), columns(16);
        for (const glm::vec2& p : sample_pattern(16, seed)) {
            ++columns[std::size_t(p.x * 16.0f)];
            ++rows[std::size_t(p.y * 16.0f)];
        }
        EXPECT_EQ(columns, std::vector<int>(16, 1)) << seed;
        EXPECT_EQ(rows, std::vector<int>(16, 1)) << seed;
    }
}

TEST(SamplePattern, ChangesWithTheSeed) {
    EXPECT_NE(sample_pattern(4, 1), sample_pattern(4, 2));
    EXPECT_EQ(sample_pattern(4, 1), sample_pattern(4, 1));
}

}  // namespace
}  // namespace estara
