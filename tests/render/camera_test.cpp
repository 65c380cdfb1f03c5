#include "estara/render/camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estara/scenes/matrix.h"
#include "instances.h"

namespace estara {
namespace {

const PinholePose front{{1.0f, 2.0f, 3.0f}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 0.5f};

TEST(Camera, ViewDirectionIsUnitAndTowardsTheEye) {
    const Camera camera(front, 64, 48);
    for (const glm::vec3& P :
         {glm::vec3(0.0f), glm::vec3(1e30f, 0.0f, 0.0f), glm::vec3(1e-30f, 2.0f, 3.0f),
          glm::vec3(1.0f, 2.0f, 3.00001f), glm::vec3(-5.0f, 7.0f, -100.0f)}) {
        const glm::vec3 V = camera.sight(P).V.vec();
        EXPECT_NEAR(glm::length(V), 1.0f, 1e-6f);
        const glm::dvec3 to_eye = glm::dvec3(front.eye) - glm::dvec3(P);
        EXPECT_NEAR(glm::dot(glm::dvec3(V), glm::normalize(to_eye)), 1.0, 1e-6);
        EXPECT_FLOAT_EQ(camera.sight(P).distance, float(glm::length(to_eye)));
    }
}

TEST(Camera, ViewDirectionAtTheEyeIsBackwards) {
    EXPECT_EQ(Camera(front, 64, 48).sight(front.eye).V.vec(), glm::vec3(0, 0, 1));
}

TEST(Camera, RayThroughTheMiddleGoesForward) {
    const Ray ray = Camera(front, 64, 48).primary_ray(32.0f, 24.0f);
    EXPECT_EQ(ray.origin, front.eye);
    EXPECT_LT(glm::length(ray.direction - front.forward), 1e-6f);
}

TEST(Camera, PixelsGrowWithXToTheRightAndYDown) {
    const Camera camera(front, 64, 48);
    EXPECT_LT(camera.primary_ray(0.5f, 24.0f).direction.x, 0.0f);
    EXPECT_GT(camera.primary_ray(32.0f, 0.5f).direction.y, 0.0f);
}

TEST(Instances, LargestSingularValueIsTheLongestImageOfAUnitVector) {
    const glm::dmat3 turned(glm::mat3_cast(glm::dquat(0.5, 0.5, 0.5, 0.5)));
    const glm::dmat3 stretch(2, 0, 0, 0, 5, 0, 0, 0, 0.25);
    EXPECT_NEAR(largest_singular_value(turned * stretch), 5.0, 1e-12);
    EXPECT_NEAR(largest_singular_value(glm::dmat3(1e-200)), 1e-200, 1e-212);
    EXPECT_NEAR(largest_singular_value(glm::dmat3(-3e200)), 3e200, 1e188);
    EXPECT_EQ(largest_singular_value(glm::dmat3(0.0)), 0.0);
    const glm::dmat3 shear(1, 0, 0, 1, 1, 0, 0, 0, 1);
    EXPECT_NEAR(largest_singular_value(shear), (1.0 + std::sqrt(5.0)) / 2.0, 1e-12);
}

TEST(Instances, NormalMatrixKeepsNormalsOnTangents) {
    for (const glm::dmat3& m :
         {glm::dmat3(2, 0, 1, 0, 5, 0, -1, 0.5, 0.25), glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1)}) {
        const glm::dvec3 tangent(1, 2, 0), other(0, 1, 3);
        const glm::dvec3 normal = glm::cross(tangent, other);
        const glm::dvec3 image = normal_matrix(m) * normal;
        EXPECT_NEAR(glm::dot(glm::normalize(image), glm::normalize(m * tangent)), 0.0, 1e-12);
        EXPECT_NEAR(glm::dot(glm::normalize(image), glm::normalize(m * other)), 0.0, 1e-12);
        // Outside stays outside, mirrored or not.
        EXPECT_GT(glm::dot(image, m * normal), 0.0);
    }
}

TEST(Instances, NormalMatrixOfAFlattenedInstanceIsAcrossTheFlat) {
    const glm::dvec3 n = normal_matrix(glm::dmat3(1, 0, 0, 0, 0, 0, 0, 0, 1)) * glm::dvec3(1, 1, 1);
    EXPECT_EQ(n, glm::dvec3(0, 1, 0));
}

}  // namespace
}  // namespace estara
