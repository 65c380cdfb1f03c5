#include "estara/shaders/spline.h"

#include <gtest/gtest.h>

#include <limits>

#include "reference.h"
#include "sampling.h"

namespace estara {
namespace {

constexpr std::array<float, 4> four{0.3f, 0.2f, 0.9f, 0.1f};
constexpr std::array<float, 13> thirteen{0.9f, 0.1f, 0.5f, 0.5f, 0.0f, 1.0f, 0.2f,
                                         0.8f, 0.8f, 0.3f, 0.4f, 0.7f, 0.6f};

template <std::size_t n>
void expect_knots(const std::array<float, n>& knots) {
    const int spans = int(n) - 3;
    for (int i = 0; i <= spans; ++i) {
        // i / spans is rounded: off by half an ulp, times a slope below 2 per span.
        EXPECT_NEAR(spline(float(i) / float(spans), knots), knots[std::size_t(i) + 1], 3e-6);
    }
}

template <std::size_t n>
void expect_reference(const std::array<float, n>& knots) {
    const std::vector<double> exact(knots.begin(), knots.end());
    for (int i = -100; i <= 10100; ++i) {
        const float x = float(i) / 10000.0f;
        ASSERT_NEAR(spline(x, knots), reference::spline(x, exact), 3e-6) << x;
    }
}

TEST(Spline, GoesThroughItsInnerKnots) {
    expect_knots(four);
    expect_knots(thirteen);
}

TEST(Spline, IsTheReferenceEverywhere) {
    expect_reference(four);
    expect_reference(thirteen);
}

TEST(Spline, StaysAtItsEndsBeyondThem) {
    const float infinity = std::numeric_limits<float>::infinity();
    for (const float x : {0.0f, -0.0f, -0.1f, -1e30f, -infinity}) {
        EXPECT_EQ(spline(x, thirteen), thirteen[1]) << x;
    }
    for (const float x : {1.0f, 1.1f, 1e30f, infinity}) {
        EXPECT_NEAR(spline(x, thirteen), thirteen[11], 1e-6) << x;
    }
}

TEST(Spline, AndItsSlopeHaveNoStepAtAKnot) {
    const float h = 1e-3f;
    for (int i = 1; i < 10; ++i) {
        const float x = float(i) / 10.0f;
        const float before = spline(x - h, thirteen), at = spline(x, thirteen);
        const float after = spline(x + h, thirteen);
        EXPECT_NEAR(before, at, 0.02f) << x;
        EXPECT_NEAR(after, at, 0.02f) << x;
        EXPECT_NEAR((at - before) / h, (after - at) / h, 0.6f) << x;  // second derivative below 500
    }
}

TEST(Spline, OfEqualKnotsIsConstant) {
    constexpr std::array<float, 5> flat{0.7f, 0.7f, 0.7f, 0.7f, 0.7f};
    for (int i = 0; i <= 100; ++i) EXPECT_NEAR(spline(float(i) / 100.0f, flat), 0.7f, 2e-7f);
}

// Not a fault: what colours are clamped for.
TEST(Spline, OvershootsAfterASteepKnot) {
    constexpr std::array<float, 6> steep{1.0f, 1.0f, 0.0f, 0.0f, 0.0f, 0.0f};
    float lowest = 0.0f;
    for (int i = 0; i <= 1000; ++i) lowest = std::min(lowest, spline(float(i) / 1000.0f, steep));
    EXPECT_NEAR(lowest, -2.0f / 27.0f, 1e-4f);  // the least value of -t (1 - t)^2 / 2, at t = 1/3
}

TEST(Spline, OfColoursIsTheSplineOfEachComponent) {
    const std::array<glm::vec3, 5> colors{glm::vec3{0.1f, 0.2f, 0.3f},
                                          {0.9f, 0.1f, 0.4f},
                                          {0.3f, 0.8f, 0.2f},
                                          {0.6f, 0.6f, 0.7f},
                                          {0.5f, 0.0f, 0.9f}};
    for (int c = 0; c < 3; ++c) {
        std::array<float, 5> knots{};
        for (std::size_t i = 0; i < 5; ++i) knots[i] = colors[i][c];
        for (int i = 0; i <= 100; ++i) {
            EXPECT_EQ(spline(float(i) / 100.0f, colors)[c], spline(float(i) / 100.0f, knots));
        }
    }
}

}  // namespace
}  // namespace estara
