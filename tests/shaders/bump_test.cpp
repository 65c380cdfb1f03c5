// Normals of height fields, and tangents.
#include "estara/shaders/bump.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sampling.h"

namespace estara {
namespace {

void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance) {
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(a[c], b[c], tolerance);
}

TEST(Bumped, IsTheNormalOfAPlaneThatIsRaised) {
    test::Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const float a = random.within(-3.0f, 3.0f), b = random.within(-3.0f, 3.0f);
        // The height a x + b y; its change with z does not matter.
        const glm::vec3 N = bumped({0, 0, 1}, {a, b, random.within(-9.0f, 9.0f)});
        expect_near(N, glm::normalize(glm::vec3(-a, -b, 1.0f)), 1e-6f);
    }
}

TEST(Bumped, LeavesTheNormalWhereTheHeightIsFlat) {
    test::Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 N = random.direction();
        expect_near(bumped(N, glm::vec3(0.0f)), N, 3e-7f);
        expect_near(bumped(N, N * 5.0f), N, 2e-6f);  // the height changes off the surface alone
    }
}

TEST(Bumped, IsAlwaysAUnitVector) {
    test::Random random(3);
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 N = random.direction();
        const glm::vec3 slope = random.direction() * std::exp2(random.within(-60.0f, 60.0f));
        ASSERT_NEAR(glm::length(bumped(N, slope)), 1.0f, 1e-6f);
    }
    EXPECT_EQ(bumped({0, 1, 0}, glm::vec3(1e30f)), glm::vec3(0, 1, 0));
    EXPECT_EQ(bumped({0, 0, 0}, {0, 0, 0}), glm::vec3(0.0f));
}

TEST(TangentAlong, IsUnitAndNormalToNAndGrowsWithU) {
    test::Random random(4);
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 N = random.direction();
        const glm::vec3 dPdu = random.direction() * std::exp2(random.within(-30.0f, 30.0f));
        const glm::vec3 t = tangent_along(dPdu, N);
        ASSERT_NEAR(glm::length(t), 1.0f, 1e-6f);
        ASSERT_NEAR(glm::dot(t, N), 0.0f, 2e-4f);
        ASSERT_GE(glm::dot(t, dPdu), 0.0f);
        ASSERT_NEAR(glm::dot(glm::cross(t, dPdu), N) / glm::length(dPdu), 0.0f, 2e-4f);
    }
}

TEST(TangentAlong, ExistsWithoutADirectionOfU) {
    test::Random random(5);
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 N = random.direction();
        for (const glm::vec3& dPdu : {glm::vec3(0.0f), N, -3.0f * N, glm::vec3(1e38f)}) {
            const glm::vec3 t = tangent_along(dPdu, N);
            ASSERT_NEAR(glm::length(t), 1.0f, 1e-6f);
            ASSERT_NEAR(glm::dot(t, N), 0.0f, 2e-4f);
        }
        EXPECT_EQ(tangent_along(glm::vec3(0.0f), N), tangent_along(N, N));
    }
    EXPECT_NEAR(glm::length(tangent_along({1, 0, 0}, {0, 0, 0})), 1.0f, 1e-6f);
}

}  // namespace
}  // namespace estara
