// Meshes as people have them: two as OBJ, one as PLY.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "../models/models.h"
#include "estara/scenes/load.h"

namespace estara {
namespace {

using test::expect_unit;
using test::signed_volume;
using test::smooth_share;

Scene model(const std::string& name) {
    const std::string path = std::string(ESTARA_MODELS) + "/" + name;
    EXPECT_TRUE(std::filesystem::exists(path)) << "the tests need " << path;
    return load_scene(path);
}

TEST(Models, AScanLoads) {
    const Scene scene = model("scan.obj");
    const Mesh& mesh = scene.objects.at(0).mesh;
    EXPECT_EQ(mesh.P.size(), 35952u);
    EXPECT_EQ(mesh.triangles.size(), 71238u);
    EXPECT_FALSE(mesh.has_uv());
    EXPECT_GT(signed_volume(mesh), 0.0);
    EXPECT_GT(smooth_share(mesh), 0.99);
    expect_unit(mesh.N);
}

TEST(Models, SpotLoadsWithTextureCoordinates) {
    const Scene scene = model("spot.obj");
    const Mesh& mesh = scene.objects.at(0).mesh;
    EXPECT_EQ(mesh.triangles.size(), 5856u);
    EXPECT_EQ(mesh.uv.size(), mesh.P.size());
    EXPECT_GT(signed_volume(mesh), 0.0);
    for (const glm::vec2& uv : mesh.uv) {
        EXPECT_LT(glm::distance(uv, glm::vec2(0.5f)), 0.8f);  // some lie just outside [0, 1]
    }
    expect_unit(mesh.N);
}

TEST(Models, AStripWithRestartsLoads) {
    const Scene scene = model("strips.ply");
    const Mesh& mesh = scene.objects.at(0).mesh;
    EXPECT_EQ(mesh.P.size(), 133646u);
    EXPECT_EQ(mesh.triangles.size(), 267288u);  // = 2 V - 4: closed, like a sphere
    EXPECT_GT(signed_volume(mesh), 0.0);
    EXPECT_GT(smooth_share(mesh), 0.99);
    expect_unit(mesh.N);
}

TEST(Models, ComeWithAnOrbitAndLights) {
    const Scene scene = model("spot.obj");
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.objects.at(0).name, "spot");
    EXPECT_EQ(scene.objects.at(0).shader->info().name, "plastic");
    EXPECT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.lights.size(), 2u);
    EXPECT_EQ(animated_frames(scene, 24).first, 1);
    EXPECT_EQ(animated_frames(scene, 24).last, 48);
}

TEST(DefaultOrbit, ShowsTheWholeObjectSquareAndWideInEveryFrame) {
    const Scene scene = model("spot.obj");
    for (int frame = 1; frame <= 48; ++frame) {
        const Pose pose = pose_at(scene, frame / 24.0);
        const PinholePose camera = pinhole_pose(scene, scene.cameras.at(0), pose);
        EXPECT_LT(camera.forward.y, 0.0f);  // from above
        float widest = 0.0f, highest = 0.0f;
        for (const glm::vec3& p : scene.objects.at(0).mesh.P) {
            const glm::vec3 d = p - camera.eye;
            const float depth = glm::dot(d, camera.forward) * camera.tan_half_yfov;
            ASSERT_GT(depth, 0.0f);
            widest = std::max(widest, std::abs(glm::dot(d, camera.right)) / depth);
            highest = std::max(highest, std::abs(glm::dot(d, camera.up)) / depth);
        }
        EXPECT_LT(widest, 1.0f) << frame;
        EXPECT_LT(highest, 1.0f) << frame;
        EXPECT_GT(std::max(widest, highest), 0.5f) << frame;  // and not tiny
    }
}

TEST(DefaultOrbit, TurnsByTheSameAngleEachFrameAndNeverRepeatsTheFirst) {
    const Scene scene = model("spot.obj");
    const auto forward = [&](int frame) {
        return pinhole_pose(scene, scene.cameras.at(0), pose_at(scene, frame / 24.0)).forward;
    };
    const float first_step = glm::distance(forward(1), forward(2));
    EXPECT_GT(first_step, 0.05f);
    for (int frame = 2; frame < 48; ++frame) {
        EXPECT_NEAR(glm::distance(forward(frame), forward(frame + 1)), first_step, 1e-4f) << frame;
    }
    EXPECT_NEAR(glm::distance(forward(48), forward(1)), first_step, 1e-4f);
}

TEST(DefaultLights, ExposeMidGreyFromBothSides) {
    const Scene scene = model("spot.obj");
    const Pose pose = pose_at(scene, 1.0 / 24.0);
    for (const glm::vec3 N : {glm::vec3(0, 0, 1), glm::vec3(0, 0, -1), glm::vec3(0, 1, 0)}) {
        glm::vec3 E(0.0f);
        for (const PosedLight& light : posed_lights(scene, pose)) {
            const LightSample sample = sample_light(light, glm::vec3(0));
            E += sample.Cl * std::max(0.0f, glm::dot(sample.L, N));
        }
        const float grey = 0.5f * (scene.ambient.r + 0.5f * E.r);  // plastic without its highlight
        EXPECT_GT(grey, 0.1f);
        EXPECT_LT(grey, 0.6f);
    }
}

}  // namespace
}  // namespace estara
