// Where glTF files put their meshes, and what they say in places where nobody looks.
#include <gmock/gmock.h>

#include "estara/scenes/load.h"
#include "files.h"
#include "gltf_file.h"

namespace estara {
namespace {

using nlohmann::json;
using test::GltfFile;
using ::testing::Contains;
using ::testing::HasSubstr;

class GltfPlacement : public test::InFolder {
protected:
    GltfFile file;
    Scene load() {
        test::write_file("a.gltf", file.text());
        return load_scene("a.gltf");
    }
    std::string error() {
        return test::message_of([&] { load(); });
    }
    /// World positions of an instance's vertices.
    static std::vector<glm::vec3> world(const Scene& scene, std::size_t instance) {
        const Pose pose = pose_at(scene, 0.0);
        std::vector<glm::vec3> P;
        for (const glm::vec3& p : placed_vertices(scene, pose, instance)) {
            P.emplace_back(pose.world_from_instance[instance] * glm::vec4(p, 1.0f));
        }
        return P;
    }
};

void expect_near(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT(glm::distance(a[i], b[i]), 1e-5f) << i;
}

TEST_F(GltfPlacement, HidesNodesAndAllBelowThemButNoCamera) {
    file.square();
    const int below = file.add("nodes", {{"mesh", 0}});
    file.json["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    file.node({{"mesh", 0},
               {"camera", 0},
               {"children", {below}},
               {"extensions",
                {{"KHR_node_visibility", {{"visible", false}}},
                 {"KHR_lights_punctual", {{"light", 0}}}}}});
    file.json["extensionsRequired"] = {"KHR_node_visibility"};
    const Scene scene = load();
    EXPECT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.cameras.size(), 1u);
    for (const SceneLight& light : scene.lights) EXPECT_NE(light.type, LightType::point);
}

TEST_F(GltfPlacement, ShowsAMeshOnceForEachInstanceOfItsNode) {
    file.square();
    const int t = file.accessor<float>({1, 0, 0, 0, 2, 0, 0, 0, 3}, "VEC3");
    const int s = file.accessor<float>({1, 1, 1, 2, 2, 2, 1, 1, 1}, "VEC3");
    const int r = file.accessor<std::int8_t>({0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 127, 0}, "VEC4");
    file.json["accessors"][std::size_t(r)]["normalized"] = true;
    file.json["nodes"][0]["translation"] = {10, 0, 0};
    file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", t}, {"ROTATION", r}, {"SCALE", s}};
    file.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    const Scene scene = load();
    ASSERT_EQ(scene.instances.size(), 3u);
    EXPECT_EQ(scene.objects.size(), 1u);
    expect_near(world(scene, 0), {{11, 0, 0}, {12, 0, 0}, {12, 1, 0}, {11, 1, 0}});
    expect_near(world(scene, 1), {{10, 2, 0}, {12, 2, 0}, {12, 4, 0}, {10, 4, 0}});
    expect_near(world(scene, 2), {{10, 0, 3}, {9, 0, 3}, {9, -1, 3}, {10, -1, 3}});
    file.json["accessors"][std::size_t(s)]["count"] = 2;
    EXPECT_THAT(error(), HasSubstr("EXT_mesh_gpu_instancing: 2 of SCALE for 3 instances"));
}

TEST_F(GltfPlacement, QuantisedMeshesAreThoseOfTheirFloats) {
    file.square();
    const Scene floats = load();
    const int P = file.accessor<std::uint16_t>(
        {0, 0, 0, 0, 16383, 0, 0, 0, 16383, 16383, 0, 0, 0, 16383, 0, 0}, "VEC4");
    json& accessor = file.json["accessors"][std::size_t(P)];
    accessor["type"] = "VEC3";
    file.json["bufferViews"][accessor["bufferView"].get<std::size_t>()]["byteStride"] = 8;
    file.primitive(0)["attributes"]["POSITION"] = P;
    const double step = 1.0 / 16383.0;
    file.json["nodes"][0]["scale"] = {step, step, step};
    file.json["nodes"][0].erase("name");
    const Scene scene = load();
    expect_near(scene.objects[0].mesh.P, floats.objects[0].mesh.P);
    expect_near(world(scene, 0), world(floats, 0));
    // The node's offset is the mesh's too, unless the node turns or moves.
    file.json["nodes"][0]["translation"] = {-2, 0, 0};
    expect_near(load().objects[0].mesh.P, {{-2, 0, 0}, {-1, 0, 0}, {-1, 1, 0}, {-2, 1, 0}});
    file.json["nodes"][0]["rotation"] = {0, 0, 1, 0};
    const Scene turned = load();
    expect_near(turned.objects[0].mesh.P, floats.objects[0].mesh.P);
    expect_near(world(turned, 0), {{-2, 0, 0}, {-3, 0, 0}, {-3, -1, 0}, {-2, -1, 0}});
}

TEST_F(GltfPlacement, WarnsOfShadersWhereNobodyLooks) {
    file.square();
    file.json["materials"] = {
        {{"name", "Wood.001"}},
        {{"name", "m"},
         {"extras", {{"shader", "wood"}, {"ringscale", 4}, {"Kd", 1}, {"note", 1}}}}};
    file.primitive(0)["material"] = 0;
    file.json["nodes"][0]["extras"]["shader"] = "wood";
    file.json["meshes"][0]["extras"]["params"] = json::object();
    file.json["meshes"].push_back(file.json["meshes"][0]);
    file.json["meshes"][1].erase("extras");
    file.json["meshes"][1]["primitives"][0]["material"] = 1;
    file.node({{"mesh", 1}});
    const auto warnings = load().warnings;
    EXPECT_THAT(warnings, Contains("a.gltf: material \"Wood.001\": wears no shader; its name would "
                                   "have to be \"wood\""));
    EXPECT_THAT(warnings, Contains("a.gltf: node \"square node\": extras \"shader\" not used; a "
                                   "shader is named in the extras of the material"));
    EXPECT_THAT(warnings,
                Contains("a.gltf: mesh \"square\": extras \"params\" not used; a shader is "
                         "named in the extras of the material"));
    EXPECT_THAT(
        warnings,
        Contains("a.gltf: material \"m\": \"Kd\", \"ringscale\" beside \"shader\": not used; "
                 "parameters go into \"params\": {...}"));
}

TEST_F(GltfPlacement, SaysWhatCompressionToLeaveOut) {
    file.square();
    json& primitive = file.primitive(0);
    primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
    EXPECT_EQ(load().instances.size(), 1u);  // there is an uncompressed form as well
    for (json& accessor : file.json["accessors"]) accessor.erase("bufferView");
    EXPECT_EQ(
        error(),
        "a.gltf: mesh \"square\": compressed by KHR_draco_mesh_compression, which is not read; "
        "export it without compression");
}

}  // namespace
}  // namespace estara
