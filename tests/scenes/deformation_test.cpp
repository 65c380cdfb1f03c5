// Meshes that bend, against vertices computed here in double.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "estara/scenes/ray_scene.h"
#include "estara/scenes/scene.h"
#include "ray_scenes.h"

namespace estara::test {
namespace {

/// A node that is turned, moved and stretched at random.
Node some_node(std::mt19937& random, int parent) {
    std::uniform_real_distribution<float> any(-1.0f, 1.0f);
    Node node;
    node.parent = parent;
    node.translation = {any(random), any(random), any(random)};
    node.rotation =
        glm::normalize(glm::quat(any(random), any(random), any(random), 0.5f + any(random)));
    node.scale = glm::vec3(1.0f) + 0.3f * glm::vec3(any(random), any(random), any(random));
    return node;
}

/// glTF 2.0, 5.25: T R S, column vectors. Written out, to share nothing with the code.
glm::dmat4 matrix_of(const Node& node) {
    const glm::dvec3 t(node.translation), s(node.scale);
    const double x = node.rotation.x, y = node.rotation.y, z = node.rotation.z, w = node.rotation.w;
    const double n = x * x + y * y + z * z + w * w, k = 2.0 / n;
    const glm::dvec3 X(1 - k * (y * y + z * z), k * (x * y + w * z), k * (x * z - w * y));
    const glm::dvec3 Y(k * (x * y - w * z), 1 - k * (x * x + z * z), k * (y * z + w * x));
    const glm::dvec3 Z(k * (x * z + w * y), k * (y * z - w * x), 1 - k * (x * x + y * y));
    return {glm::dvec4(X * s.x, 0), glm::dvec4(Y * s.y, 0), glm::dvec4(Z * s.z, 0),
            glm::dvec4(t, 1)};
}

/// A ball that follows a chain of ten joints, eight a vertex, and has two morph targets. Its own
/// node is somewhere else, and a node of the chain is far away from the world's origin.
struct Creature {
    Scene scene;
    std::mt19937 random{7};

    explicit Creature(const glm::dvec3& far = glm::dvec3(0.0)) {
        std::uniform_real_distribution<float> any(-1.0f, 1.0f);
        Mesh mesh = ball(12);
        mesh.N = mesh.P;
        scene = scene_of({mesh}, {glm::mat4(3.0f)});
        Node root;
        root.translation = far;
        scene.nodes.push_back(root);
        Skin skin;
        for (int j = 0; j < 10; ++j) {
            skin.joints.push_back(int(scene.nodes.size()));
            scene.nodes.push_back(some_node(random, int(scene.nodes.size()) - 1));
            skin.joint_from_rest.push_back(
                glm::mat4(glm::inverse(matrix_of(some_node(random, -1)))));
        }
        scene.skins.push_back(skin);
        scene.instances[0].skin = 0;
        Deformation& how = scene.objects[0].bends;
        how.influences.count = 8;
        for (std::size_t i = 0; i < mesh.P.size(); ++i) {
            float sum = 0.0f;
            for (int k = 0; k < 8; ++k) {
                how.influences.joint.push_back(std::uint16_t(random() % 10));
                how.influences.weight.push_back(0.1f + std::abs(any(random)));
                sum += how.influences.weight.back();
            }
            for (int k = 0; k < 8; ++k) how.influences.weight[8 * i + std::size_t(k)] /= sum;
        }
        for (int t = 0; t < 2; ++t) {
            MorphTarget target;
            for (std::size_t i = 0; i < mesh.P.size(); ++i) {
                target.P.emplace_back(any(random), any(random), any(random));
                target.N.push_back(0.1f * target.P.back());
            }
            how.targets.push_back(target);
        }
        scene.nodes[0].weights = {0.25f, -0.125f};
    }

    glm::dmat4 world_from(int node) const {
        glm::dmat4 m(1.0);
        for (; node >= 0; node = scene.nodes[std::size_t(node)].parent) {
            m = matrix_of(scene.nodes[std::size_t(node)]) * m;
        }
        return m;
    }
    glm::dmat4 blend(std::size_t vertex) const {
        const Influences& how = scene.objects[0].bends.influences;
        glm::dmat4 sum(0.0);
        for (std::size_t k = 8 * vertex; k < 8 * vertex + 8; ++k) {
            sum +=
                double(how.weight[k]) * (world_from(scene.skins[0].joints[how.joint[k]]) *
                                         glm::dmat4(scene.skins[0].joint_from_rest[how.joint[k]]));
        }
        return sum;
    }
    glm::dvec3 morphed(std::size_t vertex, bool normal) const {
        const auto& targets = scene.objects[0].bends.targets;
        const Mesh& mesh = scene.objects[0].mesh;
        return normal ? glm::dvec3(mesh.N[vertex]) + 0.25 * glm::dvec3(targets[0].N[vertex]) -
                            0.125 * glm::dvec3(targets[1].N[vertex])
                      : glm::dvec3(mesh.P[vertex]) + 0.25 * glm::dvec3(targets[0].P[vertex]) -
                            0.125 * glm::dvec3(targets[1].P[vertex]);
    }
};

TEST(Bent, VerticesAreWhereDoubleHasThem) {
    for (const glm::dvec3& far : {glm::dvec3(0.0), glm::dvec3(1e6, -3e6, 6.4e6)}) {
        const Creature creature(far);
        const Pose pose = pose_at(creature.scene, 0.0, far);
        ASSERT_TRUE(pose.bent[0]);
        for (std::size_t i = 0; i < pose.bent[0]->P.size(); ++i) {
            const glm::vec3 P(pose.world_from_instance[0] * glm::vec4(pose.bent[0]->P[i], 1.0f));
            const glm::dvec3 right(creature.blend(i) * glm::dvec4(creature.morphed(i, false), 1.0));
            EXPECT_LT(glm::distance(glm::dvec3(P), right - far), 3e-6) << i;
        }
    }
}

TEST(Bent, NormalsAreTurnedByTheInverseTranspose) {
    const Creature creature;
    const Pose pose = pose_at(creature.scene, 0.0);
    for (std::size_t i = 0; i < pose.bent[0]->N.size(); ++i) {
        const glm::dmat3 turn = glm::transpose(glm::inverse(glm::dmat3(creature.blend(i))));
        const glm::dvec3 right = glm::normalize(turn * creature.morphed(i, true));
        EXPECT_LT(glm::distance(glm::dvec3(pose.bent[0]->N[i]), right), 1e-5) << i;
    }
}

TEST(Bent, TrianglesKnowHowFarTheyAreStretched) {
    const Creature creature;
    const Pose pose = pose_at(creature.scene, 0.0);
    const Mesh& rest = creature.scene.objects[0].mesh;
    for (std::size_t t = 0; t < rest.triangles.size(); ++t) {
        const auto area = [&](const std::vector<glm::vec3>& P) {
            const glm::uvec3 v = rest.triangles[t];
            return glm::length(
                glm::cross(glm::dvec3(P[v.y] - P[v.x]), glm::dvec3(P[v.z] - P[v.x])));
        };
        const double ratio = std::sqrt(area(pose.bent[0]->P) / area(rest.P));
        EXPECT_NEAR(pose.bent[0]->stretch[t], ratio, 1e-4 * ratio);
    }
}

/// A square in the xy plane, seen from +z, with morph targets that lift it by 1 and by 10.
Scene lifted() {
    Mesh mesh;
    mesh.P = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    Scene scene = scene_of({mesh}, {glm::mat4(1.0f)});
    for (const float z : {1.0f, 10.0f}) {
        scene.objects[0].bends.targets.push_back(
            {std::vector<glm::vec3>(4, glm::vec3(0.0f, 0.0f, z)), {}});
    }
    return scene;
}

double height(const Scene& scene, double time) {
    const Pose pose = pose_at(scene, time);
    return double(pose.world_from_instance[0][3].z) + double(placed_vertices(scene, pose, 0)[0].z);
}

TEST(Bent, MorphTargetsTakeTheNodesWeightsOrTheMeshes) {
    Scene scene = lifted();
    EXPECT_FALSE(pose_at(scene, 0.0).bent[0]);  // nothing has a weight
    scene.objects[0].weights = {0.5f, 0.0f};
    EXPECT_EQ(height(scene, 0.0), 0.5);
    scene.nodes[0].weights = {0.0f, 0.25f};
    EXPECT_EQ(height(scene, 0.0), 2.5);
}

TEST(Bent, MorphTargetsFollowTheirKeys) {
    Scene scene = lifted();
    scene.nodes[0].weight_tracks = {
        {Interpolation::linear, {1.0f, 2.0f}, {0.0f, 1.0f}},
        {Interpolation::cubic_spline, {1.0f, 3.0f}, {0.0f, 0.0f, 1.0f, -1.0f, 1.0f, 0.0f}}};
    EXPECT_EQ(height(scene, 1.0), 0.0);
    // The spline at s = .25, .5 of 2 seconds: tangents of 1 and -1 a second.
    EXPECT_NEAR(height(scene, 1.5), 0.5 + 10.0 * (2 * .140625 + .15625 + 2 * .046875), 1e-5);
    EXPECT_NEAR(height(scene, 2.0), 1.0 + 10.0 * (0.25 + 0.5 + 0.25), 1e-5);
    const FrameRange frames = animated_frames(scene, 10.0);
    EXPECT_EQ(frames.first, 10);
    EXPECT_EQ(frames.last, 30);
}

TEST(Bent, SidesStayWhereTheyAreInAMirror) {
    Creature creature;
    for (int mirrored = 0; mirrored < 2; ++mirrored) {
        creature.scene.nodes[1].scale = {mirrored ? -1.0f : 1.0f, 1, 1};
        const Pose pose = pose_at(creature.scene, 0.0);
        const Mesh& rest = creature.scene.objects[0].mesh;
        for (std::size_t t = 0; t < rest.triangles.size(); ++t) {
            const glm::uvec3 v = rest.triangles[t];
            const std::vector<glm::vec3>& N = pose.bent[0]->N;
            EXPECT_GE(glm::dot(pose.bent[0]->Ng[t], N[v.x] + N[v.y] + N[v.z]), 0.0f) << t;
        }
    }
}

TEST(Bent, WhatANodeSqueezesFlatIsFlatAndHit) {
    Scene scene = scene_of({ball(24), ball(24)}, {glm::mat4(1.0f), glm::mat4(1.0f)});
    for (const glm::vec3& size : {glm::vec3(1, 0, 1), glm::vec3(1e-20f, 1e-20f, 0)}) {
        scene.nodes[0] = {};
        scene.nodes[0].translation = {0, 2, 0};
        scene.nodes[0].rotation = glm::angleAxis(0.3f, glm::vec3(0, 0, 1));
        scene.nodes[0].scale = size;
        const Pose pose = pose_at(scene, 0.0);
        ASSERT_TRUE(pose.bent[0]);
        EXPECT_FALSE(pose.bent[1]);
        RayScene rays(scene);
        rays.set_pose(pose);
        const std::vector<Ray> down{{{0.1f, 9, 0.1f}, {0, -1, 0}, 0.0f, 1e9f}};
        Hit hit;
        rays.intersect(down, &hit);
        if (size.x == 1.0f) {
            EXPECT_EQ(hit.instance, 0u);
            EXPECT_NEAR(9.0 - double(hit.t), 2.0 + 0.1 * std::tan(0.3), 1e-5);
        } else {
            EXPECT_EQ(hit.instance, 1u);  // next to nothing is left of it
        }
    }
}

TEST(Bent, RaysMeetItAfterRefitsAndAfterBuilds) {
    Scene scene = scene_of({ball(24)}, {glm::mat4(1.0f)});
    Mesh& mesh = scene.objects[0].mesh;
    MorphTarget longer;  // three times as long along y
    for (const glm::vec3& P : mesh.P) longer.P.emplace_back(0, 2.0f * P.y, 0);
    scene.objects[0].bends.targets = {longer};
    scene.nodes[0].weight_tracks = {{Interpolation::linear, {0, 1}, {0, 1}}};
    RayScene rays(scene);
    int refits = 0, rebuilds = 0;
    for (int step = 0; step <= 20; ++step) {
        const double weight = step / 20.0;
        rays.set_pose(pose_at(scene, weight));
        refits += rays.last_update().refits;
        rebuilds += rays.last_update().rebuilds;
        std::vector<Ray> some;
        for (int i = 0; i < 9; ++i)
            some.push_back({{0, 0.9f - 0.2f * float(i), 9}, {0, 0, -1}, 0, 1e9f});
        std::vector<Hit> hits(some.size());
        rays.intersect(some, hits.data());
        for (std::size_t i = 0; i < some.size(); ++i) {
            const double y = double(some[i].origin.y) / (1.0 + 2.0 * weight);
            ASSERT_EQ(hits[i].instance, 0u);
            EXPECT_NEAR(9.0 - double(hits[i].t), std::sqrt(1.0 - y * y), 0.02) << step;
        }
    }
    EXPECT_GT(refits, 10);
    EXPECT_GT(rebuilds, 1);
    rays.set_pose(pose_at(scene, 1.0));  // as it was
    EXPECT_EQ(rays.last_update().refits + rays.last_update().rebuilds, 0);
}

TEST(Bent, OnlyWhatHasASkinOrAWeightBends) {
    Scene scene = lifted();
    EXPECT_FALSE(bends(scene, scene.instances[0]));
    scene.nodes[0].weight_tracks = {{Interpolation::linear, {0, 1}, {0, 0}}};
    EXPECT_FALSE(bends(scene, scene.instances[0]));
    scene.nodes[0].weight_tracks[0].values = {0, 1};
    EXPECT_TRUE(bends(scene, scene.instances[0]));
    EXPECT_TRUE(bends(Creature().scene, Creature().scene.instances[0]));
}

TEST(Bent, ThatIsNotFiniteIsNowhere) {
    Creature creature;
    creature.scene.skins[0].joint_from_rest[3][3].x = std::numeric_limits<float>::infinity();
    const Pose pose = pose_at(creature.scene, 0.0);
    EXPECT_FALSE(pose.bent[0]);
    EXPECT_FALSE(can_be_hit(pose.world_from_instance[0]));
}

TEST(CarriedFrame, TurnsWithTheSurface) {
    Creature creature;
    const Mesh& rest = creature.scene.objects[0].mesh;
    const glm::dmat3 turn(glm::mat3_cast(glm::normalize(glm::quat(0.3f, 0.5f, -0.2f, 0.7f))));
    BentMesh bent;
    for (const glm::vec3& P : rest.P) bent.P.emplace_back(turn * glm::dvec3(P));
    for (std::uint32_t t = 0; t < rest.triangles.size(); ++t) {
        const MeshPoint point = mesh_point(rest, t, 0.3f, 0.3f);
        const glm::vec3 N(turn * glm::dvec3(point.N));
        const CarriedFrame frame(rest, bent, t, point.N, N);
        EXPECT_LT(glm::distance(frame.normal(point.N), N), 1e-6f);
        const glm::vec3 aslant = glm::normalize(point.N + glm::vec3(0.2f, 0.1f, -0.1f));
        EXPECT_LT(glm::distance(frame.normal(aslant), glm::vec3(turn * glm::dvec3(aslant))), 1e-5f);
        EXPECT_LT(glm::distance(frame.direction(aslant), glm::vec3(turn * glm::dvec3(aslant))),
                  1e-5f);
    }
}

TEST(CarriedFrame, TiltsNormalsLessOnWhatIsStretched) {
    Mesh rest;
    rest.P = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    rest.triangles = {{0, 1, 2}};
    BentMesh bent;
    bent.P = {{0, 0, 0}, {4, 0, 0}, {0, 1, 0}};
    const glm::vec3 z(0, 0, 1);
    const CarriedFrame frame(rest, bent, 0, z, z);
    const glm::vec3 n = frame.normal(glm::normalize(glm::vec3(0.4f, 0.4f, 1.0f)));
    EXPECT_NEAR(n.x / n.z, 0.1f, 1e-6f);  // a slope of 1 : 2.5 is one of 1 : 10 there
    EXPECT_NEAR(n.y / n.z, 0.4f, 1e-6f);
    EXPECT_EQ(frame.direction({1, 0, 0}), glm::vec3(4, 0, 0));
}

TEST(World, IsSeenFromTheOriginInDouble) {
    Scene scene = scene_of({ball(4)}, {glm::mat4(1.0f)});
    Node far, near;
    far.translation = {1e6 + 0.125, -5e5, 6.4e6 + 0.0625};
    near.parent = 1;
    near.translation = {0.001, 0.002, 0.003};
    scene.nodes.push_back(far);
    scene.nodes.push_back(near);
    const glm::dvec3 origin = place_of(scene, 1, 0.0);
    EXPECT_EQ(origin, far.translation);
    const glm::vec3 seen(pose_at(scene, 0.0, origin).world_from_node[2][3]);
    EXPECT_LT(glm::distance(seen, glm::vec3(0.001f, 0.002f, 0.003f)), 1e-8f);
}

}  // namespace
}  // namespace estara::test
