// Frames whose samples are recalled from the frames before them.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <optional>

#include "estara/render/compare.h"
#include "estara/render/dress.h"
#include "estara/render/flicker.h"
#include "estara/render/frame.h"
#include "small_scene.h"

namespace estara {
namespace {

using test::add_sun;
using test::object;
using test::scene_of;
using test::sphere;

constexpr int width = 70, height = 50;  // no multiple of a tile

/// An animation of a scene that is changed by hand between its frames.
class Reused {
public:
    explicit Reused(Scene& scene, std::uint64_t cache_bytes = 1u << 26, bool keeps_light = true,
                    int spp = 4, bool tests_all = false)
        : m_rays(scene) {
        m_settings.width = width;
        m_settings.height = height;
        m_settings.spp = spp;
        m_settings.test_all_points = tests_all;
        m_settings.aovs.hit = m_settings.aovs.age = m_settings.aovs.occluded = true;
        m_renderer = std::make_unique<FrameRenderer>(scene, m_rays, m_settings);
        Options options;
        options.cache_memory = cache_bytes;
        options.cache_light = keeps_light;
        for (const Object& o : scene.objects) m_direct.push_back({o.shader, nullptr, 0.01f});
        m_cached = m_direct;
        for (ObjectShading& shading : m_cached) shading.cached = true;
        m_cache = make_cache(scene, options, m_cached);
    }

    Film render() {
        Film film(width, height, m_settings.aovs);
        cost = m_renderer->render(m_cached, 0, 0.0, film, {}, m_cache.get());
        return film;
    }
    Film direct() {
        Film film(width, height, m_settings.aovs);
        m_renderer->render(m_direct, 0, 0.0, film, {});
        return film;
    }
    ReuseCache& cache() { return *m_cache; }
    int spp() const { return m_settings.spp; }

    FrameStatistics cost;  ///< of the last render()

private:
    RayScene m_rays;
    FrameSettings m_settings;
    std::unique_ptr<FrameRenderer> m_renderer;
    std::vector<ObjectShading> m_direct, m_cached;
    std::unique_ptr<ReuseCache> m_cache;
};

bool same_colours(const Film& a, const Film& b) {
    return std::memcmp(a.color.data(), b.color.data(), a.color.size() * sizeof(glm::vec4)) == 0;
}

/// Every sample is there, from wherever.
void expect_all_samples(const Reused& reused) {
    const ReuseCounts& r = reused.cost.reuse;
    const auto all = std::uint64_t(width * height * reused.spp());
    EXPECT_EQ(r.hits + r.refilled, all);
    EXPECT_EQ(r.refilled, r.misses + r.occluded + r.turned + r.beside);
    // Each has its own ray, or one from its point, or one of those around it has; only after one
    // from its point both.
    const std::uint64_t looked_at = r.rays + r.untested + reused.cost.primary_rays;
    EXPECT_GE(looked_at, all);
    EXPECT_LE(looked_at, all + r.occluded + r.turned);
}

/// A wooden ball and a marble one in front of a stone wall, under a sun; all of it static.
Scene room() {
    Mesh wall;
    wall.P = {{-8, -8, -2}, {8, -8, -2}, {8, 8, -2}, {-8, 8, -2}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    Scene scene = scene_of({object("ball", sphere(1.0f, 48), "wood", {{"ringscale", {3.0f}}}),
                            object("wall", wall, "stone", {{"scale", {0.8f}}}),
                            object("little", sphere(0.4f, 32), "greenmarble", {})});
    Node aside;
    aside.translation = {0.9f, 0.6f, 0.9f};
    scene.nodes.push_back(aside);
    scene.instances[2].node = int(scene.nodes.size()) - 1;
    scene.ambient = glm::vec3(0.2f);
    add_sun(scene, glm::quat(glm::vec3(-0.6f, 0.4f, 0.0f)));
    return scene;
}

/// motion() of a camera that is moved by hand: it is animated for as long.
std::vector<glm::vec2> motion_of(Scene& scene, RayScene& rays, const glm::vec3& before,
                                 const glm::vec3& now) {
    Track<glm::vec3>& walk = scene.nodes[1].translations;
    walk.times = {0.0f, 1.0f};
    walk.values = {before, now};
    std::vector<glm::vec2> places = motion(scene, rays, 0, 0.0, 1.0, width, height);
    walk = {};
    return places;
}

TEST(Reuse, OfTheFirstFrameIsDirectBitByBit) {
    Scene scene = room();
    Reused reused(scene);
    EXPECT_TRUE(same_colours(reused.render(), reused.direct()));
    EXPECT_EQ(reused.cost.reuse.hits, 0u);
    EXPECT_EQ(reused.cost.reuse.kept, reused.cost.samples);
    expect_all_samples(reused);
}

TEST(Reuse, WhereNothingMovesRecallsEverythingAndChangesNothing) {
    Scene scene = room();
    Reused reused(scene);
    const Film first = reused.render();
    for (int frame = 1; frame < 4; ++frame) {
        const Film again = reused.render();
        EXPECT_TRUE(same_colours(again, first));
        EXPECT_EQ(reused.cost.reuse.hits, reused.cost.samples);
        EXPECT_EQ(reused.cost.reuse.occluded, 0u);
        EXPECT_EQ(reused.cost.shadow_rays, 0u);
        EXPECT_EQ(reused.cost.reuse.kept, 0u);
        const std::size_t middle = first.index(35, 25);
        EXPECT_EQ(again.hit[middle], 1.0f);
        EXPECT_EQ(again.age[middle], float(frame));
        EXPECT_EQ(again.occluded[middle], 0.0f);
    }
}

TEST(Reuse, FollowsAMovingCameraCloseToDirect) {
    Scene scene = room();
    Reused reused(scene, 1u << 26, true, 16);
    for (int frame = 0; frame < 8; ++frame) {
        scene.nodes[1].translation = {0.02f * float(frame), 0.01f * float(frame), 4.0f};
        const Film film = reused.render();
        expect_all_samples(reused);
        // Other points of the same pixels: as far apart as two sample patterns are.
        EXPECT_LT(compare_films(film, reused.direct()).rmse, 0.012) << frame;
        if (frame > 0) {
            EXPECT_GT(reused.cost.reuse.hits, reused.cost.samples / 2);
        }
    }
}

/// A pattern that has moved as a whole still gives every pixel as many points as it has samples.
TEST(Reuse, OfAPlaneThatMovesSidewaysNeedsHardlyAnyRay) {
    Mesh wall;
    wall.P = {{-80, -80, 0}, {80, -80, 0}, {80, 80, 0}, {-80, 80, 0}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    Scene scene = scene_of({object("wall", wall)});
    Reused reused(scene, 1u << 26, true, 16);
    reused.render();
    const double across = 2.0 * double(height) * double(reused.spp());
    for (int frame = 1; frame < 6; ++frame) {
        scene.nodes[1].translation.x = 0.023f * float(frame);  // less than half a pixel
        reused.render();
        // What comes in at the border, and points that are two rectangles from an empty one.
        EXPECT_LT(double(reused.cost.reuse.refilled), across + 0.02 * double(reused.cost.samples));
    }
}

/// What changes from frame to frame along the motion and does not in the limit of many samples; and
/// the error itself, which a blur would raise.
TEST(Reuse, FlickersLessThanDirectFramesDo) {
    Scene scene = room();
    Reused reused(scene, 1u << 26, true, 16), reference(scene, 1u << 20, true, 256);
    RayScene rays(scene);
    std::vector<Flicker> of_cache, of_direct;
    std::vector<ImageError> error_of_cache, error_of_direct;
    std::optional<Film> cached_before, direct_before, reference_before;
    glm::vec3 eye_before(0.0f);
    for (int frame = 0; frame < 16; ++frame) {
        const glm::vec3 eye(0.011f * float(frame), 0.005f * float(frame),
                            4.0f - 0.01f * float(frame));
        scene.nodes[1].translation = eye;
        const Film cached = reused.render(), direct = reused.direct();
        if (frame >= 10) {
            const Film wanted = reference.direct();
            if (reference_before) {
                const std::vector<glm::vec2> moved = motion_of(scene, rays, eye_before, eye);
                of_cache.push_back(
                    flicker(*cached_before, cached, *reference_before, wanted, moved));
                of_direct.push_back(
                    flicker(*direct_before, direct, *reference_before, wanted, moved));
                error_of_cache.push_back(compare_films(cached, wanted));
                error_of_direct.push_back(compare_films(direct, wanted));
            }
            reference_before = wanted;
        }
        cached_before = cached;
        direct_before = direct;
        eye_before = eye;
    }
    EXPECT_LT(pooled(of_cache).rms, pooled(of_direct).rms);
    EXPECT_LT(pooled(error_of_cache).rmse, 1.25 * pooled(error_of_direct).rmse);
    RecordProperty("flicker_of_cache", std::to_string(pooled(of_cache).rms));
    RecordProperty("flicker_of_direct", std::to_string(pooled(of_direct).rms));
    RecordProperty("rmse_of_cache", std::to_string(pooled(error_of_cache).rmse));
    RecordProperty("rmse_of_direct", std::to_string(pooled(error_of_direct).rmse));
}

/// Points of the wall that a strip in front of it has just hidden are in its pixels too.
TEST(Reuse, DoesNotMixInWhatLiesBehindOnTheSameObject) {
    Mesh sheets;
    sheets.P = {{-0.6f, -2, 0}, {0.6f, -2, 0}, {0.6f, 2, 0}, {-0.6f, 2, 0},
                {-8, -8, -2},   {8, -8, -2},   {8, 8, -2},   {-8, 8, -2}};
    sheets.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    Scene scene = scene_of({object("sheets", sheets, "wood",
                                   {{"ringscale", {0.2f}},
                                    {"lightwood", {1, 1, 1}},
                                    {"darkwood", {0, 0, 0}},
                                    {"Ka", {1.0f}}})});
    scene.ambient = glm::vec3(1.0f);
    Reused reused(scene, 1u << 26, true, 16);
    for (int frame = 0; frame < 12; ++frame) {
        scene.nodes[1].translation.x = 0.05f * float(frame);
        const Film film = reused.render();
        EXPECT_LT(compare_films(film, reused.direct()).rmse, 0.005) << frame;
    }
}

/// Squares that nobody has seen before, of .25 pixels each, come in front of a wall.
class SpecksThatAppear {
public:
    SpecksThatAppear() {
        const float pixel = 8.0f * std::tan(0.4f) / float(height);
        const auto square = [](Mesh& mesh, const glm::vec2& low, float side) {
            const auto first = std::uint32_t(mesh.P.size());
            for (const glm::vec2 corner :
                 {low, low + glm::vec2(side, 0.0f), low + side, low + glm::vec2(0.0f, side)}) {
                mesh.P.emplace_back(corner, 0.0f);
            }
            mesh.triangles.push_back({first, first + 1, first + 2});
            mesh.triangles.push_back({first, first + 2, first + 3});
        };
        Mesh wall, specks;
        square(wall, glm::vec2(-8.0f), 16.0f);
        for (int i = 0; i < 80; ++i) {  // five pixels apart, at any place in theirs
            const glm::vec2 inside(float(i * 7 % 16), float(i * 11 % 16));
            const glm::vec2 at(float(i % 10 * 5 - 25), float(i / 10 * 5 - 20));
            square(specks, (at + inside / 32.0f) * pixel, 0.5f * pixel);
        }
        const auto ambient = [](const glm::vec3& color) {
            return std::vector<Setting>{{"lightwood", {color.x, color.y, color.z}},
                                        {"darkwood", {color.x, color.y, color.z}},
                                        {"Ka", {1.0f}}};
        };
        scene = scene_of({object("wall", wall, "wood", ambient(glm::vec3(0.0f))),
                          object("specks", specks, "wood", ambient(glm::vec3(1.0f)))});
        scene.nodes.emplace_back();
        scene.instances[1].node = 2;
    }

    /// Share of the specks that is missing in each of some frames from their first on.
    std::vector<double> missing(bool tests_all, int frames) {
        Reused reused(scene, 1u << 26, true, 16, tests_all);
        scene.nodes[2].translation.z = 10.0f;  // behind the camera
        reused.render();
        scene.nodes[2].translation.z = 0.0001f;
        std::vector<double> shares;
        for (int frame = 0; frame < frames; ++frame) {
            const Film film = reused.render();
            expect_all_samples(reused);
            untested = reused.cost.reuse.untested;
            shares.push_back(1.0 - brightness(film) / brightness(reused.direct()));
        }
        return shares;
    }

    Scene scene;
    std::uint64_t untested = 0;  ///< in the last frame

private:
    static double brightness(const Film& film) {
        double sum = 0.0;
        for (const glm::vec4& color : film.color) sum += color.x;
        return sum;
    }
};

TEST(Reuse, FindsSpecksThatAppearIfAllPointsAreTested) {
    SpecksThatAppear specks;
    EXPECT_NEAR(specks.missing(true, 1).front(), 0.0, 0.02);
    EXPECT_EQ(specks.untested, 0u);
}

/// As tile_reuse.cpp says of its tests of some points: of 4, c = 1/4.
TEST(Reuse, MissesSpecksThatAppearNoMoreThanItSays) {
    SpecksThatAppear specks;
    const std::vector<double> missing = specks.missing(false, 6);
    EXPECT_LT(missing[0], std::pow(0.75, 4.0));
    EXPECT_GT(specks.untested, 0u);
    for (std::size_t frame = 4; frame < missing.size(); ++frame) {
        EXPECT_NEAR(missing[frame], 0.0, 0.02) << frame;
    }
}

TEST(Reuse, KeepsAlphaWhereTheBackgroundIsSeen) {
    Scene scene = scene_of({object("ball", sphere(1.0f, 48))});
    Reused reused(scene, 1u << 26, true, 16);
    reused.render();
    scene.nodes[1].translation.x = 0.05f;
    const Film film = reused.render(), direct = reused.direct();
    double covered = 0.0, expected = 0.0;
    for (std::size_t i = 0; i < film.color.size(); ++i) {
        covered += double(film.color[i].a);
        expected += double(direct.color[i].a);
    }
    // Rectangles on the silhouette may take either side: half of one along all of it, at most.
    EXPECT_NEAR(covered, expected, 0.01 * expected);
}

TEST(Reuse, IsTheSameWithOneThreadAndFour) {
    std::vector<Film> last;
    std::vector<ReuseCounts> counts;
    for (const std::size_t threads : {1u, 4u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        Scene scene = room();
        Reused reused(scene, 1u << 19);  // so small that points are evicted
        for (int frame = 0; frame < 6; ++frame) {
            scene.nodes[1].translation.x = 1.5f * float(frame);
            Film film = reused.render();
            if (frame == 5) last.push_back(std::move(film));
        }
        counts.push_back(reused.cost.reuse);
    }
    EXPECT_TRUE(same_colours(last[0], last[1]));
    EXPECT_EQ(counts[0].hits, counts[1].hits);
    EXPECT_EQ(counts[0].evicted, counts[1].evicted);
    EXPECT_EQ(counts[0].records, counts[1].records);
    EXPECT_GT(counts[0].evicted, 0u);
}

TEST(Reuse, WithAPageOrTwoIsNoWorseThanDirect) {
    for (const std::uint64_t pages : {1u, 2u, 5u}) {
        Scene scene = room();
        Reused reused(scene, pages * ReuseCache::page_bytes, true, 16);
        for (int frame = 0; frame < 4; ++frame) {
            scene.nodes[1].translation.x = 0.05f * float(frame);
            const Film film = reused.render();
            expect_all_samples(reused);
            EXPECT_LT(compare_films(film, reused.direct()).rmse, 0.012);
            EXPECT_GT(reused.cost.reuse.refused, 0u);
            EXPECT_LE(reused.cost.reuse.bytes, pages * ReuseCache::page_bytes);
        }
    }
}

TEST(Reuse, AfterATurnOfTheCameraIsDirectBitByBit) {
    Scene scene = room();
    Reused reused(scene);
    reused.render();
    scene.nodes[1].rotation = glm::quat(glm::vec3(0.0f, 3.14159265f, 0.0f));
    const Film behind = reused.render();  // nothing is there, and all points are behind the eye
    EXPECT_EQ(reused.cost.reuse.hits, 0u);
    EXPECT_TRUE(same_colours(behind, reused.direct()));
    scene.nodes[1].rotation = glm::quat(1.0f, 0.0f, 0.0f, 0.0f);
    reused.render();
    EXPECT_EQ(reused.cost.reuse.hits, reused.cost.samples);  // they have not been forgotten
}

TEST(Reuse, StandsACameraCutIntoTheSceneItself) {
    Scene scene = room();
    Reused reused(scene, 1u << 26, true, 16);
    reused.render();
    // On the surface of the ball, in the wall, within the ball, and far away.
    for (const glm::vec3 eye : {glm::vec3(0.0f, 0.0f, 1.0f), glm::vec3(0.5f, 0.5f, -2.0f),
                                glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, 1e5f)}) {
        scene.nodes[1].translation = eye;
        const Film film = reused.render();
        expect_all_samples(reused);
        EXPECT_EQ(reused.cost.bad_pixels, 0u);
        EXPECT_LT(compare_films(film, reused.direct()).rmse, 0.02);
    }
}

TEST(Reuse, TakesASheetFromItsOtherSideForWhatItIs) {
    Mesh sheet;
    sheet.P = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    Scene scene = scene_of({object("sheet", sheet)});
    scene.ambient = glm::vec3(0.0f);
    add_sun(scene, glm::quat(1.0f, 0.0f, 0.0f, 0.0f));  // on the front alone
    Reused reused(scene);
    const Film front = reused.render();
    EXPECT_GT(front.color[front.index(35, 25)].r, 0.2f);
    scene.nodes[1].translation = {0.0f, 0.0f, -4.0f};
    scene.nodes[1].rotation = glm::quat(glm::vec3(0.0f, 3.14159265f, 0.0f));
    const Film back = reused.render();
    EXPECT_GT(reused.cost.reuse.turned, 0u);
    EXPECT_EQ(back.color[back.index(35, 25)].r, 0.0f);
    EXPECT_LT(compare_films(back, reused.direct()).max, 1e-6);
}

TEST(Reuse, GoesAroundASolidWithoutLosingItsPoints) {
    Scene scene = scene_of({object("ball", sphere(1.0f, 48), "wood", {{"ringscale", {3.0f}}})});
    add_sun(scene, glm::quat(glm::vec3(-0.6f, 0.4f, 0.0f)));
    Reused reused(scene);
    for (int frame = 0; frame < 150; ++frame) {  // three degrees a frame
        const glm::quat turn(glm::vec3(0.0f, 3.14159265f * float(frame) / 60.0f, 0.0f));
        scene.nodes[1].rotation = turn;
        scene.nodes[1].translation = turn * glm::vec3(0.0f, 0.0f, 4.0f);
        reused.render();
        // Points of the far side are in the silhouette too, and older than those of the near one.
        if (frame > 0) {
            EXPECT_GT(double(reused.cost.reuse.hits), 0.6 * double(reused.cost.samples)) << frame;
        }
    }
}

TEST(Reuse, TakesPointsOnTheBorderOfTheImageAndAtTheEye) {
    Scene scene = room();
    Reused reused(scene, 1u << 26, true, 16);
    reused.render();
    // Right up to the ball's front, through it and out of it again: z of its points comes to 0.
    for (const float z : {1.5f, 1.001f, 1.0f, 0.999f, 0.5f, 4.0f}) {
        scene.nodes[1].translation.z = z;
        const Film film = reused.render();
        expect_all_samples(reused);
        EXPECT_EQ(reused.cost.bad_pixels, 0u);
        EXPECT_LT(compare_films(film, reused.direct()).rmse, 0.03) << z;
    }
}

/// README, "Outlines": whatever is kept of the two sides.
TEST(Reuse, KeepsAnOutlineWhereItIs) {
    for (const int spp : {1, 4, 16}) {
        Scene scene = scene_of({object("ball", sphere(1.0f, 48))});
        Reused reused(scene, 1u << 26, true, spp);
        double grown = 0.0;
        for (int frame = 0; frame < 12; ++frame) {
            scene.nodes[1].translation = {0.013f * float(frame), 0.007f * float(frame), 4.0f};
            const Film film = reused.render(), direct = reused.direct();
            double covered = 0.0, expected = 0.0;
            for (std::size_t i = 0; i < film.color.size(); ++i) {
                covered += double(film.color[i].a);
                expected += double(direct.color[i].a);
            }
            const double radius = std::sqrt(expected / 3.14159265);
            grown = covered / (2.0 * 3.14159265 * radius) - radius / 2.0;  // pixels, outwards
        }
        RecordProperty("grown_at_" + std::to_string(spp), std::to_string(grown));
        EXPECT_LT(std::abs(grown), 0.02) << spp;
    }
}

TEST(Reuse, FollowsMovingObjectsAndWhatTheyHide) {
    Scene scene = room();
    Reused reused(scene, 1u << 26, false, 16);  // light changes: shadows move
    for (int frame = 0; frame < 8; ++frame) {
        scene.nodes[2].translation.x = 0.9f - 0.15f * float(frame);
        scene.nodes[0].rotation = glm::quat(glm::vec3(0.0f, 0.02f * float(frame), 0.0f));
        const Film film = reused.render();
        expect_all_samples(reused);
        EXPECT_LT(compare_films(film, reused.direct()).rmse, 0.015) << frame;
        if (frame > 0) {
            EXPECT_GT(reused.cost.reuse.occluded, 0u);
            EXPECT_GT(reused.cost.shadow_rays, 0u);
        }
    }
}

TEST(Reuse, ForgetsAnObjectThatIsScaledToNothing) {
    Scene scene = room();
    Reused reused(scene, 1u << 26, false);
    reused.render();
    scene.nodes[2].scale = glm::vec3(0.0f);
    EXPECT_LT(compare_films(reused.render(), reused.direct()).max, 1e-6);
    scene.nodes[2].scale = glm::vec3(1.0f);
    EXPECT_LT(compare_films(reused.render(), reused.direct()).rmse, 0.012);
}

TEST(Reuse, KeepsShadowsWhereTheyAre) {
    Scene scene = room();
    Reused reused(scene, 1u << 26, true, 16);
    reused.render();
    for (int frame = 1; frame < 5; ++frame) {
        scene.nodes[1].translation = {0.0f, 0.0f, 4.0f - 0.05f * float(frame)};
        const Film film = reused.render();
        EXPECT_LT(reused.cost.shadow_rays, reused.cost.reuse.refilled + 1);
        EXPECT_LT(compare_films(film, reused.direct()).rmse, 0.012);
    }
}

/// A point of a convex body that faces the eye is hidden by nothing: what is called hidden is
/// where the surface turns away, or an error of the self-intersection bound.
TEST(Reuse, CallsNothingHiddenOnAConvexBodyOfAnySizeAnywhere) {
    struct Place {
        float radius;
        glm::vec3 centre;
    };
    for (const Place& place : {Place{1.0f, {0, 0, 0}}, Place{1e-4f, {0, 0, 0}},
                               Place{1e4f, {0, 0, 0}}, Place{1.0f, {3e3f, -2e3f, 1e3f}}}) {
        Scene scene = scene_of({object("ball", sphere(1.0f, 64))});
        scene.nodes[0].scale = glm::vec3(place.radius);
        scene.nodes[0].translation = place.centre;
        const auto look_from = [&](float x) {
            scene.nodes[1].translation = place.centre + place.radius * glm::vec3(x, 0.0f, 4.0f);
        };
        look_from(0.0f);
        Reused reused(scene, 1u << 26, true, 16);
        reused.render();
        look_from(0.02f);
        reused.render();
        EXPECT_LT(double(reused.cost.reuse.occluded), 0.003 * double(reused.cost.samples))
            << place.radius;
        EXPECT_GT(double(reused.cost.reuse.hits), 0.8 * double(reused.cost.samples));
    }
}

/// The scene as it is, evaluated directly.
Film direct_picture(const Scene& scene, int spp, std::uint32_t seed) {
    RayScene rays(scene);
    FrameSettings settings;
    settings.width = width;
    settings.height = height;
    settings.spp = spp;
    settings.seed = seed;
    std::vector<ObjectShading> shading;
    for (const Object& o : scene.objects) shading.push_back({o.shader, nullptr, 0.01f});
    Film film(width, height, {});
    FrameRenderer(scene, rays, settings).render(shading, 0, 0.0, film, {});
    return film;
}

double mean_of(const Film& film) {
    double sum = 0.0;
    for (const glm::vec4& c : film.color) sum += double(c.r) + double(c.g) + double(c.b);
    return sum / (3.0 * double(film.color.size()));
}

/// Recalled pictures of what moves are as far from the truth as those of other sample patterns.
/// `move` puts a frame's pose into the scene.
template <class Move>
void expect_another_pattern(Scene scene, int spp, const Move& move) {
    Reused reused(scene, 1u << 26, false, spp);
    double squares = 0.0, others = 0.0, worst = 0.0, worst_other = 0.0, darker = 0.0;
    for (int frame = 0; frame < 6; ++frame) {
        move(scene, frame);
        const Film recalled = reused.render();
        if (frame == 0) continue;
        EXPECT_GT(reused.cost.reuse.hits, reused.cost.samples / 2);
        const Film truth = direct_picture(scene, 256, 0);
        const ImageError error = compare_films(recalled, truth);
        squares += error.rmse * error.rmse;
        worst = std::max(worst, error.max);
        darker += mean_of(recalled) - mean_of(truth);
        for (const std::uint32_t seed : {1u, 2u, 3u}) {
            const ImageError other = compare_films(direct_picture(scene, spp, seed), truth);
            others += other.rmse * other.rmse / 3.0;
            worst_other = std::max(worst_other, other.max);
        }
    }
    // One sample of the pattern is the pixel's centre, of the cache any point of it. Many lie less
    // evenly than a pattern's, which shows in single pixels.
    EXPECT_LT(std::sqrt(squares), (spp == 1 ? 1.35 : 1.05) * std::sqrt(others));
    EXPECT_LT(worst, 1.75 * worst_other);
    EXPECT_LT(std::abs(darker / 5.0), spp == 1 ? 0.00075 : 0.0003);
}

class ReuseOfWhatMoves : public testing::TestWithParam<int> {};

TEST_P(ReuseOfWhatMoves, IsAnotherSamplePattern) {
    Scene scene = room();
    scene.objects[0] = object("ball", sphere(1.0f, 16), "plastic", {{"roughness", {0.05f}}});
    expect_another_pattern(scene, GetParam(), [](Scene& s, int frame) {
        s.nodes[0].rotation = glm::angleAxis(0.06f * float(frame), glm::vec3(0.6f, 0.8f, 0.0f));
        s.nodes[0].translation.x = 0.04 * frame;
    });
}

TEST_P(ReuseOfWhatMoves, IsAnotherSamplePatternOfWhatBends) {
    Scene scene = room();
    MorphTarget longer;
    for (const glm::vec3& P : scene.objects[0].mesh.P) {
        longer.P.emplace_back(0.3f * P.y * P.y, 0.2f * P.y, 0.0f);
    }
    scene.objects[0].bends.targets = {longer};
    scene.nodes[0].weights = {0.01f};
    expect_another_pattern(scene, GetParam(), [](Scene& s, int frame) {
        s.nodes[0].weights = {0.01f + 0.1f * float(frame)};
    });
}

/// Away from the eye points come to lie two and three in a rectangle, and are averaged.
TEST_P(ReuseOfWhatMoves, IsAnotherSamplePatternOfWhatGoesAway) {
    Scene scene = room();
    scene.objects[0] = object("ball", sphere(1.0f, 16), "plastic", {{"roughness", {0.05f}}});
    expect_another_pattern(scene, GetParam(), [](Scene& s, int frame) {
        s.nodes[1].translation.z = 4.0 + 0.12 * frame;
        s.nodes[0].rotation = glm::angleAxis(0.03f * float(frame), glm::vec3(0.6f, 0.8f, 0.0f));
    });
}

INSTANTIATE_TEST_SUITE_P(Samples, ReuseOfWhatMoves, testing::Values(1, 4, 16));

}  // namespace
}  // namespace estara
