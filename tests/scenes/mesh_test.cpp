#include "estara/scenes/mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <set>

namespace estara {
namespace {

/// A right angle in the xy plane with sides of 2 and 4, and an unused vertex far away.
Mesh one_triangle() {
    Mesh mesh;
    mesh.P = {{1, 1, 5}, {3, 1, 5}, {1, 5, 5}, {1000, 1000, 1000}};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

TEST(Mesh, BoundsIgnoreVerticesThatNoTriangleUses) {
    const Box box = bounds(one_triangle());
    EXPECT_EQ(box.min, glm::vec3(1, 1, 5));
    EXPECT_EQ(box.max, glm::vec3(3, 5, 5));
}

TEST(Mesh, WithoutTrianglesHasTheEmptyBoxAndNoArea) {
    Mesh mesh;
    mesh.P = {{1, 2, 3}};
    EXPECT_EQ(bounds(mesh).diagonal(), 0.0f);
    EXPECT_EQ(area(mesh), 0.0);
}

TEST(Mesh, AreaIsThatOfTheTriangles) { EXPECT_DOUBLE_EQ(area(one_triangle()), 4.0); }

TEST(MeshPoint, CornersAreTheVertices) {
    const Mesh mesh = one_triangle();
    EXPECT_EQ(mesh_point(mesh, 0, 0, 0).P, mesh.P[0]);
    EXPECT_EQ(mesh_point(mesh, 0, 1, 0).P, mesh.P[1]);
    EXPECT_EQ(mesh_point(mesh, 0, 0, 1).P, mesh.P[2]);
}

TEST(MeshPoint, NormalPointsToWhereCornersRunCounterClockwise) {
    EXPECT_EQ(mesh_point(one_triangle(), 0, 0.3f, 0.3f).Ng, glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh_point(one_triangle(), 0, 0.3f, 0.3f).N, glm::vec3(0, 0, 1));
}

TEST(MeshPoint, InterpolatedNormalIsUnit) {
    Mesh mesh = one_triangle();
    mesh.N = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
    const glm::vec3 N = mesh_point(mesh, 0, 1.0f / 3, 1.0f / 3).N;
    EXPECT_NEAR(glm::distance(N, glm::normalize(glm::vec3(1))), 0.0f, 1e-6f);
}

TEST(MeshPoint, NormalsThatCancelGiveWayToTheGeometricOne) {
    Mesh mesh = one_triangle();
    mesh.N = {{1, 0, 0}, {-1, 0, 0}, {1, 0, 0}, {0, 0, 1}};
    EXPECT_EQ(mesh_point(mesh, 0, 0.5f, 0.0f).N, glm::vec3(0, 0, 1));
}

TEST(MeshPoint, TangentFollowsU) {
    Mesh mesh = one_triangle();
    mesh.uv = {{0, 0}, {0, 1}, {2, 0}, {0, 0}};  // u runs along the side of 4, at half its speed
    const MeshPoint point = mesh_point(mesh, 0, 0.25f, 0.5f);
    EXPECT_EQ(tangent(mesh, point), glm::vec3(0, 2, 0));
    EXPECT_EQ(point.uv, glm::vec2(1.0f, 0.25f));
}

TEST(MeshPoint, TangentIsNeverZeroAndAlwaysAcrossTheNormalWithoutUv) {
    std::mt19937 random(1);
    std::normal_distribution<float> any;
    for (int i = 0; i < 1000; ++i) {
        Mesh mesh = one_triangle();
        for (glm::vec3& p : mesh.P) p = {any(random), any(random), any(random)};
        if (i % 2 == 0) mesh.uv.assign(4, {0.5f, 0.5f});  // says nothing of u
        const MeshPoint point = mesh_point(mesh, 0, 0.2f, 0.2f);
        EXPECT_NEAR(glm::length(tangent(mesh, point)), 1.0f, 1e-5f);
        EXPECT_NEAR(glm::dot(tangent(mesh, point), point.N), 0.0f, 1e-5f);
    }
}

TEST(MeshPoint, TangentExistsAtThePolesToo) {
    Mesh mesh;
    mesh.P = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
    for (const std::uint32_t side : {0u, 1u}) {
        const MeshPoint point = mesh_point(mesh, side, 0.3f, 0.3f);
        EXPECT_EQ(std::abs(point.N.y), 1.0f);
        EXPECT_NEAR(glm::length(tangent(mesh, point)), 1.0f, 1e-6f);
    }
}

TEST(MeshPoint, DegenerateTrianglesHaveFiniteFrames) {
    Mesh mesh = one_triangle();
    mesh.uv = {{0, 0}, {1, 0}, {0, 1}, {0, 0}};
    mesh.P[1] = mesh.P[2] = mesh.P[0];
    const MeshPoint point = mesh_point(mesh, 0, 0.3f, 0.3f);
    EXPECT_EQ(point.Ng, glm::vec3(0, 0, 1));
    EXPECT_EQ(point.N, glm::vec3(0, 0, 1));
    EXPECT_GT(glm::length(tangent(mesh, point)), 0.0f);
}

TEST(MeshPoint, NormalOfATinyTriangleFarAwayIsRight) {
    Mesh mesh;
    mesh.P = {{4096, 4096, 4096}, {4096.001f, 4096, 4096}, {4096, 4096.001f, 4096}};
    mesh.triangles = {{0, 1, 2}};
    EXPECT_EQ(mesh_point(mesh, 0, 0.3f, 0.3f).Ng, glm::vec3(0, 0, 1));
    for (glm::vec3& p : mesh.P) p *= 1e-25f;  // edges whose product is no float any more
    EXPECT_EQ(mesh_point(mesh, 0, 0.3f, 0.3f).Ng, glm::vec3(0, 0, 1));
}

TEST(MeshDigest, ChangesWithEveryPart) {
    Mesh mesh = one_triangle();
    mesh.N.assign(4, {0, 0, 1});
    mesh.uv.assign(4, {0, 0});
    const std::function<void(Mesh&)> changes[] = {
        [](Mesh&) {},
        [](Mesh& m) { m.P[2].y = std::nextafter(m.P[2].y, 9.0f); },
        [](Mesh& m) {
            m.N[0] = {0, 1, 0};
        },
        [](Mesh& m) { m.N.clear(); },
        [](Mesh& m) { m.uv[3].x = 1.0f; },
        [](Mesh& m) { m.uv.clear(); },
        [](Mesh& m) {
            m.triangles[0] = {1, 2, 0};
        },
        [](Mesh& m) {
            m.triangles.push_back({0, 1, 2});
        },
    };
    std::set<std::string> digests;
    for (const auto& change : changes) {
        Mesh changed = mesh;
        change(changed);
        digests.insert(mesh_digest(changed));
        EXPECT_EQ(mesh_digest(changed), mesh_digest(changed));
        EXPECT_EQ(mesh_digest(changed).find_first_not_of("0123456789abcdef"), std::string::npos);
        EXPECT_EQ(mesh_digest(changed).size(), 16u);
    }
    EXPECT_EQ(digests.size(), std::size(changes));
}

}  // namespace
}  // namespace estara
