// What a glTF material asks for and is not shown is told, a line a feature.
#include <gmock/gmock.h>

#include "estara/scenes/load.h"
#include "files.h"
#include "gltf_file.h"

namespace estara {
namespace {

using nlohmann::json;
using test::GltfFile;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class GltfUnshown : public test::InFolder {
protected:
    GltfFile file;

    /// A square that wears a material.
    int square(const std::string& name, const json& material) {
        const int mesh = file.square();
        file.json["meshes"][std::size_t(mesh)]["name"] = name;
        file.primitive(mesh)["material"] = file.add("materials", material);
        return mesh;
    }

    /// The warnings that begin with "not shown", without the file's name.
    std::vector<std::string> lines() {
        test::write_file("a.gltf", file.text());
        const std::string head = "a.gltf: ";
        std::vector<std::string> found;
        for (const std::string& warning : load_scene("a.gltf").warnings) {
            if (warning.starts_with(head + "not shown"))
                found.push_back(warning.substr(head.size()));
        }
        return found;
    }

    /// The lines that one material leads to.
    std::vector<std::string> lines_of(const json& material) {
        file = GltfFile();
        file.json["textures"] = {{{"source", 0}}};
        square("a", material);
        return lines();
    }
};

TEST_F(GltfUnshown, TellsNothingOfWhatIsShown) {
    EXPECT_THAT(lines_of(json::object()), IsEmpty());
    EXPECT_THAT(lines_of({{"pbrMetallicRoughness", {{"baseColorFactor", {.1, .2, .3, 1}}}}}),
                IsEmpty());
    // Alpha is 1 everywhere, and nothing glows: these change nothing.
    EXPECT_THAT(lines_of({{"alphaMode", "BLEND"}}), IsEmpty());
    EXPECT_THAT(lines_of({{"alphaMode", "MASK"}, {"alphaCutoff", .3}}), IsEmpty());
    EXPECT_THAT(lines_of({{"emissiveFactor", {0, 0, 0}}}), IsEmpty());
    EXPECT_THAT(lines_of({{"emissiveTexture", {{"index", 0}}}}), IsEmpty());
    EXPECT_THAT(lines_of({{"extensions",
                           {{"KHR_materials_emissive_strength", {{"emissiveStrength", 5}}}}}}),
                IsEmpty());
    // Without alphaMode alpha does not count.
    EXPECT_THAT(lines_of({{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, .5}}}}}),
                IsEmpty());
}

TEST_F(GltfUnshown, TellsOfEachFeature) {
    const json texture = {{"index", 0}};
    const std::string metal = "not shown: metallic and roughness (RSL's plastic is) of \"a\"";
    EXPECT_THAT(lines_of({{"pbrMetallicRoughness", {{"metallicFactor", 1}}}}), ElementsAre(metal));
    EXPECT_THAT(lines_of({{"pbrMetallicRoughness", {{"roughnessFactor", .5}}}}),
                ElementsAre(metal));
    EXPECT_THAT(lines_of({{"pbrMetallicRoughness", {{"metallicRoughnessTexture", texture}}}}),
                ElementsAre(metal));
    EXPECT_THAT(lines_of({{"pbrMetallicRoughness", {{"baseColorTexture", texture}}}}),
                ElementsAre("not shown: colour textures (the colour factor is) of \"a\""));
    EXPECT_THAT(lines_of({{"emissiveFactor", {0, 0, .1}}}),
                ElementsAre("not shown: emission of \"a\""));
    EXPECT_THAT(lines_of({{"normalTexture", texture}}),
                ElementsAre("not shown: normal maps of \"a\""));
    EXPECT_THAT(lines_of({{"occlusionTexture", texture}}),
                ElementsAre("not shown: occlusion maps of \"a\""));
    const json half = {{"baseColorFactor", {1, 1, 1, .5}}};
    EXPECT_THAT(lines_of({{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", half}}),
                ElementsAre("not shown: transparency (shown opaque) of \"a\""));
    EXPECT_THAT(lines_of({{"alphaMode", "MASK"}, {"pbrMetallicRoughness", half}}),
                ElementsAre("not shown: alpha masks (shown opaque) of \"a\""));
    EXPECT_THAT(lines_of({{"extensions",
                           {{"KHR_materials_unlit", json::object()},
                            {"KHR_materials_clearcoat", json::object()}}}}),
                ElementsAre("not shown: KHR_materials_clearcoat of \"a\"",
                            "not shown: KHR_materials_unlit of \"a\""));
}

TEST_F(GltfUnshown, TellsOfVertexColoursWithAndWithoutAMaterial) {
    const int colors = file.accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}, "VEC3");
    for (const char* name : {"bare", "dressed"}) {
        const int mesh = square(name, json::object());
        file.primitive(mesh)["attributes"]["COLOR_0"] = colors;
    }
    file.primitive(0).erase("material");
    EXPECT_THAT(lines(), ElementsAre("not shown: vertex colours of \"bare\", \"dressed\""));
}

TEST_F(GltfUnshown, IsOneLineAFeatureHoweverManyObjects) {
    for (int i = 0; i < 11; ++i) square("m" + std::to_string(i), {{"emissiveFactor", {1, 1, 1}}});
    square("m0", {{"emissiveFactor", {1, 1, 1}}});  // named once
    EXPECT_THAT(lines(), ElementsAre("not shown: emission of \"m0\", \"m1\", \"m2\", \"m3\", "
                                     "\"m4\", \"m5\", \"m6\", \"m7\" and 3 others"));
}

TEST_F(GltfUnshown, TellsNothingOfObjectsThatWearAShader) {
    square("a", {{"emissiveFactor", {1, 1, 1}},
                 {"pbrMetallicRoughness", {{"metallicFactor", 1}}},
                 {"extras", {{"shader", "wood"}}}});
    EXPECT_THAT(lines(), IsEmpty());
}

}  // namespace
}  // namespace estara
