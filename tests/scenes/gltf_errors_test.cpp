// glTF files that are wrong: each fails with a message, whole, and never otherwise.
#include <limits>

#include "estara/scenes/load.h"
#include "files.h"
#include "gltf_file.h"

namespace estara {
namespace {

using nlohmann::json;
using test::GltfFile;
using test::message_of;
using test::write_file;

class GltfError : public test::InFolder {
protected:
    GltfFile file;
    int square = file.square();
    json& primitive() { return file.primitive(square); }

    static std::string loading(const std::string& text) {
        write_file("a.gltf", text);
        return message_of([] { load_scene("a.gltf"); });
    }
    std::string message() { return loading(file.text()); }
};

TEST_F(GltfError, OfJson) {
    EXPECT_EQ(loading(""), "a.gltf: the file is empty");
    EXPECT_EQ(loading("solid vase"),
              "a.gltf: not glTF: it starts neither with { nor as a .glb does");
    EXPECT_EQ(loading("{\n\"a\": [1,\n2,,]}"), "a.gltf: broken JSON in line 3, near '2,,'");
    EXPECT_EQ(loading("{\"a\": 1, \"b\": 2, \"a\": 3}"), "a.gltf: the key \"a\" is given twice");
    EXPECT_EQ(loading(std::string(100000, '[')), "a.gltf: JSON nested more than 200 deep");
    EXPECT_EQ(loading("[1, 2]"),
              "a.gltf: cannot be read as glTF: Root element is not a JSON object");
    EXPECT_EQ(
        loading("{\"nodes\": []}"),
        "a.gltf: cannot be read as glTF: \"asset\" object not found in .gltf or not an object "
        "type");
}

TEST_F(GltfError, OfRequiredExtensionsNamesAllOfThem) {
    file.json["extensionsRequired"] = {"KHR_draco_mesh_compression", "KHR_lights_punctual",
                                       "EXT_meshopt_compression", "KHR_materials_unlit"};
    EXPECT_EQ(message(),
              "a.gltf: it requires KHR_draco_mesh_compression, EXT_meshopt_compression, which is "
              "not supported; export it without");
}

TEST_F(GltfError, OfATruncatedBinary) {
    const std::string whole = file.binary();
    const auto load_cut = [&](std::size_t size) {
        write_file("a.glb", whole.substr(0, size));
        return message_of([] { load_scene("a.glb"); });
    };
    EXPECT_EQ(load_cut(whole.size()), "no error");
    EXPECT_EQ(load_cut(10), "a.glb: truncated: 10 bytes are too short for a .glb");
    EXPECT_EQ(load_cut(500), "a.glb: truncated: its header says " + std::to_string(whole.size()) +
                                 " bytes, the file has 500");
    for (std::size_t size = 0; size < whole.size(); ++size) {
        EXPECT_EQ(load_cut(size).find("a.glb: "), 0u) << size;
    }
}

TEST_F(GltfError, OfADamagedBinaryIsNoCrash) {
    const std::string whole = file.binary();
    const char values[] = {'\0', '\xff', '9', '-', '"'};
    for (std::size_t at = 0; at < whole.size(); at += 2) {
        std::string damaged = whole;
        damaged[at] = values[at / 2 % std::size(values)];
        write_file("a.glb", damaged);
        const std::string text = message_of([] { load_scene("a.glb"); });
        if (text != "no error") {
            EXPECT_EQ(text.find("a.glb: "), 0u) << at << ": " << text;
        }
    }
}

TEST_F(GltfError, OfVersionOne) {
    std::string old = file.binary();
    old[4] = 1;
    write_file("a.glb", old);
    EXPECT_EQ(message_of([] { load_scene("a.glb"); }),
              "a.glb: glTF version 1; this reads version 2");
}

TEST_F(GltfError, OfIndicesOutOfRange) {
    primitive()["attributes"]["POSITION"] = 77;
    EXPECT_EQ(message(),
              "a.gltf: mesh \"square\": POSITION: there is no accessor 77; the file has 2, counted "
              "from 0");
    primitive()["attributes"]["POSITION"] = 0;
    primitive()["indices"] = file.accessor<std::uint16_t>({0, 1, 4}, "SCALAR");
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": there is no vertex 4; it has 4, counted from 0");
    primitive()["indices"] = -7;
    EXPECT_EQ(message(),
              "a.gltf: mesh \"square\": there is no accessor -7; the file has 3, counted from 0");
    primitive()["indices"] = 1;
    primitive()["material"] = 3;
    EXPECT_EQ(message(),
              "a.gltf: mesh \"square\": there is no material 3; the file has 0, counted from 0");
    primitive().erase("material");
    file.json["nodes"][0]["mesh"] = 5;
    EXPECT_EQ(message(), "a.gltf: there is no mesh 5; the file has 1, counted from 0");
    file.json["nodes"][0]["mesh"] = 0;
    file.json["nodes"][0]["camera"] = 0;
    EXPECT_EQ(message(), "a.gltf: there is no camera 0; the file has 0, counted from 0");
    file.json["nodes"][0].erase("camera");
    file.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 2;
    EXPECT_EQ(message(), "a.gltf: there is no light 2; the file has 0, counted from 0");
    file.json["nodes"][0].erase("extensions");
    file.json["nodes"][0]["children"] = {9};
    EXPECT_EQ(message(), "a.gltf: there is no node 9; the file has 1, counted from 0");
    file.json["nodes"][0].erase("children");
    file.json["scene"] = 4;
    EXPECT_EQ(message(), "a.gltf: there is no scene 4; the file has 1, counted from 0");
}

TEST_F(GltfError, OfAccessorsBeyondTheirBuffer) {
    const std::string beyond = " elements reach beyond their buffer; is it truncated?";
    json& accessor = file.json["accessors"][0];
    accessor["count"] = 400;
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": POSITION: 400" + beyond);
    accessor["count"] = std::numeric_limits<std::uint64_t>::max();
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": POSITION: 18446744073709551615" + beyond);
    accessor["count"] = 4;
    accessor["byteOffset"] = std::numeric_limits<std::uint64_t>::max() - 3;
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": POSITION: 4" + beyond);
    accessor.erase("byteOffset");
    json& view = file.json["bufferViews"][0];
    const json good = view;
    view["byteLength"] = std::numeric_limits<std::uint64_t>::max();
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": POSITION: 4" + beyond);
    view = good;
    view["byteOffset"] = 100000;
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": POSITION: 4" + beyond);
    view = good;
    view["buffer"] = 3;
    EXPECT_EQ(
        message(),
        "a.gltf: mesh \"square\": POSITION: there is no buffer 3; the file has 1, counted from 0");
    view = good;
    accessor["bufferView"] = 8;
    EXPECT_EQ(
        message(),
        "a.gltf: mesh \"square\": POSITION: there is no buffer view 8; the file has 2, counted "
        "from 0");
    accessor.erase("bufferView");
    accessor["count"] = 1u << 30;
    EXPECT_EQ(message(),
              "a.gltf: mesh \"square\": POSITION: 1073741824 elements without a buffer; at most "
              "67108864 are read");
}

TEST_F(GltfError, OfAttributes) {
    primitive()["attributes"]["NORMAL"] = file.accessor<float>({0, 0, 1}, "VEC3");
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": 1 normals for 4 vertices");
    primitive()["attributes"].erase("NORMAL");
    primitive()["attributes"]["TEXCOORD_0"] = file.accessor<float>({0, 0}, "VEC2");
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": 1 texture coordinates for 4 vertices");
    primitive()["attributes"]["TEXCOORD_0"] = 0;
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": TEXCOORD_0: 3 numbers an element; it needs 2");
    primitive()["attributes"].erase("TEXCOORD_0");
    primitive()["indices"] = file.accessor<float>({0, 1, 2}, "SCALAR");
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": indices must be unsigned integers");
    primitive()["indices"] = 0;
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": indices must be single numbers, and not sparse");
    primitive()["indices"] = file.accessor<std::uint16_t>({0, 1}, "SCALAR");
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": no triangles");
    primitive()["indices"] = 1;
    primitive()["attributes"] = {{"COLOR_0", 0}};
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": there is no vertex 0; it has 0, counted from 0");
    file.json["accessors"][0]["componentType"] = 5124;
    primitive()["attributes"] = {{"POSITION", 0}};
    EXPECT_EQ(message(),
              "a.gltf: mesh \"square\": POSITION: component type 5124 is none of glTF's");
}

TEST_F(GltfError, OfNumbersThatAreNotFinite) {
    primitive()["attributes"]["POSITION"] = file.accessor<float>(
        {0, 0, 0, 1, std::numeric_limits<float>::quiet_NaN(), 0, 1, 1, 0, 0, 1, 0}, "VEC3");
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": POSITION 1: nan is not a finite number");
    primitive()["attributes"]["POSITION"] = 0;
    file.json["nodes"][0]["translation"] = {0, 1e300, 0};
    EXPECT_EQ(message(), "a.gltf: node \"square node\": \"translation\" is not finite");
}

TEST_F(GltfError, OfSparseAccessors) {
    json& sparse = file.json["accessors"][0]["sparse"];
    sparse = {{"count", 1},
              {"indices", {{"bufferView", file.view("\7")}, {"componentType", 5121}}},
              {"values", {{"bufferView", file.view(std::string(12, '\0'))}}}};
    EXPECT_EQ(message(),
              "a.gltf: mesh \"square\": POSITION: sparse index 7 is out of range; there are 4 "
              "elements");
    sparse["count"] = 3;
    EXPECT_EQ(message(),
              "a.gltf: mesh \"square\": POSITION: 3 elements reach beyond their buffer; is it "
              "truncated?");
    sparse["count"] = -3;
    EXPECT_EQ(message(), "a.gltf: mesh \"square\": POSITION: -3 sparse elements of 4");
}

TEST_F(GltfError, OfNodes) {
    json& node = file.json["nodes"][0];
    node["rotation"] = {0, 0, 1};
    EXPECT_EQ(message(), "a.gltf: node \"square node\": 3 numbers in \"rotation\"; it needs 4");
    node["rotation"] = {0, 0, 0, 0};
    EXPECT_EQ(message(), "a.gltf: node \"square node\": \"rotation\" is zero");
    node.erase("rotation");
    node["matrix"] = {1, 2, 3};
    EXPECT_EQ(message(), "a.gltf: node \"square node\": 3 numbers in \"matrix\"; it needs 16");
    node.erase("matrix");
    node["children"] = {0};
    EXPECT_EQ(message(), "a.gltf: node \"square node\" has two parents or is its own descendant");
    file.json.erase("scenes");
    file.json.erase("scene");
    EXPECT_EQ(message(), "a.gltf: its nodes are their own descendants");
}

TEST_F(GltfError, OfNothingToShow) {
    file.json["scenes"][0]["nodes"] = json::array();
    EXPECT_EQ(message(), "a.gltf: no triangles; the scene shows no mesh");
    file.json["scenes"][0]["nodes"] = {0};
    primitive()["mode"] = 0;
    EXPECT_EQ(message(), "a.gltf: no triangles; the scene shows no mesh");
}

TEST_F(GltfError, OfCamerasAndLights) {
    file.json["cameras"] = {
        {{"type", "perspective"}, {"name", "c"}, {"perspective", {{"yfov", 3.5}, {"znear", 0.1}}}}};
    file.json["nodes"][0]["camera"] = 0;
    EXPECT_EQ(message(), "a.gltf: camera \"c\": \"yfov\" is 3.5; it must lie between 0 and pi");
    file.json["nodes"][0].erase("camera");
    json& lights = file.json["extensions"]["KHR_lights_punctual"]["lights"];
    file.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    lights = {{{"type", "area"}, {"name", "l"}}};
    EXPECT_EQ(message(), "a.gltf: light \"l\": type 'area'; there are directional, point and spot");
    lights = {{{"type", "point"}, {"name", "l"}, {"intensity", -1}}};
    EXPECT_EQ(message(), "a.gltf: light \"l\": color, intensity and range must not be negative");
    lights = {{{"type", "point"}, {"name", "l"}, {"color", {1, 1}}}};
    EXPECT_EQ(message(), "a.gltf: light \"l\": 2 numbers in \"color\"; it needs 3");
    lights = {{{"type", "spot"},
               {"name", "l"},
               {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.25}}}}};
    EXPECT_EQ(message(),
              "a.gltf: light \"l\": cone from 0.5 to 0.25; it must be 0 <= innerConeAngle <= "
              "outerConeAngle <= pi/2");
}

TEST_F(GltfError, OfAnimations) {
    const int times = file.accessor<float>({1, 2}, "SCALAR");
    const int values = file.accessor<float>({0, 0, 0, 1, 0, 0}, "VEC3");
    json animation = {
        {"name", "a"},
        {"samplers", {{{"input", times}, {"output", values}}}},
        {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}};
    const auto message_with = [&](const char* pointer, const json& value) {
        json changed = animation;
        changed[json::json_pointer(pointer)] = value;
        file.json["animations"] = {changed};
        return message();
    };
    const std::string where = "a.gltf: animation \"a\": translation of node \"square node\": ";
    EXPECT_EQ(message_with("/name", "a"), "no error");
    EXPECT_EQ(message_with("/channels/0/target/node", 7),
              "a.gltf: animation \"a\": there is no node 7; the file has 1, counted from 0");
    EXPECT_EQ(message_with("/channels/0/sampler", 7),
              "a.gltf: animation \"a\": there is no sampler 7; the file has 1, counted from 0");
    EXPECT_EQ(message_with("/samplers/0/interpolation", "WAVE"),
              where + "interpolation 'WAVE'; there are LINEAR, STEP and CUBICSPLINE");
    EXPECT_EQ(message_with("/samplers/0/interpolation", "CUBICSPLINE"),
              where + "2 values for 2 keys; it needs 3 a key");
    EXPECT_EQ(message_with("/samplers/0/input", file.accessor<float>({2, 2}, "SCALAR")),
              where + "key 1 is at 2 s, not after the one before (2 s)");
    EXPECT_EQ(message_with("/samplers/0/input", 99),
              where + "times: there is no accessor 99; the file has " +
                  std::to_string(file.json["accessors"].size()) + ", counted from 0");
    animation["channels"][0]["target"]["path"] = "rotation";
    EXPECT_EQ(
        message_with("/samplers/0/output", file.accessor<float>({0, 0, 0, 1, 0, 0, 0, 0}, "VEC4")),
        "a.gltf: animation \"a\": rotation of node \"square node\": the rotation of key 1 is "
        "zero");
}

TEST_F(GltfError, OfMaterials) {
    primitive()["material"] = 0;
    const auto message_for = [&](const json& extras) {
        file.json["materials"] = {{{"name", "table"}, {"extras", extras}}};
        return message();
    };
    const std::string where = "a.gltf: material \"table\": ";
    EXPECT_EQ(message_for({{"shader", 5}}), where + "\"shader\" must be a name in quotes, not 5");
    EXPECT_EQ(message_for({{"shader", nullptr}}),
              where + "\"shader\" must be a name in quotes, not null");
    EXPECT_EQ(message_for({{"shader", "wood"}, {"params", "x"}}),
              where + "\"params\" must be {\"name\": value, ...}, not \"x\"");
    for (const json& bad : {json("12"), json(nullptr), json(true), json::array(), json({1, 2}),
                            json({1, 2, nullptr}), json::object(), json(1e300)}) {
        EXPECT_EQ(message_for({{"shader", "wood"}, {"params", {{"ringscale", bad}}}}),
                  where + "\"ringscale\" must be a number or three of them, not " + bad.dump());
    }
    EXPECT_EQ(message_for({{"shader", "plastic"}, {"params", {{"Kq", 1}, {"Kd", 99}}}}),
              where + "shader 'plastic': 'Kd' = 99 is outside [0, 10]\n" + where +
                  "shader 'plastic' has no parameter 'Kq'; did you mean 'Ka'? it has: Ka, Kd, Ks, "
                  "roughness, specularcolor, Cs");
    EXPECT_EQ(message_for({{"shader", "plastik"}}),
              where + "no shader 'plastik'; did you mean 'plastic'? there are: " + shader_names());
}

TEST_F(GltfError, OfOneMaterialIsToldOnceForAllThatWearIt) {
    primitive()["material"] =
        file.add("materials", {{"name", "a"}, {"extras", {{"shader", "x1"}}}});
    json copy = primitive();
    file.json["meshes"][0]["primitives"].push_back(copy);
    copy["material"] = file.add("materials", {{"name", "b"}, {"extras", {{"shader", "x2"}}}});
    file.json["meshes"][0]["primitives"].push_back(copy);
    EXPECT_EQ(message(),
              "a.gltf: material \"a\": no shader 'x1'; there are: " + shader_names() +
                  "\na.gltf: material \"b\": no shader 'x2'; there are: " + shader_names());
}

TEST_F(GltfError, OfAmbientLight) {
    file.json["scenes"][0]["extras"]["ambient"] = {1, 2};
    EXPECT_EQ(message(), "a.gltf: scene: \"ambient\" must be a number or three of them, not [1,2]");
    file.json["scenes"][0]["extras"]["ambient"] = {1, 2, -1};
    EXPECT_EQ(message(), "a.gltf: scene: \"ambient\" must not be negative");
}

TEST_F(GltfError, OfABufferFileThatIsMissingOrShort) {
    file.json["buffers"] = {{{"byteLength", 60}, {"uri", "gone.bin"}}};
    EXPECT_EQ(loading(file.json.dump()).find("a.gltf: cannot be read as glTF: File not found"), 0u);
    write_file("gone.bin", "short");
    EXPECT_EQ(loading(file.json.dump()).find("a.gltf: cannot be read as glTF: File size mismatch"),
              0u);
}

}  // namespace
}  // namespace estara
