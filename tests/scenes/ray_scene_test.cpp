#include "estara/scenes/ray_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "ray_scenes.h"

namespace estara::test {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

struct ExactHit {
    double t;
    int instance, triangle;
};

/// Möller & Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection", in double, on every
/// triangle of every instance in world space.
/// @param margin  widens (or, negative, narrows) each triangle, in barycentric coordinates
std::optional<ExactHit> brute_force(const Scene& scene, const Ray& ray, double margin) {
    std::optional<ExactHit> nearest;
    const glm::dvec3 o(ray.origin), d(ray.direction);
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Mesh& mesh = scene.objects[scene.instances[i].object].mesh;
        const glm::dmat4 m(*scene.nodes[scene.instances[i].node].matrix);
        for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
            const auto world = [&](int c) {
                return glm::dvec3(m * glm::dvec4(mesh.P[mesh.triangles[k][c]], 1.0));
            };
            const glm::dvec3 a = world(0), e1 = world(1) - a, e2 = world(2) - a;
            const glm::dvec3 p = glm::cross(d, e2);
            const double determinant = glm::dot(e1, p);
            if (determinant == 0.0) continue;
            const double b1 = glm::dot(o - a, p) / determinant;
            const glm::dvec3 q = glm::cross(o - a, e1);
            const double b2 = glm::dot(d, q) / determinant;
            const double t = glm::dot(e2, q) / determinant;
            if (b1 < -margin || b2 < -margin || b1 + b2 > 1.0 + margin) continue;
            if (t < ray.tmin || t > ray.tmax || (nearest && t >= nearest->t)) continue;
            nearest = {t, int(i), int(k)};
        }
    }
    return nearest;
}

struct Setting {
    const char* what;
    Scene scene;
    double size;  ///< half, of the region rays start in
    glm::dvec3 centre;
    double margin;  ///< what rounding may do to barycentric coordinates
};

std::vector<Setting> settings() {
    const glm::vec3 far(1e4f, -1e4f, 1e4f);
    std::vector<Setting> all;
    all.push_back({"one mesh", scene_of({ball(8)}, {glm::mat4(1.0f)}), 2.0, {}, 1e-5});
    all.push_back({"turned and stretched",
                   scene_of({ball(8), box({1, 0.5f, 0.1f})},
                            {transform({0.3f, 0, 0}, slanted(), {0.5f, 2.0f, 1.0f}),
                             transform({-1, 0, 1}, glm::inverse(slanted()), {1, 3, 0.7f})}),
                   3.0,
                   {},
                   1e-5});
    all.push_back({"far away",
                   scene_of({ball(8), box({1, 0.5f, 0.3f})},
                            {transform(far, slanted(), {0.5f, 2.0f, 1.0f}),
                             transform(far + glm::vec3(-1, 0, 1), slanted(), {1, 3, 0.7f})}),
                   3.0, glm::dvec3(far), 2e-2});
    return all;
}

/// Rays from around a scene towards its middle: 64 any way, then 64 side by side as those of a
/// camera or to a light are, which Embree is given as a stream; and so on.
std::vector<Ray> random_rays(const Setting& setting, int count) {
    Random random;
    std::vector<Ray> rays;
    glm::dvec3 side;  // where a bundle comes from
    for (int i = 0; i < count; ++i) {
        const bool bundled = i / 64 % 2 != 0;
        if (i % 64 == 0) side = random.direction();
        const glm::dvec3 from =
            setting.centre + setting.size * (bundled ? side : random.direction());
        const glm::dvec3 to =
            setting.centre + 0.6 * setting.size * random.unit() * random.direction();
        const double length = random.between(0.1, 10.0);
        rays.push_back({glm::vec3(from), glm::vec3(length * (to - from)), 0.0f, inf});
    }
    return rays;
}

std::vector<Hit> traced(const RayScene& rays, const std::vector<Ray>& some) {
    std::vector<Hit> hits(some.size());
    rays.intersect(some, hits.data());
    return hits;
}

/// What rounding does to positions in a scene, and more.
double position_error(const Setting& setting) {
    return 32.0 * 0x1p-24 * (glm::length(setting.centre) + 3.0 * setting.size);
}

TEST(RayScene, AgreesWithBruteForceInDouble) {
    for (const Setting& setting : settings()) {
        SCOPED_TRACE(setting.what);
        const RayScene rays(setting.scene);
        const std::vector<Ray> some = random_rays(setting, 2000);
        const std::vector<Hit> hits = traced(rays, some);
        int hit_count = 0;
        for (std::size_t i = 0; i < some.size(); ++i) {
            const auto surely = brute_force(setting.scene, some[i], -setting.margin);
            const auto possibly = brute_force(setting.scene, some[i], setting.margin);
            const bool hit = hits[i].instance != Hit::none;
            hit_count += hit;
            ASSERT_TRUE(hit || !surely) << i;
            ASSERT_TRUE(possibly || !hit) << i;
            // Near edges the two may name different triangles; the distance settles it. Across a
            // surface at a slant the error grows with 1 / cosine: only well-met ones are compared.
            if (!surely || !possibly || surely->triangle != possibly->triangle) continue;
            const Hit& h = hits[i];
            const Mesh& mesh = setting.scene.objects[h.instance].mesh;
            const glm::vec3 N = mesh_point(mesh, h.triangle, h.b1, h.b2).Ng;
            const glm::mat3 m(*setting.scene.nodes[h.instance].matrix);
            const double cosine =
                std::abs(glm::dot(glm::normalize(glm::inverse(glm::transpose(m)) * N),
                                  glm::normalize(some[i].direction)));
            if (cosine < 0.1) continue;
            ASSERT_NEAR(h.t * glm::length(some[i].direction),
                        surely->t * glm::length(some[i].direction),
                        position_error(setting) / cosine)
                << i;
        }
        EXPECT_GT(hit_count, 500);
        EXPECT_LT(hit_count, 2000);
    }
}

TEST(RayScene, HasItsHitsWhereMeshPointPutsThem) {
    for (const Setting& setting : settings()) {
        SCOPED_TRACE(setting.what);
        const RayScene rays(setting.scene);
        const std::vector<Ray> some = random_rays(setting, 2000);
        const std::vector<Hit> hits = traced(rays, some);
        int checked = 0;
        for (std::size_t i = 0; i < some.size(); ++i) {
            const Hit& h = hits[i];
            if (h.instance == Hit::none) continue;
            ASSERT_GE(h.b1, 0.0f);
            ASSERT_GE(h.b2, 0.0f);
            ASSERT_LE(h.b1 + h.b2, 1.0f + 1e-6f);
            const MeshPoint p =
                mesh_point(setting.scene.objects[h.instance].mesh, h.triangle, h.b1, h.b2);
            const glm::dmat4 m(*setting.scene.nodes[h.instance].matrix);
            const glm::dvec3 there(m * glm::dvec4(p.P, 1.0));
            // The ray passes the point: what is left across it is rounding, t's own error aside.
            const glm::dvec3 d = glm::normalize(glm::dvec3(some[i].direction));
            const glm::dvec3 way = there - glm::dvec3(some[i].origin);
            ASSERT_LT(glm::length(way - glm::dot(way, d) * d), 4.0 * position_error(setting)) << i;
            const double distance = double(h.t) * glm::length(some[i].direction);
            ASSERT_NEAR(glm::dot(way, d), distance, 20.0 * position_error(setting)) << i;
            ++checked;
        }
        EXPECT_GT(checked, 500);
    }
}

TEST(RayScene, OccludesExactlyWhereItIntersects) {
    for (const Setting& setting : settings()) {
        SCOPED_TRACE(setting.what);
        const RayScene rays(setting.scene);
        std::vector<Ray> some = random_rays(setting, 2000);
        std::vector<std::uint8_t> blocked(some.size(), 7);
        rays.occluded(some, blocked.data());
        const std::vector<Hit> hits = traced(rays, some);
        for (std::size_t i = 0; i < some.size(); ++i)
            ASSERT_EQ(blocked[i], hits[i].instance != Hit::none ? 1 : 0) << i;

        // Rays that end before what they would hit are free; those that end behind it are not.
        for (std::size_t i = 0; i < some.size(); ++i)
            if (hits[i].instance != Hit::none) some[i].tmax = hits[i].t * (i % 2 ? 0.99f : 1.01f);
        rays.occluded(some, blocked.data());
        for (std::size_t i = 0; i < some.size(); ++i)
            ASSERT_EQ(blocked[i], hits[i].instance != Hit::none && i % 2 == 0) << i;
    }
}

TEST(RayScene, TracesAnyNumberOfRaysAlike) {
    const Setting setting = settings()[1];
    const RayScene rays(setting.scene);
    const std::vector<Ray> some = random_rays(setting, 100);
    for (const std::size_t count : {0, 1, 15, 16, 17, 100}) {
        const std::vector<Ray> first(some.begin(), some.begin() + long(count));
        const Hit untouched{12345, 1, 2.0f, 3.0f, 4.0f};
        std::vector<Hit> hits(101, untouched);
        std::vector<std::uint8_t> blocked(101, 7);
        rays.intersect(first, hits.data());
        rays.occluded(first, blocked.data());
        for (std::size_t i = 0; i < count; ++i) {
            const auto exact = brute_force(setting.scene, some[i], 0.0);
            ASSERT_EQ(hits[i].instance, exact ? std::uint32_t(exact->instance) : Hit::none) << i;
            ASSERT_EQ(blocked[i], exact.has_value()) << i;
        }
        EXPECT_EQ(hits[count].instance, untouched.instance) << "wrote behind the end";
        EXPECT_EQ(blocked[count], 7) << "wrote behind the end";
    }
}

TEST(RayScene, LetsRaysWithoutMeaningHitNothing) {
    const Scene scene = scene_of({ball(8)}, {glm::mat4(1.0f)});
    const RayScene rays(scene);
    const Ray good{{0, 0, 5}, {0, 0, -1}, 0.0f, inf};
    std::vector<Ray> some(9, good);
    some[1].origin.x = nan;
    some[2].direction.z = nan;
    some[3].tmin = nan;
    some[4].tmax = nan;
    some[5].direction = glm::vec3(0.0f);
    some[6].direction.y = inf;
    some[7].tmax = -1.0f;
    std::vector<std::uint8_t> blocked(some.size(), 7);
    rays.occluded(some, blocked.data());
    const std::vector<Hit> hits = traced(rays, some);
    for (std::size_t i = 0; i < some.size(); ++i) {
        const bool should_hit = i == 0 || i == 8;
        EXPECT_EQ(hits[i].instance, should_hit ? 0 : Hit::none) << i;
        EXPECT_EQ(blocked[i], should_hit) << i;
    }
}

TEST(RayScene, TracesABundleAsItsRaysOneByOne) {
    const Setting setting = settings()[1];
    const RayScene rays(setting.scene);
    // Parallel to axes, where reciprocals are infinite, and nearly so. Every fifth ray is empty.
    for (const glm::vec3 along :
         {glm::vec3(0, 0, -1), glm::vec3(0.0f, -0.0f, -1), glm::vec3(-1, 0, 0),
          glm::vec3(1e-20f, -1e-20f, -1), glm::vec3(0.3f, -0.2f, -1)}) {
        std::vector<Ray> bundle;
        for (int i = 0; i < 512; ++i) {
            const glm::vec3 beside(0.1f * float(i % 32) - 1.6f, 0.2f * float(i / 32) - 1.6f,
                                   0.1f * float(i % 32) - 1.6f);
            bundle.push_back({beside - 5.0f * along, along, 0.0f, i % 5 == 4 ? -1.0f : inf});
        }
        const std::vector<Hit> together = traced(rays, bundle);
        std::vector<std::uint8_t> blocked(bundle.size(), 7);
        rays.occluded(bundle, blocked.data());
        int hit_count = 0;
        for (std::size_t i = 0; i < bundle.size(); ++i) {
            const Hit alone = traced(rays, {bundle[i]})[0];
            ASSERT_EQ(together[i].instance, alone.instance) << i;
            ASSERT_EQ(blocked[i], alone.instance != Hit::none) << i;
            if (alone.instance == Hit::none) continue;
            ASSERT_FLOAT_EQ(together[i].t, alone.t) << i;
            ++hit_count;
        }
        EXPECT_GT(hit_count, 50);
    }
}

TEST(RayScene, TakesDirectionsOfAnyLength) {
    const Scene scene = scene_of({ball(8)}, {glm::mat4(1.0f)});
    const RayScene rays(scene);
    for (const float length : {1e-30f, 1e-10f, 1.0f, 1e10f, 1e30f}) {
        const std::vector<Ray> some{{{0.1f, 0.1f, 5}, {0, 0, -length}, 0.0f, inf}};
        const Hit hit = traced(rays, some)[0];
        ASSERT_EQ(hit.instance, 0u) << length;
        EXPECT_NEAR(hit.t * length, 4.0f, 0.1f) << length;
    }
}

TEST(RayScene, KeepsToTheRaysOwnInterval) {
    const Scene scene = scene_of({box({1, 1, 1})}, {glm::mat4(1.0f)});
    const RayScene rays(scene);
    const glm::vec3 o(0.1f, 0.2f, 5), d(0, 0, -2);  // meets the box at t = 2 and t = 3
    const std::vector<Hit> hits =
        traced(rays, {{o, d, 0, inf}, {o, d, 2.5f, inf}, {o, d, 0, 1.9f}, {o, d, 3.1f, inf}});
    EXPECT_FLOAT_EQ(hits[0].t, 2.0f);
    EXPECT_FLOAT_EQ(hits[1].t, 3.0f);
    EXPECT_EQ(hits[2].instance, Hit::none);
    EXPECT_EQ(hits[3].instance, Hit::none);
}

TEST(RayScene, FollowsThePose) {
    const Scene scene = scene_of({box({1, 1, 1})}, {glm::mat4(1.0f)});
    RayScene rays(scene);
    const std::vector<Ray> some{{{50, 0.1f, 5}, {0, 0, -1}, 0.0f, inf}};
    EXPECT_EQ(traced(rays, some)[0].instance, Hit::none);
    rays.set_pose(pose_of({transform({50, 0, 0}, glm::quat(1, 0, 0, 0), glm::vec3(1.0f))}));
    EXPECT_EQ(traced(rays, some)[0].instance, 0u);
    rays.set_pose(pose_of({glm::mat4(1.0f)}));
    EXPECT_EQ(traced(rays, some)[0].instance, Hit::none);
}

TEST(RayScene, LeavesOutWhatIsFlattenedAndTakesItInAgain) {
    glm::mat4 crushed = glm::mat4_cast(slanted());  // two axes in one plane, but for rounding
    crushed[2] = crushed[0] + crushed[1];
    glm::mat4 broken(1.0f);
    broken[3].x = nan;
    const glm::vec3 away(0, 0, -3);
    const Scene scene = scene_of({ball(8), ball(8)},
                                 {glm::mat4(0.0f), transform(away, slanted(), glm::vec3(1.0f))});
    RayScene rays(scene);  // starts with an instance of size 0
    const glm::mat4 behind(*scene.nodes[1].matrix);
    const std::vector<Ray> some{{{0.05f, 0, 5}, {0, 0, -1}, 0.0f, inf}};
    EXPECT_EQ(traced(rays, some)[0].instance, 1u);
    for (const glm::mat4& singular :
         {glm::mat4(0.0f), crushed, broken, glm::mat4(inf), glm::mat4(1e-20f)}) {
        rays.set_pose(pose_of({glm::mat4(1.0f), behind}));
        EXPECT_EQ(traced(rays, some)[0].instance, 0u);
        rays.set_pose(pose_of({singular, behind}));
        EXPECT_EQ(traced(rays, some)[0].instance, 1u);
    }
}

TEST(RayScene, IsEmptyWithoutTriangles) {
    const std::vector<Ray> some{{{0, 0, 5}, {0, 0, -1}, 0.0f, inf}};
    const Scene nothing;
    EXPECT_EQ(traced(RayScene(nothing), some)[0].instance, Hit::none);
    const Scene no_triangles = scene_of({Mesh{}}, {glm::mat4(1.0f)});
    EXPECT_EQ(traced(RayScene(no_triangles), some)[0].instance, Hit::none);
    Mesh one_point;
    one_point.P = {{0, 0, 0}};
    one_point.triangles = {{0, 0, 0}};
    const Scene degenerate = scene_of({one_point}, {glm::mat4(1.0f)});
    EXPECT_EQ(traced(RayScene(degenerate), some)[0].instance, Hit::none);
}

}  // namespace
}  // namespace estara::test
