// Voronoi cells against the double reference and its reference figures.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "estara/shaders/noise.h"
#include "reference.h"
#include "sampling.h"

namespace estara {
namespace {

TEST(Voronoi, HasTheReferenceDistances) {
    test::Random random(1);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 p = random.point(20.0f);
        const float jitter = random.unit();
        const Voronoi<glm::vec2> flat = voronoi(glm::vec2(p), jitter);
        const Voronoi<glm::vec3> solid = voronoi(p, jitter);
        const reference::Voronoi exact_flat = reference::voronoi(p, 2, jitter);
        const reference::Voronoi exact_solid = reference::voronoi(p, 3, jitter);
        ASSERT_NEAR(flat.f1, exact_flat.f1, 4e-6);  // coordinates up to 20, so 2^-19 at most
        ASSERT_NEAR(flat.f2, exact_flat.f2, 4e-6);
        ASSERT_NEAR(solid.f1, exact_solid.f1, 4e-6);
        ASSERT_NEAR(solid.f2, exact_solid.f2, 4e-6);
    }
}

struct Figures {
    float jitter;
    double f1, border, stone;
};

TEST(Voronoi, HasTheReferenceMeansInTwoDimensions) {
    for (const Figures& known :
         {Figures{1.0f, 0.430, 0.269, 0.876}, Figures{0.5f, 0.397, 0.305, 0.892}}) {
        test::Random random(2);
        test::Sample f1, border, stone;
        for (int i = 0; i < 200000; ++i) {
            const glm::vec3 p = random.point(500.0f);
            const Voronoi<glm::vec2> v = voronoi(glm::vec2(p), known.jitter);
            f1.add(v.f1);
            border.add(v.f2 - v.f1);
            stone.add(smoothstep(0.03f, 0.07f, v.f2 - v.f1));
        }
        EXPECT_NEAR(f1.mean(), known.f1, 0.002) << "jitter " << known.jitter;
        EXPECT_NEAR(border.mean(), known.border, 0.002) << "jitter " << known.jitter;
        EXPECT_NEAR(stone.mean(), known.stone, 0.003) << "jitter " << known.jitter;
    }
}

TEST(Voronoi, FindsThePointThatIsNearest) {
    test::Random random(3);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 p = random.point(20.0f);
        const Voronoi<glm::vec3> v = voronoi(p, 1.0f);
        const glm::vec3 d = v.feature1 - p;
        ASSERT_NEAR(std::sqrt(glm::dot(d, d)), v.f1, 1e-6f);
        ASSERT_LE(v.f1, v.f2);
    }
}

TEST(Voronoi, WithoutJitterIsTheLatticeOfCellCentres) {
    const Voronoi<glm::vec2> flat = voronoi(glm::vec2(-2.3f, 5.6f), 0.0f);
    EXPECT_EQ(flat.feature1, glm::vec2(-2.5f, 5.5f));
    EXPECT_NEAR(flat.f1, std::hypot(0.2, 0.1), 1e-6);
    EXPECT_NEAR(flat.f2, std::hypot(0.8, 0.1), 1e-6);
    EXPECT_EQ(voronoi(glm::vec3(0.4f, -0.3f, 7.7f), 0.0f).feature1, glm::vec3(0.5f, -0.5f, 7.5f));
}

// The window of 3 cells moves with the point's cell, and a nearer point may hide outside it: the
// accepted seams. They are rare.
TEST(Voronoi, HasSeamsAtFewerThanOneWallPointInAHundred) {
    test::Random random(4);
    const int n = 50000;
    int flat_seams = 0, solid_seams = 0;
    for (int i = 0; i < n; ++i) {
        glm::vec3 below = random.point(20.0f), above = below;
        const float wall = float(int(random.within(-20.0f, 20.0f))), h = 1e-5f;
        below[i % 2] = wall - h;
        above[i % 2] = wall + h;
        const float step = 1e-4f;  // distances change no faster than the point moves
        const Voronoi<glm::vec2> a = voronoi(glm::vec2(below), 1.0f),
                                 b = voronoi(glm::vec2(above), 1.0f);
        flat_seams += std::fabs(a.f1 - b.f1) > step || std::fabs(a.f2 - b.f2) > step;
        const Voronoi<glm::vec3> c = voronoi(below, 1.0f), d = voronoi(above, 1.0f);
        solid_seams += std::fabs(c.f1 - d.f1) > step || std::fabs(c.f2 - d.f2) > step;
    }
    EXPECT_LT(double(flat_seams) / n, 0.01);
    EXPECT_LT(double(solid_seams) / n, 0.01);
}

TEST(Voronoi, SurvivesHugeAndBrokenCoordinates) {
    const float infinity = std::numeric_limits<float>::infinity();
    for (const float x : {1e6f, -1e9f, 1e20f, infinity, -infinity, std::nanf("")}) {
        const Voronoi<glm::vec2> flat = voronoi(glm::vec2(x, 0.3f), 1.0f);
        const Voronoi<glm::vec3> solid = voronoi(glm::vec3(0.3f, x, -x), 1.0f);
        EXPECT_TRUE(std::isfinite(flat.f1) && std::isfinite(flat.f2)) << x;
        EXPECT_TRUE(std::isfinite(solid.f1) && std::isfinite(solid.f2)) << x;
        EXPECT_GE(flat.f2, flat.f1) << x;
        EXPECT_GE(solid.f2, solid.f1) << x;
    }
}

}  // namespace
}  // namespace estara
