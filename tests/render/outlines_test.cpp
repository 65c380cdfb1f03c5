// Outlines between neighbouring points, and what weights samples that lie off the pattern.
#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <string>

#include "estara/render/sampling.h"
#include "outlines.h"

namespace estara {
namespace {

struct Point {
    int instance;
    glm::vec3 P, Ng;
};

/// The outlines of a raster, a row a string: # at an outline.
std::vector<std::string> outlines(int width, int height,
                                  const std::function<Point(int, int)>& point) {
    OutlineFinder finder;
    std::vector<std::string> rows;
    std::vector<std::uint8_t> row(static_cast<std::size_t>(width));
    const auto note = [&] {
        rows.emplace_back();
        for (const std::uint8_t at : row) rows.back() += at != 0 ? '#' : '.';
    };
    finder.start(width);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Point p = point(x, y);
            if (p.instance != OutlineFinder::none) finder.set(x, p.instance, p.P, p.Ng);
        }
        finder.next(row.data());
        if (y > 0) note();
    }
    finder.finish(row.data());
    note();
    return rows;
}

const glm::vec3 z_axis(0, 0, 1);
using Rows = std::vector<std::string>;

TEST(OutlineFinder, FindsNoneOnAPlaneHoweverItIsSeen) {
    for (const float slope : {0.0f, 1.0f, 100.0f}) {
        const glm::vec3 n = glm::normalize(glm::vec3(-slope, 0, 1));
        EXPECT_EQ(outlines(5, 3,
                           [&](int x, int y) {
                               return Point{0, {float(x), float(y), slope * float(x)}, n};
                           }),
                  Rows(3, "....."))
            << slope;
    }
}

TEST(OutlineFinder, FindsBothSidesOfAnEdgeBetweenInstances) {
    EXPECT_EQ(outlines(6, 3,
                       [](int x, int y) {
                           return Point{x < 3 ? 4 : 7, {float(x), float(y), 0}, z_axis};
                       }),
              Rows(3, "..##.."));
    EXPECT_EQ(outlines(4, 4,
                       [](int x, int y) {
                           return Point{y < 2 ? 4 : 7, {float(x), float(y), 0}, z_axis};
                       }),
              (Rows{"....", "####", "####", "...."}));
}

TEST(OutlineFinder, FindsStepsAndCreasesOfOneInstance) {
    EXPECT_EQ(outlines(6, 1,
                       [](int x, int) {
                           return Point{0, {float(x), 0, x < 3 ? 0.0f : 2.0f}, z_axis};
                       }),
              Rows(1, "..##.."));
    const glm::vec3 side(1, 0, 0);
    EXPECT_EQ(outlines(6, 1,
                       [&](int x, int) {
                           return x < 3 ? Point{0, {float(x), 0, 0}, z_axis}
                                        : Point{0, {3, 0, float(2 - x)}, side};
                       }),
              Rows(1, "..##.."));
}

TEST(OutlineFinder, TakesWhatIsNextToNoPointForAnOutline) {
    const Rows rows = outlines(5, 5, [](int x, int y) {
        return Point{x == 2 && y == 2 ? OutlineFinder::none : 0, {float(x), float(y), 0}, z_axis};
    });
    EXPECT_EQ(rows[0], ".....");
    EXPECT_EQ(rows[1], "..#..");
    EXPECT_EQ(rows[2].substr(0, 2), ".#");
    EXPECT_EQ(rows[3], "..#..");
    EXPECT_EQ(rows[4], ".....");
}

TEST(Slant, TakesTheMeanPlaceOfScatteredSamplesToThePatternsOwn) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> some(0.0f, 1.0f);
    for (int trial = 0; trial < 1000; ++trial) {
        constexpr int n = 16;
        std::vector<glm::vec2> places;
        for (int i = 0; i < n; ++i) {  // anywhere in their rectangles
            places.emplace_back((float(i % 4) + some(random)) / 4.0f,
                                (float(i / 4) + some(random)) / 4.0f);
        }
        const PlaceMoments samples = moments_of(places);
        const glm::vec2 g = slant(samples, glm::vec2(0.0f));
        glm::vec2 mean(0.0f);
        float sum = 0.0f, least = 1.0f;
        for (const glm::vec2& place : places) {
            const glm::vec2 x = place - 0.5f;
            const float weight = (1.0f - glm::dot(g, x - samples.mean)) / float(n);
            mean += weight * x;
            sum += weight;
            least = std::min(least, weight);
        }
        EXPECT_NEAR(sum, 1.0f, 1e-5f);
        EXPECT_GE(least, 0.0f);
        // The added bit of covariance leaves 1.3 % of the shift.
        EXPECT_LT(glm::length(mean), 0.02f * glm::length(samples.mean) + 1e-3f);
    }
}

TEST(Slant, IsNothingForOneSampleAndKeepsWeightsPositive) {
    const PlaceMoments one = moments_of(std::vector<glm::vec2>{{0.9f, 0.2f}});
    const glm::vec2 g = slant(one, glm::vec2(0.0f));
    EXPECT_LE(std::abs(g.x) * 0.5f + std::abs(g.y) * 0.5f, 1.0f);
    EXPECT_EQ(slant(one, one.mean), glm::vec2(0.0f));
    // All in one corner: whatever the lean, no sample counts less than nothing.
    const std::vector<glm::vec2> corner{{0.9f, 0.9f}, {0.95f, 0.9f}, {0.9f, 0.97f}};
    const PlaceMoments crowded = moments_of(corner);
    const glm::vec2 lean = slant(crowded, glm::vec2(0.0f));
    for (const glm::vec2& place : corner) {
        EXPECT_GE(1.0f - glm::dot(lean, place - 0.5f - crowded.mean), 0.0f);
    }
}

}  // namespace
}  // namespace estara
