// Finding things by name, and binding shaders.
#include "estara/scenes/scene.h"

#include <gtest/gtest.h>

#include "files.h"

namespace estara {
namespace {

using test::message_of;

/// Three objects: "vase" wears wood, "table" wears stone, "floor" nothing.
Scene room() {
    Scene scene;
    scene.path = "room.glb";
    const char* names[] = {"vase", "table", "floor"};
    const char* shaders[] = {"wood", "stone", ""};
    for (int i = 0; i < 3; ++i) {
        Object object;
        object.name = names[i];
        object.mesh_name = std::string("Mesh ") + names[i];
        object.choice.name = shaders[i];
        scene.objects.push_back(object);
        Node node;
        node.name = std::string("node.") + names[i];
        scene.nodes.push_back(node);
        scene.instances.push_back({i, i});
    }
    scene.cameras = {{"left", 0, 0.8f}, {"right", 1, 0.8f}};
    return scene;
}

using Indices = std::vector<int>;

TEST(SelectObjects, TakesThoseThatWearTheShader) {
    EXPECT_EQ(select_objects(room(), "wood", {}), Indices{0});
    EXPECT_EQ(select_objects(room(), "stone", {}), Indices{1});
}

TEST(SelectObjects, TakesAllIfNoneWearsAny) {
    Scene scene = room();
    for (Object& object : scene.objects) object.choice.name.clear();
    EXPECT_EQ(select_objects(scene, "wood", {}), (Indices{0, 1, 2}));
}

TEST(SelectObjects, KnowsObjectMeshAndNodeNames) {
    EXPECT_EQ(select_objects(room(), "wood", {"floor"}), Indices{2});
    EXPECT_EQ(select_objects(room(), "wood", {"Mesh table"}), Indices{1});
    EXPECT_EQ(select_objects(room(), "wood", {"node.floor"}), Indices{2});
}

TEST(SelectObjects, UnderstandsStarAndQuestionMarkAndNothingElse) {
    EXPECT_EQ(select_objects(room(), "wood", {"*"}), (Indices{0, 1, 2}));
    EXPECT_EQ(select_objects(room(), "wood", {"*l*"}), (Indices{1, 2}));
    EXPECT_EQ(select_objects(room(), "wood", {"?????"}), (Indices{1, 2}));
    EXPECT_EQ(select_objects(room(), "wood", {"n*e.*s?", "floor"}), (Indices{0, 2}));
    EXPECT_EQ(message_of([] { select_objects(room(), "wood", {"[v]ase"}); }),
              "room.glb: --object '[v]ase' matches nothing; the scene has: vase, table, floor");
    EXPECT_EQ(message_of([] { select_objects(room(), "wood", {"vas"}); }),
              "room.glb: --object 'vas' matches nothing; the scene has: vase, table, floor");
}

TEST(SelectObjects, SaysWhatWearsSomethingElse) {
    EXPECT_EQ(message_of([] { select_objects(room(), "greenmarble", {}); }),
              "room.glb: no object wears shader 'greenmarble'; with a shader there are: vase "
              "(wood), table (stone); choose one with --object");
}

TEST(FindCamera, KnowsNamesAndTakesTheFirstForNone) {
    EXPECT_EQ(find_camera(room(), ""), 0);
    EXPECT_EQ(find_camera(room(), "right"), 1);
    EXPECT_EQ(message_of([] { find_camera(room(), "top"); }),
              "room.glb: no camera 'top'; the scene has: node.vase (left), node.table (right)");
    Scene dark = room();
    dark.cameras.clear();
    EXPECT_EQ(message_of([&] { find_camera(dark, ""); }), "room.glb: the scene has no camera");
}

TEST(FindCamera, TakesTheNodesNameFirstAndNoneThatIsAmbiguous) {
    Scene scene = room();  // as Blender writes it: all cameras' data are named alike
    scene.nodes[std::size_t(scene.cameras[0].node)].name = "Camera";
    for (SceneCamera& camera : scene.cameras) camera.name = "Camera";
    scene.cameras[1].node = int(scene.nodes.size());
    scene.nodes.emplace_back().name = "Camera.001";
    EXPECT_EQ(find_camera(scene, "Camera"), 0);
    EXPECT_EQ(find_camera(scene, "Camera.001"), 1);
    scene.nodes[std::size_t(scene.cameras[0].node)].name = "front";
    EXPECT_EQ(message_of([&] { find_camera(scene, "Camera"); }),
              "room.glb: 2 cameras 'Camera'; the scene has: front (Camera), Camera.001 (Camera)");
}

TEST(BindChoice, TakesTheSettings) {
    const BoundShaderPtr shader = bind_choice({"wood", {{"ringscale", {12}}}, "here"}, false);
    EXPECT_EQ(shader->info().name, "wood");
    EXPECT_EQ(shader->values().at(0).x, 12.0f);
}

TEST(BindChoice, SaysAllThatIsWrongAndWhere) {
    const ShaderChoice choice{
        "plastic", {{"Kq", {1}}, {"roughness", {-3}}}, "a.glb: material \"m\""};
    EXPECT_EQ(
        message_of([&] { bind_choice(choice, false); }),
        "a.glb: material \"m\": shader 'plastic' has no parameter 'Kq'; did you mean 'Ka'? it "
        "has: Ka, Kd, Ks, roughness, specularcolor, Cs\n"
        "a.glb: material \"m\": shader 'plastic': 'roughness' = -3 is outside [0.001, 1]");
}

}  // namespace
}  // namespace estara
