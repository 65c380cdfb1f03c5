#include "estara/render/flicker.h"

#include <gtest/gtest.h>

#include <cmath>

#include "small_scene.h"

namespace estara {
namespace {

using test::object;
using test::scene_of;
using test::sphere;

constexpr int width = 40, height = 30;

/// A wall across the view and a camera that moves by one pixel a second to the right.
Scene wall() {
    Mesh mesh;
    mesh.P = {{-90, -90, 0}, {90, -90, 0}, {90, 90, 0}, {-90, 90, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return scene_of({object("wall", mesh)});
}

TEST(Motion, OfAStillViewIsTheRestingPixel) {
    const Scene scene = wall();
    RayScene rays(scene);
    const std::vector<glm::vec2> places = motion(scene, rays, 0, 0.0, 1.0, width, height);
    int known = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const glm::vec2 place = places[std::size_t(y * width + x)];
            if (std::isnan(place.x)) continue;
            ++known;
            EXPECT_NEAR(place.x, float(x) + 0.5f, 1e-3f);
            EXPECT_NEAR(place.y, float(y) + 0.5f, 1e-3f);
        }
    }
    EXPECT_GT(known, (width - 3) * (height - 3));
}

TEST(Motion, IsUnknownWhereNothingWasSeen) {
    const Scene scene = scene_of({object("ball", sphere(0.5f))});
    RayScene rays(scene);
    const std::vector<glm::vec2> places = motion(scene, rays, 0, 0.0, 1.0, width, height);
    EXPECT_TRUE(std::isnan(places.front().x));
    EXPECT_FALSE(std::isnan(places[std::size_t(height / 2 * width + width / 2)].x));
}

Film painted(float (*color)(int, int)) {
    Film film(width, height, {});
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            film.color[film.index(x, y)] = glm::vec4(glm::vec3(color(x, y)), 1.0f);
        }
    }
    return film;
}

/// Everything moved by a pixel to the left from before to now.
std::vector<glm::vec2> shifted() {
    std::vector<glm::vec2> places(std::size_t(width) * std::size_t(height),
                                  glm::vec2(std::nanf("")));
    for (int y = 1; y < height - 1; ++y) {
        for (int x = 1; x < width - 3; ++x) {
            places[std::size_t(y * width + x)] = {float(x) + 1.5f, float(y) + 0.5f};
        }
    }
    return places;
}

TEST(Flicker, OfAPictureThatMovesAsItShouldIsNone) {
    const Film before = painted([](int x, int y) { return std::sin(float(x * 3 + y)); });
    const Film now = painted([](int x, int y) { return std::sin(float((x + 1) * 3 + y)); });
    const Film flat = painted([](int, int) { return 0.5f; });
    const Flicker none = flicker(before, now, flat, flat, shifted());
    EXPECT_LT(none.rms, 1e-5);
    EXPECT_EQ(none.pixels, std::uint64_t((width - 4) * (height - 2)));
}

TEST(Flicker, IsWhatChangesAndNotWhatIsWrongAllAlong) {
    const Film flat = painted([](int, int) { return 0.5f; });
    const Film wrong = painted([](int, int) { return 0.7f; });
    const Film worse = painted([](int, int) { return 0.8f; });
    EXPECT_LT(flicker(wrong, wrong, flat, flat, shifted()).rms,
              1e-6);  // an error, but a steady one
    EXPECT_NEAR(flicker(wrong, worse, flat, flat, shifted()).rms, 0.1, 1e-6);
    EXPECT_NEAR(flicker(wrong, worse, flat, flat, shifted()).p99, 0.1, 1e-6);
    EXPECT_LT(flicker(wrong, worse, wrong, worse, shifted()).rms, 1e-6);  // the reference does so
}

TEST(Flicker, OfSeveralFramesIsThatOfAllTheirPixels) {
    const Flicker all = pooled({{0.3, 0.5, 100}, {0.1, 0.9, 300}});
    EXPECT_NEAR(all.rms, std::sqrt((9.0 * 100 + 1.0 * 300) / 400.0) / 10.0, 1e-12);
    EXPECT_EQ(all.p99, 0.9);
    EXPECT_EQ(all.pixels, 400u);
}

}  // namespace
}  // namespace estara
