// What is read of glTF.
#include "gltf_file.h"

#include <gmock/gmock.h>

#include <numbers>

#include "estara/scenes/load.h"
#include "files.h"

namespace estara {
namespace {

using nlohmann::json;
using test::GltfFile;
using test::write_file;
using ::testing::Contains;
using ::testing::ElementsAre;

constexpr float pi = std::numbers::pi_v<float>;

class Gltf : public test::InFolder {
protected:
    GltfFile file;
    Scene load() {
        write_file("a.gltf", file.text());
        return load_scene("a.gltf");
    }
    Mesh mesh() { return load().objects.at(0).mesh; }
};

TEST_F(Gltf, ReadsASquareFromTextAndBinary) {
    file.square();
    const Scene scene = load();
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].name, "square");
    EXPECT_EQ(scene.objects[0].mesh.triangles.size(), 2u);
    EXPECT_DOUBLE_EQ(area(scene.objects[0].mesh), 1.0);
    EXPECT_TRUE(scene.objects[0].mesh.N.empty());  // flat, says the standard
    EXPECT_EQ(scene.objects[0].shader->info().name, "plastic");
    write_file("a.glb", file.binary());
    EXPECT_EQ(mesh_digest(load_scene("a.glb").objects.at(0).mesh),
              mesh_digest(scene.objects[0].mesh));
}

TEST_F(Gltf, ReadsABufferFromAFileBesideIt) {
    file.square();
    const std::string bytes = GltfFile::bytes_of<float>({0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0}) +
                              GltfFile::bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 3});
    std::filesystem::create_directory("sub");
    write_file("sub/my data.bin", bytes);
    file.json["buffers"] = {{{"byteLength", bytes.size()}, {"uri", "my%20data.bin"}}};
    write_file("sub/a.gltf", file.json.dump());
    EXPECT_DOUBLE_EQ(area(load_scene("sub/a.gltf").objects.at(0).mesh), 4.0);
}

TEST_F(Gltf, AddsCameraAndLightsAndSaysSo) {
    file.square();
    const Scene scene = load();
    EXPECT_THAT(
        scene.warnings,
        ElementsAre("a.gltf: no camera; one that goes round the scene in frames 1-48 is added",
                    "a.gltf: no light; a key and a fill light are added"));
    EXPECT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.lights.size(), 2u);
    EXPECT_GT(scene.ambient.r, 0.0f);
}

TEST_F(Gltf, LeavesASceneWithAmbientLightAsItIsLit) {
    file.square();
    file.json["scenes"][0]["extras"]["ambient"] = {0.1, 0.2, 0.3};
    const Scene scene = load();
    EXPECT_EQ(scene.ambient, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_TRUE(scene.lights.empty());
}

TEST_F(Gltf, ReadsIndicesOfEverySize) {
    const int mesh_index = file.square();
    for (const int order : {file.accessor<std::uint8_t>({0, 2, 1}, "SCALAR"),
                            file.accessor<std::uint16_t>({0, 2, 1}, "SCALAR"),
                            file.accessor<std::uint32_t>({0, 2, 1}, "SCALAR")}) {
        file.primitive(mesh_index)["indices"] = order;
        const Mesh read = mesh();
        ASSERT_EQ(read.triangles.size(), 1u);
        EXPECT_EQ(read.P.size(), 3u);  // the unused vertex is left out
        EXPECT_EQ(read.P[read.triangles[0].y], glm::vec3(1, 1, 0));
    }
}

TEST_F(Gltf, ReadsStripsFansAndListsWithAndWithoutIndices) {
    const int mesh_index = file.square();
    json& primitive = file.primitive(mesh_index);
    const auto expect_square = [&](int mode, const char* what) {
        primitive["mode"] = mode;
        const Mesh read = mesh();
        ASSERT_EQ(read.triangles.size(), 2u) << what;
        EXPECT_DOUBLE_EQ(area(read), 1.0) << what;
        for (std::uint32_t t = 0; t < 2; ++t) {
            EXPECT_EQ(mesh_point(read, t, 0.3f, 0.3f).Ng, glm::vec3(0, 0, 1)) << what;
        }
    };
    primitive["indices"] = file.accessor<std::uint16_t>({0, 1, 3, 2}, "SCALAR");
    expect_square(5, "strip with indices");
    primitive["indices"] = file.accessor<std::uint16_t>({0, 1, 2, 3}, "SCALAR");
    expect_square(6, "fan with indices");
    primitive.erase("indices");
    expect_square(6, "fan");
    primitive["attributes"]["POSITION"] =
        file.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3");
    expect_square(5, "strip");
    primitive["attributes"]["POSITION"] =
        file.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3");
    expect_square(4, "list");
}

TEST_F(Gltf, ReadsInterleavedAttributes) {
    const int mesh_index = file.square();
    // Position, then texture coordinates, then four bytes of something else: 24 a vertex.
    std::vector<float> values;
    for (const glm::vec2 p : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
        for (const float v : {p.x, p.y, 0.0f, 0.5f * p.x, 0.25f * p.y, -99.0f}) values.push_back(v);
    }
    const int view = file.view(GltfFile::bytes_of(values));
    file.json["bufferViews"][std::size_t(view)]["byteStride"] = 24;
    json& attributes = file.primitive(mesh_index)["attributes"];
    attributes["POSITION"] =
        file.add("accessors",
                 {{"bufferView", view}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
    attributes["TEXCOORD_0"] = file.add("accessors", {{"bufferView", view},
                                                      {"byteOffset", 12},
                                                      {"componentType", 5126},
                                                      {"count", 4},
                                                      {"type", "VEC2"}});
    const Mesh read = mesh();
    EXPECT_DOUBLE_EQ(area(read), 1.0);
    EXPECT_EQ(read.uv.at(2), glm::vec2(0.5f, 0.25f));
}

TEST_F(Gltf, ReadsNormalisedTextureCoordinatesAndQuantisedPositions) {
    const int mesh_index = file.square();
    json& attributes = file.primitive(mesh_index)["attributes"];
    const int uv = file.accessor<std::uint16_t>({0, 0, 65535, 0, 65535, 65535, 0, 13107}, "VEC2");
    file.json["accessors"][std::size_t(uv)]["normalized"] = true;
    attributes["TEXCOORD_0"] = uv;
    // Three of the four bytes or shorts of an element are used.
    const int view = file.view(
        GltfFile::bytes_of<std::int16_t>({0, 0, 0, 0, 9, 0, 0, 0, 9, 9, 0, 0, 0, 9, 0, 0}));
    file.json["bufferViews"][std::size_t(view)]["byteStride"] = 8;
    attributes["POSITION"] =
        file.add("accessors",
                 {{"bufferView", view}, {"componentType", 5122}, {"count", 4}, {"type", "VEC3"}});
    file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    const Mesh read = mesh();
    EXPECT_EQ(read.uv.at(2), glm::vec2(1, 1));
    EXPECT_EQ(read.uv.at(3), glm::vec2(0, 0.2f));
    EXPECT_DOUBLE_EQ(area(read), 81.0);
}

TEST_F(Gltf, AppliesSparseAccessors) {
    const int mesh_index = file.square();
    json& accessor = file.json["accessors"][0];
    accessor["sparse"] = {
        {"count", 2},
        {"indices",
         {{"bufferView", file.view(GltfFile::bytes_of<std::uint8_t>({1, 2}))},
          {"componentType", 5121}}},
        {"values", {{"bufferView", file.view(GltfFile::bytes_of<float>({5, 0, 0, 5, 1, 0}))}}}};
    EXPECT_DOUBLE_EQ(area(mesh()), 5.0);
    // Without a buffer the others are zero: one triangle has no area, the other half of five.
    file.primitive(mesh_index)["attributes"]["POSITION"] = 0;
    file.json["accessors"][0].erase("bufferView");
    EXPECT_DOUBLE_EQ(area(mesh()), 2.5);
}

TEST_F(Gltf, MakesOneObjectOfAMeshUnderSeveralNodesAndOneOfEachPrimitive) {
    const int mesh_index = file.square();
    file.node({{"name", "again"}, {"mesh", mesh_index}, {"translation", {5, 0, 0}}});
    const json primitive = file.primitive(mesh_index);
    file.json["meshes"][std::size_t(mesh_index)]["primitives"].push_back(primitive);
    file.add("meshes", {{"name", "square"}, {"primitives", {primitive}}});
    file.node({{"mesh", 1}});
    const Scene scene = load();
    ASSERT_EQ(scene.objects.size(), 3u);
    EXPECT_EQ(scene.objects[0].name, "square");
    EXPECT_EQ(scene.objects[1].name, "square_2");
    EXPECT_EQ(scene.objects[2].name, "square_3");
    EXPECT_EQ(scene.objects[2].mesh_name, "square");
    EXPECT_EQ(scene.instances.size(), 5u);
}

TEST_F(Gltf, PutsParentsFirstAndKeepsMatricesAndMirrors) {
    file.square();
    file.json["nodes"] = {{{"name", "leaf"}, {"mesh", 0}, {"scale", {-1, 1, 1}}},
                          {{"name", "unused"}, {"mesh", 0}},
                          {{"name", "root"},
                           {"children", {3}},
                           {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1}}},
                          {{"name", "middle"}, {"children", {0}}, {"translation", {1, 2, 3}}}};
    file.json["scenes"][0]["nodes"] = {2};
    const Scene scene = load();
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) EXPECT_LT(scene.nodes[i].parent, int(i));
    ASSERT_EQ(scene.instances.size(), 1u);
    const glm::mat4 world = pose_at(scene, 0).world_from_node[std::size_t(scene.instances[0].node)];
    EXPECT_EQ(glm::vec3(world * glm::vec4(1, 0, 0, 1)), glm::vec3(10, 22, 33));
    EXPECT_LT(glm::determinant(world), 0.0f);
}

TEST_F(Gltf, ShowsTheFilesSceneOrElseTheFirst) {
    file.square();
    file.node({{"mesh", 0}});
    file.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {0, 1}}}};
    file.json["scene"] = 1;
    EXPECT_EQ(load().instances.size(), 2u);
    file.json.erase("scene");
    EXPECT_EQ(load().instances.size(), 1u);
    file.json.erase("scenes");
    EXPECT_EQ(load().instances.size(), 2u);
}

TEST_F(Gltf, GoesDownDeepHierarchies) {
    file.square();
    for (int i = 0; i < 20000; ++i) {
        file.add("nodes", {{"children", {i}}, {"translation", {1, 0, 0}}});
    }
    file.json["scenes"][0]["nodes"] = {20000};
    const Scene scene = load();
    EXPECT_EQ(pose_at(scene, 0).world_from_node[20000][3].x, 20000.0f);
}

TEST_F(Gltf, ReadsCameras) {
    file.square();
    file.json["cameras"] = {
        {{"type", "perspective"},
         {"name", "lens"},
         {"perspective", {{"yfov", 0.6}, {"znear", 0.1}}}},
        {{"type", "orthographic"},
         {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 9}}}}};
    file.node({{"name", "tripod"}, {"camera", 0}, {"translation", {0, 0, 4}}});
    file.node({{"camera", 1}});
    const Scene scene = load();
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].name, "lens");
    EXPECT_FLOAT_EQ(scene.cameras[0].yfov, 0.6f);
    EXPECT_EQ(pinhole_pose(scene, scene.cameras[0], pose_at(scene, 0)).eye, glm::vec3(0, 0, 4));
    EXPECT_THAT(scene.warnings, Contains("a.gltf: not shown: 1 orthographic cameras"));
}

TEST_F(Gltf, ReadsPunctualLights) {
    file.square();
    file.json["extensionsRequired"] = {"KHR_lights_punctual"};
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "directional"}, {"name", "sun"}, {"color", {1, 0.5, 0}}, {"intensity", 3}},
        {{"type", "point"}, {"intensity", 683}, {"range", 7}},
        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}}};
    for (int i = 0; i < 3; ++i) {
        file.node({{"name", "lamp"}, {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
    }
    const Scene scene = load();
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].type, LightType::directional);
    EXPECT_EQ(scene.lights[0].name, "sun");
    EXPECT_EQ(scene.lights[0].color, glm::vec3(1, 0.5f, 0));
    EXPECT_EQ(scene.lights[0].intensity, 3.0f);
    EXPECT_EQ(scene.lights[1].type, LightType::point);
    EXPECT_EQ(scene.lights[1].name, "lamp");
    EXPECT_EQ(scene.lights[1].range, 7.0f);
    EXPECT_EQ(scene.lights[2].type, LightType::spot);
    EXPECT_FLOAT_EQ(scene.lights[2].inner_cone, 0.1f);
    EXPECT_FLOAT_EQ(scene.lights[2].outer_cone, 0.2f);
    EXPECT_EQ(scene.lights[2].intensity, 1.0f);
    EXPECT_EQ(scene.ambient, glm::vec3(0));
}

TEST_F(Gltf, ReadsAnimationOfEveryKind) {
    file.square();
    const int times = file.accessor<float>({1, 2}, "SCALAR");
    const int turn = file.accessor<std::int16_t>({0, 0, 0, 32767, 0, 32767, 0, 0}, "VEC4");
    file.json["accessors"][std::size_t(turn)]["normalized"] = true;
    const int path =
        file.accessor<float>({0, 0, 0, 1, 0, 0, 1, 0, 0, /**/ 1, 0, 0, 2, 0, 0, 0, 0, 0}, "VEC3");
    const int size = file.accessor<float>({1, 1, 1, 2, 2, 2}, "VEC3");
    file.json["animations"] = {
        {{"name", "move"},
         {"samplers",
          {{{"input", times}, {"output", turn}},
           {{"input", times}, {"output", path}, {"interpolation", "CUBICSPLINE"}},
           {{"input", times}, {"output", size}, {"interpolation", "STEP"}}}},
         {"channels",
          {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "rotation"}}}},
           {{"sampler", 1}, {"target", {{"node", 0}, {"path", "translation"}}}},
           {{"sampler", 2}, {"target", {{"node", 0}, {"path", "scale"}}}}}}}};
    const Scene scene = load();
    const glm::mat4 world = pose_at(scene, 1.5).world_from_node[0];
    EXPECT_NEAR(world[3].x, 1.5f, 1e-6f);
    EXPECT_NEAR(glm::length(glm::vec3(world[0])), 1.0f, 1e-6f);
    EXPECT_NEAR(world[0].z, -1.0f, 1e-6f);  // half of half a turn about y
    EXPECT_NEAR(glm::length(glm::vec3(pose_at(scene, 2).world_from_node[0][1])), 2.0f, 1e-6f);
    EXPECT_EQ(animated_frames(scene, 24).first, 1);  // the added camera's
    EXPECT_EQ(animated_frames(scene, 24).last, 48);
}

TEST_F(Gltf, DressesInTheShaderOfTheExtras) {
    file.primitive(file.square())["material"] = file.add(
        "materials", {{"name", "table"},
                      {"extras",
                       {{"shader", "wood"},
                        {"params", {{"ringscale", 12}, {"lightwood", {0.5, 0.25, 0.125}}}}}}});
    const Object object = load().objects.at(0);
    EXPECT_TRUE(object.wears_shader());
    EXPECT_EQ(object.choice.where, "a.gltf: material \"table\"");
    EXPECT_EQ(object.shader->info().name, "wood");
    EXPECT_EQ(object.shader->values().at(0).x, 12.0f);
    EXPECT_EQ(object.shader->values().at(1), glm::vec3(0.5f, 0.25f, 0.125f));
}

TEST_F(Gltf, DressesInTheShaderThatTheMaterialIsNamedAfter) {
    json& material = file.primitive(file.square())["material"];
    const auto shader_of = [&](const char* name) {
        material = file.add("materials", {{"name", name}});
        const Object object = load().objects.at(0);
        return object.wears_shader() ? object.choice.name : "none";
    };
    EXPECT_EQ(shader_of("wood"), "wood");
    EXPECT_EQ(shader_of("wood.001"), "wood");
    EXPECT_EQ(shader_of("wood."), "none");
    EXPECT_EQ(shader_of("wood.old"), "none");
    EXPECT_EQ(shader_of("Driftwood"), "none");
    EXPECT_EQ(shader_of(""), "none");
}

TEST_F(Gltf, ShowsTheColourFactorWithoutAShader) {
    file.primitive(file.square())["material"] = file.add(
        "materials",
        {{"name", "red"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.75, 0.5, 0.25, 1}}}}});
    const Object object = load().objects.at(0);
    EXPECT_FALSE(object.wears_shader());
    EXPECT_EQ(object.base_color, glm::vec3(0.75f, 0.5f, 0.25f));
    EXPECT_EQ(object.shader->info().name, "plastic");
    EXPECT_EQ(object.shader->values().at(5), glm::vec3(0.75f, 0.5f, 0.25f));  // Cs
}

TEST_F(Gltf, MakesNormalsUnitAndMendsThoseThatAreZero) {
    file.primitive(file.square())["attributes"]["NORMAL"] =
        file.accessor<float>({0, 0, 2, 0, 3, 4, 0, 0, 0, 0, 0, 1}, "VEC3");
    const Mesh read = mesh();
    EXPECT_EQ(read.N.at(0), glm::vec3(0, 0, 1));
    EXPECT_NEAR(glm::distance(read.N.at(1), glm::vec3(0, 0.6f, 0.8f)), 0.0f, 1e-6f);
    EXPECT_EQ(read.N.at(2), glm::vec3(0, 0, 1));
}

TEST_F(Gltf, NeverLooksAtImages) {
    file.json["images"] = {{{"uri", "gone.png"}},
                           {{"bufferView", file.view("not a png")}, {"mimeType", "image/png"}}};
    file.json["textures"] = {{{"source", 0}}};
    file.primitive(file.square())["material"] =
        file.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    EXPECT_THAT(
        load().warnings,
        Contains("a.gltf: not shown: colour textures (the colour factor is) of \"square\""));
}

TEST_F(Gltf, SaysWhatOfTheFileIsNoGltf) {
    file.json["meshes"][std::size_t(file.square())]["primitives"].push_back({{"mode", 4}});
    EXPECT_THAT(load().warnings, Contains("a.gltf: in part not glTF, and left out: 'attributes' "
                                          "property is missing in Primitive."));
}

TEST_F(Gltf, SaysWhatItDoesNotShow) {
    const int mesh_index = file.square();
    json& mesh_json = file.json["meshes"][std::size_t(mesh_index)];
    mesh_json["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
    file.json["nodes"][0]["skin"] = 0;
    file.json["skins"] = {{{"joints", {0}}}};
    const int times = file.accessor<float>({0, 1}, "SCALAR");
    const json animation = {
        {"samplers",
         {{{"input", times}, {"output", file.accessor<float>({0, 0, 0, 1, 0, 0}, "VEC3")}}}},
        {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}};
    json weights = animation;
    weights["channels"][0]["target"]["path"] = "weights";
    file.json["animations"] = {animation, animation, weights};
    EXPECT_THAT(
        load().warnings,
        ElementsAre(
            "a.gltf: animation 1: 1 channels move what an earlier animation moves; not shown",
            "a.gltf: animation 2: 1 channels move neither place, rotation, scale nor shape; not "
            "shown",
            "a.gltf: mesh \"square\": its node has a skin, but its vertices follow no joints; "
            "shown "
            "without",
            "a.gltf: not shown: 1 primitives of points or lines",
            "a.gltf: no camera; one that goes round the scene in frames 1-48 is added",
            "a.gltf: no light; a key and a fill light are added"));
}

}  // namespace
}  // namespace estara
