#include "estara/render/frame.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cstring>
#include <limits>

#include "estara/render/compare.h"
#include "small_scene.h"

namespace estara {
namespace {

using test::add_sun;
using test::object;
using test::scene_of;
using test::sphere;

std::vector<ObjectShading> direct(const Scene& scene) {
    std::vector<ObjectShading> shading;
    for (const Object& o : scene.objects) shading.push_back({o.shader, nullptr, 0.01f});
    return shading;
}

Film render(const Scene& scene, const FrameSettings& settings,
            const std::vector<ObjectShading>& shading, FrameStatistics* statistics = nullptr) {
    RayScene rays(scene);
    FrameRenderer renderer(scene, rays, settings);
    Film film(settings.width, settings.height, settings.aovs);
    const FrameStatistics cost = renderer.render(shading, 0, 0.0, film, {});
    if (statistics != nullptr) *statistics = cost;
    return film;
}

FrameSettings small(int spp = 4) {
    FrameSettings settings;
    settings.width = 70;  // no multiple of a tile
    settings.height = 50;
    settings.spp = spp;
    return settings;
}

/// Blocks of 8^3 voxels from -1.2 up to `blocks` in x and all the way in y and z around a sphere of
/// radius 1, filled with what the shader bakes there.
TextureGrid grid_of(const BoundShader& shader, int blocks_in_x) {
    constexpr int blocks = 8;
    TextureGrid grid;
    grid.voxel_size = 2.4 / (blocks * 8 - 1);
    grid.origin = glm::dvec3(-1.2);
    for (const ChannelInfo& c : shader.info().channels) {
        grid.channels.push_back({std::string(c.name), c.components});
    }
    GridLevel level;
    level.planes.resize(std::size_t(shader.info().baked_floats));
    std::vector<float> planes(level.planes.size() * SurfaceBatch::capacity);
    for (int b = 0; b < blocks_in_x * blocks * blocks; ++b) {
        Block block;
        block.origin = 8 * glm::ivec3(b / (blocks * blocks), b / blocks % blocks, b % blocks);
        block.active.words.fill(~std::uint64_t{0});
        block.first = std::uint64_t(b) * 512;
        SurfaceBatch batch;
        batch.size = 512;
        batch.filter_width = float(grid.voxel_size);
        for (int i = 0; i < 512; ++i) {
            const glm::dvec3 index(block.origin + glm::ivec3(i / 64, i / 8 % 8, i % 8));
            const glm::vec3 P(grid.origin + grid.voxel_size * index);
            batch.set(i, P, glm::normalize(P), {}, {1, 0, 0});
        }
        shader.bake(batch, planes.data());
        for (std::size_t k = 0; k < level.planes.size(); ++k) {
            const float* row = planes.data() + k * SurfaceBatch::capacity;
            level.planes[k].insert(level.planes[k].end(), row, row + 512);
        }
        level.blocks.push_back(block);
        level.cells.push_back(block.active);
    }
    grid.levels.push_back(std::move(level));
    return grid;
}

std::vector<ObjectShading> baked(const Scene& scene, int blocks_in_x) {
    std::vector<ObjectShading> shading = direct(scene);
    shading[0].pyramid =
        std::make_shared<BrickPyramid>(grid_of(*scene.objects[0].shader, blocks_in_x));
    return shading;
}

float largest_difference(const Film& a, const Film& b) {
    float largest = 0.0f;
    for (std::size_t i = 0; i < a.color.size(); ++i) {
        for (int c = 0; c < 4; ++c) {
            largest = std::max(largest, std::abs(a.color[i][c] - b.color[i][c]));
        }
    }
    return largest;
}

TEST(Sphere, UnderConstantAmbientLightIsUniform) {
    const Scene scene = scene_of({object("ball", sphere(1.0f))});
    const Film film = render(scene, small(), direct(scene));
    int inside = 0, outside = 0;
    for (const glm::vec4& pixel : film.color) {
        // plastic: Cs Ka A = .5; associated alpha scales it at the edge.
        for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(pixel[c], 0.5f * pixel.a);
        inside += pixel.a == 1.0f;
        outside += pixel.a == 0.0f;
    }
    // The silhouette of a sphere at distance 4: a disc of tan = 1 / sqrt(15).
    const double radius = 25.0 / std::tan(0.4) / std::sqrt(15.0);
    double covered = 0.0;
    for (const glm::vec4& pixel : film.color) covered += double(pixel.a);
    EXPECT_NEAR(covered, 3.14159265 * radius * radius, 0.02 * covered);
    EXPECT_GT(inside, 500);
    EXPECT_GT(outside, 1000);
}

TEST(Sphere, HasItsNormalsPositionsAndDistances) {
    const Scene scene = scene_of({object("ball", sphere(1.0f, 64))});
    FrameSettings settings = small(1);
    settings.aovs = {true, true, true, true};
    const Film film = render(scene, settings, direct(scene));
    for (std::size_t i = 0; i < film.color.size(); ++i) {
        if (film.color[i].a == 0.0f) {
            EXPECT_EQ(film.P[i], glm::vec3(0.0f));
            EXPECT_EQ(film.depth[i], 0.0f);
            continue;
        }
        EXPECT_NEAR(glm::length(film.P[i]), 1.0f, 2e-3f);
        EXPECT_GT(glm::dot(film.N[i], film.P[i]), 0.995f);
        EXPECT_NEAR(film.depth[i], glm::distance(film.P[i], glm::vec3(0, 0, 4)), 1e-5f);
        EXPECT_EQ(film.albedo[i], glm::vec3(0.5f));
    }
    const std::size_t middle = film.index(35, 25);
    EXPECT_NEAR(film.depth[middle], 3.0f, 0.01f);
}

TEST(Sphere, SeenFromWithinHasNormalsTurnedToTheEye) {
    Scene scene = scene_of({object("room", sphere(10.0f))});
    FrameSettings settings = small(1);
    settings.aovs.normal = true;
    const Film film = render(scene, settings, direct(scene));
    for (std::size_t i = 0; i < film.color.size(); ++i) {
        EXPECT_EQ(film.color[i].a, 1.0f);
        EXPECT_GT(film.N[i].z, 0.5f);  // the wall at -z, seen along -z
    }
}

TEST(Sphere, SizeOfAnInstanceDoesNotTurnItsNormals) {
    Scene scene = scene_of({object("ball", sphere(1.0f, 64))});
    scene.nodes[0].scale = {-0.5f, 1.0f, 2.0f};  // mirrored
    FrameSettings settings = small(1);
    settings.aovs = {false, true, true, false};
    const Film film = render(scene, settings, direct(scene));
    for (std::size_t i = 0; i < film.color.size(); ++i) {
        if (film.color[i].a == 0.0f) continue;
        const glm::vec3 gradient = film.P[i] / glm::vec3(0.25f, 1.0f, 4.0f);
        EXPECT_GT(glm::dot(film.N[i], glm::normalize(gradient)), 0.99f);
    }
}

TEST(Light, FromTheEyeFallsOffWithTheCosine) {
    Scene scene = scene_of({object("ball", sphere(1.0f, 64))});
    scene.ambient = glm::vec3(0.0f);
    const Setting matte[] = {{"Ks", {0.0f}}, {"Kd", {1.0f}}, {"Cs", {1.0f}}};
    scene.objects[0].shader = bind_shader("plastic", matte, false).shader;
    add_sun(scene, glm::quat(1, 0, 0, 0));  // along -z, Cl = 1
    FrameSettings settings = small(1);
    settings.aovs.normal = true;
    FrameStatistics cost;
    const Film film = render(scene, settings, direct(scene), &cost);
    for (std::size_t i = 0; i < film.color.size(); ++i) {
        if (film.color[i].a == 0.0f) continue;
        EXPECT_NEAR(film.color[i].r, std::max(0.0f, film.N[i].z), 1e-4f);
    }
    EXPECT_GT(cost.shadow_rays, 0u);
    EXPECT_LE(cost.shadow_rays, cost.samples);
}

TEST(Light, BehindAnotherObjectIsInShadow) {
    Scene scene = scene_of({object("ball", sphere(1.0f)), object("screen", sphere(5.0f))});
    scene.ambient = glm::vec3(0.0f);
    add_sun(scene, glm::quat(1, 0, 0, 0));
    Node between;  // the camera is between the ball and the screen
    between.translation = {0.0f, 0.0f, 12.0f};
    scene.nodes.push_back(between);
    scene.instances[1].node = int(scene.nodes.size()) - 1;
    const Film film = render(scene, small(1), direct(scene));
    for (const glm::vec4& pixel : film.color) EXPECT_EQ(glm::vec3(pixel), glm::vec3(0.0f));
    EXPECT_EQ(film.color[film.index(35, 25)].a, 1.0f);
}

TEST(Light, OfASmoothSurfaceItselfLeavesNoSpots) {
    Scene scene = scene_of({object("ball", sphere(1000.0f, 100))});
    scene.nodes[1].translation = {0.0f, 0.0f, 4000.0f};
    scene.ambient = glm::vec3(0.0f);
    add_sun(scene, glm::quat(1, 0, 0, 0));
    const Film film = render(scene, small(1), direct(scene));
    for (int y = 20; y < 30; ++y) {
        for (int x = 30; x < 40; ++x) EXPECT_GT(film.color[film.index(x, y)].r, 0.2f);
    }
}

/// What the sun of (1, 0, 0, 0) leaves on a unit ball, baked; masked where x > `masked_from`.
std::shared_ptr<const BrickPyramid> baked_sunlight(const BoundShader& any, float masked_from) {
    TextureGrid grid = grid_of(any, 8);
    grid.channels = {{"irradiance", 3}, {"irradiance_mask", 1}};
    GridLevel& level = grid.levels.front();
    level.planes.assign(4, std::vector<float>(level.blocks.size() * 512));
    for (const Block& block : level.blocks) {
        for (int i = 0; i < 512; ++i) {
            const glm::dvec3 index(block.origin + glm::ivec3(i / 64, i / 8 % 8, i % 8));
            const glm::dvec3 P = grid.origin + grid.voxel_size * index;
            const float E = std::max(0.0f, float(glm::normalize(P).z));
            for (std::size_t c = 0; c < 3; ++c) level.planes[c][block.first + std::size_t(i)] = E;
            level.planes[3][block.first + std::size_t(i)] = P.x > double(masked_from) ? 1.0f : 0.0f;
        }
    }
    return std::make_shared<BrickPyramid>(grid);
}

TEST(Light, ThatIsBakedNeedsNoShadowRayOutsideTheMask) {
    Scene scene = scene_of({object("ball", sphere(1.0f, 64))});
    scene.ambient = glm::vec3(0.0f);
    const Setting matte[] = {{"Ks", {0.0f}}, {"Kd", {1.0f}}, {"Cs", {1.0f}}};
    scene.objects[0].shader = bind_shader("plastic", matte, false).shader;
    add_sun(scene, glm::quat(1, 0, 0, 0));
    std::vector<ObjectShading> shading = direct(scene);
    FrameStatistics traced, all, half;
    const Film reference = render(scene, small(1), shading, &traced);
    shading[0].irradiance = baked_sunlight(*scene.objects[0].shader, 2.0f);
    const Film film = render(scene, small(1), shading, &all);
    EXPECT_EQ(all.shadow_rays, 0u);
    EXPECT_EQ(all.irradiance_lookups, all.samples);
    EXPECT_LT(largest_difference(film, reference), 0.02f);  // a voxel is 1/27 of the radius
    shading[0].irradiance = baked_sunlight(*scene.objects[0].shader, 0.0f);
    const Film masked = render(scene, small(1), shading, &half);
    EXPECT_NEAR(double(half.shadow_rays), 0.5 * double(traced.shadow_rays),
                0.05 * double(traced.shadow_rays));
    EXPECT_EQ(masked.color[masked.index(45, 25)], reference.color[masked.index(45, 25)]);
}

TEST(Light, TracesAHighlightWhereItShows) {
    Scene scene = scene_of({object("ball", sphere(1.0f, 64))});
    add_sun(scene, glm::quat(1, 0, 0, 0));
    std::vector<ObjectShading> shading = direct(scene);
    shading[0].irradiance = baked_sunlight(*scene.objects[0].shader, 2.0f);
    FrameStatistics cost;
    const Film film = render(scene, small(1), shading, &cost);
    EXPECT_GT(cost.shadow_rays, 0u);
    EXPECT_LT(cost.shadow_rays, cost.samples / 2);
    EXPECT_LT(largest_difference(film, render(scene, small(1), direct(scene))), 0.02f);
}

TEST(Light, CastsNoShadowWhereNoneIsWanted) {
    Scene scene = scene_of({object("ball", sphere(1.0f)), object("screen", sphere(5.0f))});
    scene.ambient = glm::vec3(0.0f);
    add_sun(scene, glm::quat(1, 0, 0, 0));
    FrameSettings settings = small(1);
    settings.shadows = false;
    FrameStatistics cost;
    const Film film = render(scene, settings, direct(scene), &cost);
    EXPECT_EQ(cost.shadow_rays, 0u);
    EXPECT_GT(film.color[film.index(35, 25)].r, 0.2f);  // from outside the screen
}

TEST(Frame, IsTheSameWithOneThreadAndFour) {
    Scene scene = scene_of({object("ball", sphere(1.0f), "wood"), object("b", sphere(0.3f))});
    add_sun(scene, glm::quat(glm::vec3(-0.7f, 0.3f, 0.0f)));
    Node aside;
    aside.translation = {0.9f, 0.5f, 1.0f};
    scene.nodes.push_back(aside);
    scene.instances[1].node = int(scene.nodes.size()) - 1;
    std::vector<Film> films;
    for (const std::size_t threads : {1u, 4u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        films.push_back(render(scene, small(), direct(scene)));
    }
    ASSERT_EQ(films[0].color.size(), films[1].color.size());
    EXPECT_EQ(0, std::memcmp(films[0].color.data(), films[1].color.data(),
                             films[0].color.size() * sizeof(glm::vec4)));
}

TEST(Frame, ExposureDoublesColoursAndNotAlpha) {
    const Scene scene = scene_of({object("ball", sphere(1.0f))});
    FrameSettings settings = small();
    const Film once = render(scene, settings, direct(scene));
    settings.exposure = 1.0f;
    const Film twice = render(scene, settings, direct(scene));
    for (std::size_t i = 0; i < once.color.size(); ++i) {
        EXPECT_EQ(glm::vec3(twice.color[i]), 2.0f * glm::vec3(once.color[i]));
        EXPECT_EQ(twice.color[i].a, once.color[i].a);
    }
}

TEST(Frame, WritesZeroForWhatIsNoNumberAndCountsIt) {
    Scene scene = scene_of({object("ball", sphere(1.0f))});
    scene.ambient = glm::vec3(std::numeric_limits<float>::infinity());
    FrameStatistics cost;
    const Film film = render(scene, small(), direct(scene), &cost);
    std::uint64_t covered = 0;
    for (const glm::vec4& pixel : film.color) {
        EXPECT_EQ(glm::vec3(pixel), glm::vec3(0.0f));
        covered += pixel.a > 0.0f;
    }
    EXPECT_EQ(cost.bad_pixels, covered);
    EXPECT_GT(covered, 0u);
}

TEST(Frame, CountsItsRaysAndTiles) {
    const Scene scene = scene_of({object("ball", sphere(1.0f))});
    RayScene rays(scene);
    FrameRenderer renderer(scene, rays, small());
    EXPECT_EQ(renderer.tile_count(), 3 * 4);
    Film film(70, 50, {});
    std::atomic<int> tiles = 0;
    const FrameStatistics cost = renderer.render(direct(scene), 0, 0.0, film, [&] { ++tiles; });
    EXPECT_EQ(tiles, 12);
    EXPECT_EQ(cost.primary_rays, 70u * 50u * 4u);
    double covered = 0.0;
    for (const glm::vec4& pixel : film.color) covered += double(pixel.a);
    EXPECT_EQ(cost.samples, std::uint64_t(std::lround(covered * 4.0)));
    EXPECT_EQ(cost.lookups, 0u);
}

/// A batch holds many pixels, one, or a part of one.
TEST(Frame, TakesEachSampleOnce) {
    const Scene scene = scene_of({object("ball", sphere(1.0f, 48), "wood")});
    FrameSettings settings = small();
    settings.width = 38;
    settings.height = 21;
    settings.spp = 64;
    const Film expected = render(scene, settings, direct(scene));
    constexpr int batch = batch_capacity;
    for (const int spp : {1, 3, 300, batch, batch + 1, 2 * batch + 6}) {
        settings.spp = spp;
        FrameStatistics cost;
        const Film film = render(scene, settings, direct(scene), &cost);
        EXPECT_EQ(cost.primary_rays, std::uint64_t(settings.width * settings.height * spp)) << spp;
        EXPECT_EQ(film.color[film.index(19, 10)].w, 1.0f) << spp;
        if (spp >= 300) {
            EXPECT_LT(compare_films(film, expected).rmse, 0.02) << spp;
        }
    }
}

TEST(Frame, OfAConstantShaderIsTheSameFromTheGrid) {
    Scene scene = scene_of({object("ball", sphere(1.0f), "plastic", {{"Cs", {0.2f, 0.5f, 0.7f}}})});
    FrameStatistics cost;
    const Film from_grid = render(scene, small(), baked(scene, 8), &cost);
    EXPECT_LT(largest_difference(from_grid, render(scene, small(), direct(scene))), 1e-5f);
    EXPECT_EQ(cost.lookups, cost.samples);
    EXPECT_EQ(cost.misses, 0u);
}

TEST(Frame, FromTheGridIsCloseToDirectAndNotTheSame) {
    Scene scene = scene_of({object("ball", sphere(1.0f), "wood", {{"ringscale", {2.0f}}})});
    const Film from_grid = render(scene, small(), baked(scene, 8));
    const Film reference = render(scene, small(), direct(scene));
    double squares = 0.0;
    for (std::size_t i = 0; i < reference.color.size(); ++i) {
        const glm::dvec4 d = glm::dvec4(from_grid.color[i]) - glm::dvec4(reference.color[i]);
        squares += glm::dot(d, d) / 4.0;
    }
    const double rmse = std::sqrt(squares / double(reference.color.size()));
    EXPECT_GT(rmse, 0.0);
    EXPECT_LT(rmse, 0.003);  // a ring is 13 voxels wide
}

TEST(Frame, OffTheBakedBandIsEvaluatedDirectlyAndCounted) {
    Scene scene = scene_of({object("ball", sphere(1.0f), "wood", {{"ringscale", {2.0f}}})});
    FrameStatistics cost;
    const Film film = render(scene, small(), baked(scene, 3), &cost);
    EXPECT_GT(cost.misses, cost.lookups / 4);
    EXPECT_LT(cost.misses, cost.lookups);
    const Film reference = render(scene, small(), direct(scene));
    const int right = 45;  // x well beyond the 24 voxels that are there
    for (int y = 0; y < 50; ++y) {
        for (int x = right; x < 70; ++x) {
            EXPECT_EQ(film.color[film.index(x, y)], reference.color[film.index(x, y)]);
        }
    }
    EXPECT_LT(largest_difference(film, reference), 0.1f);
}

TEST(Frame, IsTheSameFarFromTheOrigin) {
    const auto picture = [](const glm::dvec3& far) {
        Scene scene = scene_of({object("ball", sphere(1.0f, 48), "wood", {{"ringscale", {3.0f}}}),
                                object("little", sphere(0.4f, 32), "stone", {{"scale", {0.2f}}})});
        Node aside;
        aside.translation = {0.9, 0.6, 0.9};
        scene.nodes.push_back(aside);
        scene.instances[1].node = int(scene.nodes.size()) - 1;
        scene.ambient = glm::vec3(0.2f);
        test::add_sun(scene, glm::quat(glm::vec3(-0.6f, 0.4f, 0.0f)));
        for (Node& node : scene.nodes) node.translation += far;
        RayScene rays(scene);
        FrameSettings settings;
        settings.width = 160;
        settings.height = 120;
        settings.aovs.position = true;
        std::vector<ObjectShading> shading;
        for (const Object& o : scene.objects) shading.push_back({o.shader, nullptr, 0.01f});
        Film film(settings.width, settings.height, settings.aovs);
        FrameRenderer(scene, rays, settings).render(shading, 0, 0.0, film, {});
        return film;
    };
    const Film here = picture(glm::dvec3(0.0));
    for (const glm::dvec3& far : {glm::dvec3(1e6, 0, -5e5), glm::dvec3(-6.4e6, 6.4e6, 1e7)}) {
        const Film there = picture(far);
        EXPECT_LT(compare_films(there, here).rmse, 1e-4);
        // P is the scene's own, as exactly as a float can have it.
        const std::size_t middle = here.index(80, 60);
        const glm::dvec3 P = glm::dvec3(here.P[middle]) + far;
        EXPECT_LE(glm::distance(glm::dvec3(there.P[middle]), P), 1.0);
    }
}

}  // namespace
}  // namespace estara
