// Skins and morph targets as glTF files have them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "estara/scenes/load.h"
#include "estara/scenes/scene.h"
#include "files.h"
#include "gltf_file.h"

namespace estara {
namespace {

using test::GltfFile;
using testing::HasSubstr;

class GltfSkin : public test::InFolder {
protected:
    GltfFile file;
    int mesh = 0;
    void SetUp() override {
        test::InFolder::SetUp();
        mesh = file.square();
        file.json["nodes"][0]["skin"] = 0;
        file.json["nodes"][0]["translation"] = {100, 100, 100};  // does not count
        file.node({{"name", "hip"}, {"translation", {0, 0, 5}}});
        file.node({{"name", "knee"}, {"translation", {0, 0, 7}}});
        file.json["skins"] = {{{"joints", {1, 2}}}};
    }
    /// Of each vertex: joints and weights.
    void bind(const std::vector<std::uint8_t>& joints, const std::vector<float>& weights,
              const std::string& set = "0") {
        file.primitive(mesh)["attributes"]["JOINTS_" + set] = file.accessor(joints, "VEC4");
        file.primitive(mesh)["attributes"]["WEIGHTS_" + set] = file.accessor(weights, "VEC4");
    }
    Scene load() {
        test::write_file("a.gltf", file.text());
        return load_scene("a.gltf");
    }
    std::string error() {
        return test::message_of([&] { load(); });
    }
};

constexpr std::uint8_t hip = 0, knee = 1;

TEST_F(GltfSkin, MovesVerticesByJointsAndNotByTheMeshesNode) {
    bind({hip, 0, 0, 0, knee, 0, 0, 0, hip, knee, 0, 0, hip, knee, 0, 0},
         {1, 0, 0, 0, 1, 0, 0, 0, .5f, .5f, 0, 0, .75f, .25f, 0, 0});
    const Scene scene = load();
    EXPECT_THAT(scene.warnings, testing::Each(testing::Not(HasSubstr("skin"))));
    const Pose pose = pose_at(scene, 0.0);
    ASSERT_TRUE(pose.bent[0]);
    const float heights[] = {5, 7, 6, 5.5f};
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(pose.world_from_instance[0][3].z + pose.bent[0]->P[std::size_t(i)].z, heights[i]);
    }
}

TEST_F(GltfSkin, ReadsEightInfluencesAndInverseBindMatrices) {
    std::vector<std::uint8_t> joints(16, knee);
    bind(joints, std::vector<float>(16, .125f));
    bind(joints, std::vector<float>(16, .125f), "1");
    file.primitive(mesh)["attributes"]["JOINTS_2"] = 0;
    std::vector<float> matrices(32, 0.0f);
    for (int k = 0; k < 4; ++k)
        matrices[std::size_t(5 * k)] = matrices[std::size_t(16 + 5 * k)] = 1;
    matrices[16 + 14] = -7;
    const int bound = file.accessor<float>(matrices, "VEC4");
    file.json["accessors"][std::size_t(bound)]["type"] = "MAT4";
    file.json["accessors"][std::size_t(bound)]["count"] = 2;
    file.json["skins"][0]["inverseBindMatrices"] = bound;
    const Scene scene = load();
    EXPECT_EQ(scene.objects[0].bends.influences.count, 8);
    EXPECT_THAT(scene.warnings,
                testing::Contains(HasSubstr("1 primitives' joints beyond eight a vertex")));
    const Pose pose = pose_at(scene, 0.0);
    EXPECT_EQ(pose.world_from_instance[0][3].z + pose.bent[0]->P[0].z, 0.0f);
}

TEST_F(GltfSkin, MakesWeightsSumToOne) {
    bind({hip, knee, 0, 0, hip, 0, 0, 0, hip, knee, 0, 0, hip, knee, 0, 0},
         {2, 2, 0, 0, 0, 0, 0, 0, -1, 1, 0, 0, .5f, .5f, 0, 0});
    const Scene scene = load();
    const Influences& all = scene.objects[0].bends.influences;
    EXPECT_EQ(all.weight[0], .5f);
    EXPECT_EQ(all.weight[4], 1.0f);  // none is given
    EXPECT_EQ(all.weight[8], 0.0f);  // none is negative
    EXPECT_EQ(all.weight[9], 1.0f);
}

TEST_F(GltfSkin, SaysWhatIsWrong) {
    bind({2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
         {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    EXPECT_THAT(error(), HasSubstr("vertex 0 follows joint 2; its skin has 2, counted from 0"));
    file.json["skins"][0]["joints"] = {1, 9};
    EXPECT_THAT(error(), HasSubstr("there is no node 9"));
    file.json["skins"][0]["joints"] = {1, 2};
    file.json["scenes"][0]["nodes"] = {0, 1};
    EXPECT_THAT(error(), HasSubstr("joint node \"knee\" is not in the scene that is shown"));
    file.json["scenes"][0]["nodes"] = {0, 1, 2};
    file.primitive(mesh)["attributes"].erase("WEIGHTS_0");
    EXPECT_THAT(error(), HasSubstr("JOINTS_0 and WEIGHTS_0 go together; one is missing"));
    file.json["nodes"][0]["skin"] = 4;
    EXPECT_THAT(error(), HasSubstr("there is no skin 4"));
}

TEST_F(GltfSkin, ReadsMorphTargetsAndTheirKeys) {
    file.json["nodes"][0].erase("skin");
    file.json["nodes"][0].erase("translation");
    const int up = file.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    const int aside = file.accessor<float>({9, 0, 0, 9, 0, 0, 9, 0, 0, 9, 0, 0}, "VEC3");
    file.primitive(mesh)["targets"] = {{{"POSITION", up}}, {{"POSITION", aside}}};
    const int times = file.accessor<float>({1, 2}, "SCALAR");
    const int weights = file.accessor<float>({1, 0, 0, 1}, "SCALAR");
    file.json["animations"] = {
        {{"samplers", {{{"input", times}, {"output", weights}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
    const Scene scene = load();
    const auto first = [&](double time) {
        const Pose pose = pose_at(scene, time);
        return glm::vec3(pose.world_from_instance[0][3]) + pose.bent[0]->P[0];
    };
    EXPECT_EQ(first(1.0), glm::vec3(0, 0, 1));
    EXPECT_EQ(first(1.5), glm::vec3(4.5f, 0, 0.5f));
    EXPECT_EQ(first(2.0), glm::vec3(9, 0, 0));
    EXPECT_THAT(scene.warnings, testing::Each(testing::Not(HasSubstr("morph"))));
}

TEST_F(GltfSkin, SaysWhichMorphTargetIsWrong) {
    const int short_one = file.accessor<float>({0, 0, 1}, "VEC3");
    file.primitive(mesh)["targets"] = {{{"POSITION", short_one}}};
    EXPECT_THAT(error(), HasSubstr("morph target 0: POSITION: 1 for 4 vertices"));
}

}  // namespace
}  // namespace estara
