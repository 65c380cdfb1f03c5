#include "estara/render/textures.h"

#include <gtest/gtest.h>

#include "estara/grids/irradiance.h"
#include "estara/render/dress.h"
#include "estara/scenes/static_light.h"
#include "small_scene.h"

namespace estara {
namespace {

using test::error_of;
using test::object;
using test::scene_of;
using test::sphere;

/// What estara-bake would say about an object, without voxels.
LoadedGrid grid_for(const Object& baked, const std::string& name,
                    const std::string& file = "a.vdb") {
    LoadedGrid loaded{file, {}};
    TextureGrid& grid = loaded.grid;
    grid.object = name;
    const ShaderInfo& info = baked.shader->info();
    grid.shader = info.name;
    for (std::size_t i = 0; i < info.params.size(); ++i) {
        const glm::vec3 v = baked.shader->values()[i];
        std::vector<float> value{v.x, v.y, v.z};
        value.resize(std::size_t(info.params[i].components()));
        grid.params.emplace_back(std::string(info.params[i].name), value);
    }
    for (const ChannelInfo& c : info.channels) {
        grid.channels.push_back({std::string(c.name), c.components});
    }
    grid.shader_digest = shader_digest(*baked.shader);
    grid.mesh_digest = mesh_digest(baked.mesh);
    grid.tool_version = "0.0.9";
    return loaded;
}

Object wooden(const std::string& name, float radius, float ringscale = 10.0f) {
    return object(name, sphere(radius, 8), "wood", {{"ringscale", {ringscale}}});
}

using Warnings = std::vector<std::string>;

TEST(MatchGrids, FitsByNameAndMesh) {
    Scene scene = scene_of({wooden("a", 1.0f), wooden("b", 2.0f)});
    const GridMatch match =
        match_grids(scene, {grid_for(scene.objects[1], "b"), grid_for(scene.objects[0], "a")});
    EXPECT_EQ(match.grid_of_object, (std::vector<int>{1, 0}));
    EXPECT_EQ(match.warnings, Warnings{});
}

TEST(MatchGrids, FitsByMeshWithoutANameOrUnderAnother) {
    for (const char* name : {"", "renamed"}) {
        Scene scene = scene_of({wooden("a", 1.0f), wooden("b", 2.0f)});
        const GridMatch match = match_grids(scene, {grid_for(scene.objects[1], name)});
        EXPECT_EQ(match.grid_of_object, (std::vector<int>{-1, 0}));
        EXPECT_EQ(match.warnings, Warnings{});
    }
}

TEST(MatchGrids, NameDecidesBetweenEqualMeshes) {
    Scene scene = scene_of({wooden("a", 1.0f, 10.0f), wooden("b", 1.0f, 20.0f)});
    const GridMatch match =
        match_grids(scene, {grid_for(scene.objects[1], "b"), grid_for(scene.objects[0], "a")});
    EXPECT_EQ(match.grid_of_object, (std::vector<int>{1, 0}));
    EXPECT_EQ(match.warnings, Warnings{});
}

TEST(MatchGrids, WarnsOfAMeshThatHasChanged) {
    Scene scene = scene_of({wooden("a", 1.0f), wooden("b", 2.0f)});
    const GridMatch match = match_grids(scene, {grid_for(wooden("a", 1.01f), "a")});
    EXPECT_EQ(match.grid_of_object, (std::vector<int>{-1, -1}));
    EXPECT_EQ(match.is_stale, (std::vector<bool>{true, false}));
    EXPECT_EQ(match.warnings,
              Warnings{"a.vdb: object \"a\": its mesh is not the one that was baked; evaluated "
                       "directly: bake it again to use the grid"});
}

TEST(MatchGrids, WarnsOfAParameterThatHasChanged) {
    Scene scene = scene_of({wooden("a", 1.0f, 12.0f)});
    const GridMatch match = match_grids(scene, {grid_for(wooden("a", 1.0f, 10.0f), "")});
    EXPECT_EQ(match.grid_of_object, std::vector<int>{-1});
    EXPECT_EQ(match.warnings,
              Warnings{"a.vdb: object \"a\": baked with ringscale=10, but it wears ringscale=12; "
                       "evaluated directly: bake it again to use the grid"});
}

TEST(MatchGrids, ViewDependentParametersMayChange) {
    Scene scene = scene_of({object("a", sphere(1.0f, 8), "wood", {{"roughness", {0.5f}}})});
    const GridMatch match = match_grids(scene, {grid_for(wooden("a", 1.0f), "a")});
    EXPECT_EQ(match.grid_of_object, std::vector<int>{0});
    EXPECT_EQ(match.warnings, Warnings{});
}

TEST(MatchGrids, WarnsOfAnotherShader) {
    Scene scene = scene_of({object("a", sphere(1.0f, 8), "stone")});
    const GridMatch match = match_grids(scene, {grid_for(wooden("a", 1.0f), "a")});
    EXPECT_EQ(match.grid_of_object, std::vector<int>{-1});
    EXPECT_EQ(match.warnings,
              Warnings{"a.vdb: object \"a\": baked with shader 'wood', but it wears 'stone'; "
                       "evaluated directly: bake it again to use the grid"});
}

TEST(MatchGrids, WarnsOfAShaderThatPaintsDifferently) {
    Scene scene = scene_of({wooden("a", 1.0f)});
    LoadedGrid old = grid_for(scene.objects[0], "a");
    old.grid.shader_digest = "0123456789abcdef";
    EXPECT_EQ(match_grids(scene, {old}).warnings,
              Warnings{"a.vdb: object \"a\": shader 'wood' paints differently since (baked by "
                       "estara-bake 0.0.9); evaluated directly: bake it again to use the grid"});
}

TEST(MatchGrids, WarnsOfMissingChannels) {
    Scene scene = scene_of({wooden("a", 1.0f)});
    LoadedGrid poor = grid_for(scene.objects[0], "a");
    poor.grid.channels.pop_back();
    EXPECT_EQ(match_grids(scene, {poor}).warnings,
              Warnings{"a.vdb: object \"a\": the file's channels are not those of shader 'wood'; "
                       "evaluated directly: bake it again to use the grid"});
}

TEST(MatchGrids, WarnsOfAGridThatFitsNothing) {
    Scene scene = scene_of({wooden("a", 1.0f), wooden("b", 2.0f)});
    const Object other = wooden("vase", 3.0f);
    EXPECT_EQ(
        match_grids(scene, {grid_for(other, "vase"), grid_for(other, "")}).warnings,
        (Warnings{"a.vdb: the grid of object \"vase\" (shader 'wood') fits no object of "
                  "test.glb; it has: a, b",
                  "a.vdb: the grid (shader 'wood') fits no object of test.glb; it has: a, b"}));
}

/// A scene with a sun, and the light on its object as it was baked.
LoadedGrid light_for(const Scene& scene) {
    LoadedGrid loaded{"a.vdb", {}};
    loaded.grid.object = scene.objects[0].name;
    loaded.grid.shader = irradiance_shader;
    loaded.grid.mesh_digest = mesh_digest(scene.objects[0].mesh);
    loaded.grid.lights_digest = lights_digest(scene, 0);
    loaded.grid.channels = {{irradiance_channel, 3}, {irradiance_mask_channel, 1}};
    return loaded;
}

TEST(MatchGrids, BakedLightFitsUntilALightOrAPlaceChanges) {
    Scene scene = scene_of({wooden("a", 1.0f)});
    test::add_sun(scene, glm::quat(1, 0, 0, 0));
    const LoadedGrid light = light_for(scene);
    EXPECT_EQ(match_grids(scene, {light}).irradiance_of_object, std::vector<int>{0});
    const std::string start = "a.vdb: object \"a\": baked light: ";
    const std::string end = "; shadows are traced: bake it again to use it";
    Scene brighter = scene;
    brighter.lights[0].intensity *= 1.5f;
    GridMatch match = match_grids(brighter, {light});
    EXPECT_EQ(match.irradiance_of_object, std::vector<int>{-1});
    EXPECT_EQ(match.warnings,
              Warnings{start + "a light or something that casts shadows has changed" + end});
    Scene moved = scene;
    moved.nodes[0].translation = {0.0f, 1.0f, 0.0f};
    EXPECT_EQ(match_grids(moved, {light}).warnings, match.warnings);
    Scene twice = scene;
    twice.instances.push_back(twice.instances[0]);
    EXPECT_EQ(
        match_grids(twice, {light}).warnings,
        Warnings{start + "it stands in the scene 2 times, and light differs from place to place" +
                 end});
    LoadedGrid other = light;
    other.grid.channels.pop_back();
    EXPECT_EQ(match_grids(scene, {other}).warnings,
              Warnings{start + "its channels are not irradiance and irradiance_mask" + end});
}

TEST(MatchGrids, LastOfTwoWins) {
    Scene scene = scene_of({wooden("a", 1.0f)});
    const GridMatch match = match_grids(scene, {grid_for(scene.objects[0], "a", "one.vdb"),
                                                grid_for(scene.objects[0], "a", "two.vdb")});
    EXPECT_EQ(match.grid_of_object, std::vector<int>{1});
    EXPECT_EQ(match.warnings,
              Warnings{"object \"a\": grids of one.vdb and two.vdb fit; the last one is used"});
}

TEST(MatchGrids, ABareObjectPutsOnWhatItsMeshWasBakedWith) {
    Scene scene = scene_of({object("a", sphere(1.0f, 8))});
    const GridMatch match = match_grids(scene, {grid_for(wooden("x", 1.0f, 33.0f), "")});
    EXPECT_EQ(match.grid_of_object, std::vector<int>{0});
    EXPECT_EQ(match.warnings, Warnings{});
    EXPECT_EQ(scene.objects[0].shader->info().name, "wood");
    EXPECT_EQ(scene.objects[0].shader->values()[0].x, 33.0f);
}

TEST(MatchGrids, ABareObjectOnAnotherMeshPutsItOnButIsEvaluatedDirectly) {
    Scene scene = scene_of({object("a", sphere(1.0f, 8))});
    const GridMatch match = match_grids(scene, {grid_for(wooden("x", 1.1f), "")});
    EXPECT_EQ(match.grid_of_object, std::vector<int>{-1});
    EXPECT_EQ(scene.objects[0].shader->info().name, "wood");
    EXPECT_EQ(match.warnings.size(), 1u);
}

TEST(MatchGrids, ABareObjectSaysWhichShaderItCannotPutOn) {
    Scene scene = scene_of({object("a", sphere(1.0f, 8))});
    LoadedGrid future = grid_for(wooden("a", 1.0f), "");
    future.grid.params[0].first = "ringscael";
    EXPECT_EQ(match_grids(scene, {future}).warnings,
              Warnings{"a.vdb: object \"a\": baked by another version: shader 'wood' has no "
                       "parameter 'ringscael'; evaluated directly: bake it again to use the grid"});
    EXPECT_EQ(scene.objects[0].shader->info().name, "plastic");
}

TEST(PutOn, DressesOnlyBareObjects) {
    Scene scene = scene_of({wooden("a", 1.0f), object("b", sphere(1.0f, 8))});
    put_on(scene, "stone", {});
    EXPECT_EQ(scene.objects[0].shader->info().name, "wood");
    EXPECT_EQ(scene.objects[1].shader->info().name, "stone");
    EXPECT_TRUE(scene.objects[1].wears_shader());
}

TEST(PutOn, FailsForAnUnknownShader) {
    Scene scene = scene_of({object("b", sphere(1.0f, 8))});
    EXPECT_THROW(put_on(scene, "wod", {}), Error);
}

TEST(FilterWidth, IsHalfTheFootprintOrAShareOfTheDiagonal) {
    Scene scene = scene_of({object("seen", sphere(1.0f, 24)), object("behind", sphere(1.0f, 8))});
    Node far;
    far.translation = {0.0f, 0.0f, 100.0f};
    scene.nodes.push_back(far);
    scene.instances[1].node = 2;
    RayScene rays(scene);
    const std::vector<float> widths = direct_filter_widths(scene, rays, 0, 24.0, 320, 180);
    const PinholePose camera = pinhole_pose(scene, scene.cameras[0], pose_at(scene, 0.0));
    EXPECT_NEAR(widths[0], 0.5f * 3.0f * camera.pixel_angle(180), 0.02f * widths[0]);
    EXPECT_FLOAT_EQ(widths[1], bounds(scene.objects[1].mesh).diagonal() / 512.0f);
}

TEST(FilterWidth, DoesNotDropBelowAShareOfTheDiagonal) {
    Scene scene = scene_of({object("a", sphere(1.0f, 24))});
    RayScene rays(scene);
    scene.cameras[0].yfov = 1e-4f;
    const std::vector<float> widths = direct_filter_widths(scene, rays, 0, 24.0, 320, 180);
    EXPECT_FLOAT_EQ(widths[0], bounds(scene.objects[0].mesh).diagonal() / 16384.0f);
}

}  // namespace
}  // namespace estara
