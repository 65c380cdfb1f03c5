// Real scans, where they are there.
#include <gtest/gtest.h>

#include "estara/bake/bake.h"
#include "models.h"

namespace estara {
namespace {

Scene scan(const std::string& name) {
    return load_scene(std::string(ESTARA_REAL_MODELS) + "/" + name);
}

void expect_good(const Mesh& mesh) {
    EXPECT_GT(test::signed_volume(mesh), 0.0);
    EXPECT_GT(test::smooth_share(mesh), 0.99);
    test::expect_unit(mesh.N);
}

TEST(RealModels, BunnyLoads) {
    const Scene scene = scan("stanford-bunny.obj");
    const Mesh& mesh = scene.objects.at(0).mesh;
    EXPECT_EQ(mesh.triangles.size(), 69451u);
    EXPECT_FALSE(mesh.has_uv());
    expect_good(mesh);
}

TEST(RealModels, IgeaLoadsFromItsTriangleStrip) {
    const Scene scene = scan("igea.ply");
    const Mesh& mesh = scene.objects.at(0).mesh;
    EXPECT_EQ(mesh.P.size(), 134345u);
    EXPECT_EQ(mesh.triangles.size(), 268686u);  // = 2 V - 4: closed, like a sphere
    expect_good(mesh);
}

TEST(RealModels, ABakeHolds) {
    for (const char* name : {"stanford-bunny.obj", "igea.ply"}) {
        const Scene scene = scan(name);
        const Mesh& mesh = scene.objects[0].mesh;
        const double size = double(bounds(mesh).diagonal()) / 300.0;
        const Setting rings{"ringscale", {float(0.02 / size)}};  // a ring every 50 voxels
        const BoundShaderPtr shader = bind_shader("wood", std::span(&rings, 1), false).shader;
        const TextureGrid grid = bake_mesh(mesh, *shader, size, false);
        const auto errors = measure_error(mesh, *shader, grid, 50000, 1);
        EXPECT_LT(errors[0].rmse, 0.004) << name;
        EXPECT_LT(errors[0].max, 0.26) << name;
    }
}

}  // namespace
}  // namespace estara
