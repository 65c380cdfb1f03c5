#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "estara/scenes/offset.h"
#include "estara/scenes/ray_scene.h"
#include "ray_scenes.h"

namespace estara::test {
namespace {

constexpr int points = 100000;

struct Leaving {
    const char* what;
    Mesh mesh;  ///< convex
    glm::mat4 world_from_object;
};

/// A round floor whose vertices have y = 0 exactly.
Mesh floor_at_zero() {
    Mesh mesh;
    mesh.P.push_back({0.0f, 0.0f, 0.0f});
    constexpr int corners = 90;
    for (int i = 0; i < corners; ++i) {
        const float angle = 2.0f * 3.14159265f * float(i) / float(corners);
        mesh.P.push_back({std::cos(angle), 0.0f, -std::sin(angle)});
        mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % corners});
    }
    return mesh;
}

std::vector<Leaving> surfaces() {
    const glm::quat straight(1, 0, 0, 0);
    const glm::vec3 one(1.0f), far(1e4f, -1e4f, 1e4f), stretched(3.0f, 0.5f, 1.5f);
    const Mesh sphere = ball(60), thin = box({1.0f, 0.7f, 1e-3f});
    std::vector<Leaving> all{{"floor in y = 0", floor_at_zero(), glm::mat4(1.0f)}};
    for (const auto& [name, mesh] : {std::pair{"sphere", sphere}, std::pair{"thin box", thin}}) {
        all.push_back({name, mesh, transform({}, straight, one)});
        all.push_back({name, mesh, transform({}, slanted(), stretched)});
        all.push_back({name, mesh, transform(far, straight, one)});
        all.push_back({name, mesh, transform(far, slanted(), stretched)});
    }
    return all;
}

struct Start {
    glm::vec3 P, N, P_object;
    glm::vec3 direction;
};

/// A random point as a renderer computes it, and a way out of the surface.
Start random_start(const Leaving& from, Random& random) {
    const int triangle = random.below(int(from.mesh.triangles.size()));
    double b1 = random.unit(), b2 = random.unit();
    if (b1 + b2 > 1.0) b1 = 1.0 - b1, b2 = 1.0 - b2;
    const MeshPoint p = mesh_point(from.mesh, std::uint32_t(triangle), float(b1), float(b2));
    const glm::mat3 linear(from.world_from_object);
    Start start;
    start.P_object = p.P;
    start.P = glm::vec3(from.world_from_object * glm::vec4(p.P, 1.0f));
    start.N = glm::normalize(glm::inverse(glm::transpose(linear)) * p.Ng);
    glm::dvec3 out = random.direction();
    // Grazing ones too: a tenth of them lie within a degree of the surface.
    if (random.unit() < 0.1) out -= 0.99 * glm::dot(out, glm::dvec3(start.N)) * glm::dvec3(start.N);
    if (glm::dot(out, glm::dvec3(start.N)) < 0.0)
        out -= 2.0 * glm::dot(out, glm::dvec3(start.N)) * glm::dvec3(start.N);
    start.direction = glm::vec3(out);
    return start;
}

double ulp(double x) { return std::ldexp(1.0, std::ilogb(std::max(x, 1e-30)) - 23); }

TEST(SurfaceOffset, NeverLetsAConvexObjectShadowItself) {
    for (const Leaving& from : surfaces()) {
        SCOPED_TRACE(from.what);
        const Scene scene = scene_of({from.mesh}, {from.world_from_object});
        const RayScene rays(scene);
        const SurfaceOffset offset(from.world_from_object);
        Random random;
        std::vector<Ray> some, without;
        for (int i = 0; i < points; ++i) {
            const Start s = random_start(from, random);
            const glm::vec3 origin = offset.from(s.P, s.N, s.P_object);
            constexpr float inf = std::numeric_limits<float>::infinity();
            some.push_back({origin, s.direction, 0.0f, inf});
            without.push_back({s.P, s.direction, 0.0f, inf});
        }
        std::vector<std::uint8_t> blocked(some.size());
        rays.occluded(some, blocked.data());
        EXPECT_EQ(std::count(blocked.begin(), blocked.end(), 1), 0);
        rays.occluded(without, blocked.data());
        EXPECT_GT(std::count(blocked.begin(), blocked.end(), 1), 0) << "the test tests nothing";
    }
}

TEST(SurfaceOffset, StaysWithinSixtyFourUlpsOfTheLargestCoordinate) {
    for (const Leaving& from : surfaces()) {
        SCOPED_TRACE(from.what);
        const SurfaceOffset offset(from.world_from_object);
        Random random;
        double largest = 0.0;
        for (int i = 0; i < points; ++i) {
            const Start s = random_start(from, random);
            const glm::dvec3 moved =
                glm::dvec3(offset.from(s.P, s.N, s.P_object)) - glm::dvec3(s.P);
            const glm::vec3 size = glm::abs(s.P);
            const double unit = ulp(std::max({size.x, size.y, size.z}));
            largest = std::max(largest, glm::length(moved) / unit);
        }
        EXPECT_LT(largest, 64.0);
        EXPECT_GT(largest, 1.0);
    }
}

TEST(SurfaceOffset, GoesToTheSideOfTheNormal) {
    const glm::mat4 m = transform({5, 6, 7}, slanted(), glm::vec3(2.0f));
    const glm::vec3 P(m * glm::vec4(1, 2, 3, 1));
    Random random;
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 N(random.direction());
        EXPECT_GT(glm::dot(SurfaceOffset(m).from(P, N, {1, 2, 3}) - P, N), 0.0f);
    }
}

TEST(SurfaceOffset, LeavesAPointOfAFlattenedObjectWhereItIs) {
    const glm::vec3 P(1, 2, 3), N(0, 0, 1);
    EXPECT_EQ(SurfaceOffset(glm::mat4(0.0f)).from(P, N, {1, 1, 1}), P);
}

}  // namespace
}  // namespace estara::test
