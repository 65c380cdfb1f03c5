// A pattern belongs to its object: it moves with it from frame to frame.
#include <cmath>
#include <optional>

#include "../programs.h"
#include "estara/scenes/load.h"

namespace estara {
namespace {

using test::done_in;
using test::Image;
using test::TemporaryFolder;

constexpr int width = 480, height = 270;

/// Where the knot of `tumble` and its camera are in a frame, and what a picture shows of it.
struct Frame {
    glm::mat4 world_from_object;
    PinholePose camera;
    Image image;
    int albedo, position;  ///< first channels

    glm::vec3 P(int x, int y) const {
        const auto p = image.triple(x, y, position);
        return {p[0], p[1], p[2]};
    }
    glm::vec3 color(int x, int y) const {
        const auto c = image.triple(x, y, albedo);
        return {c[0], c[1], c[2]};
    }
    /// The wood has no blue above 0.09, the ground has 0.38.
    bool shows_wood(int x, int y) const { return color(x, y).z < 0.2f; }

    /// Where a point is in the picture; (0, 0) the upper left corner of the upper left pixel.
    glm::vec2 pixel(const glm::vec3& p) const {
        const glm::vec3 d = p - camera.eye;
        const float depth = glm::dot(d, camera.forward);
        const float scale = float(height) / (2.0f * camera.tan_half_yfov * depth);
        return {0.5f * width + glm::dot(d, camera.right) * scale,
                0.5f * height - glm::dot(d, camera.up) * scale};
    }
};

Frame frame_of(const Scene& scene, const TemporaryFolder& folder, int number) {
    const Pose pose = pose_at(scene, number / 24.0);
    const auto knot = std::find_if(
        scene.instances.begin(), scene.instances.end(),
        [&](const Instance& i) { return scene.objects[std::size_t(i.object)].name == "knot"; });
    Image image(folder / (std::to_string(number) + ".exr"));
    const int albedo = image.channel("albedo.R"), position = image.channel("P.X");
    return {pose.world_from_node[std::size_t(knot->node)],
            pinhole_pose(scene, scene.cameras.front(), pose), std::move(image), albedo, position};
}

struct Mean {
    double sum = 0.0;
    int count = 0;
    void add(double value) {
        sum += value;
        ++count;
    }
    double value() const { return sum / std::max(1, count); }
};

/// Mean difference of albedo between a and b at points of the knot, followed by its motion from a
/// to b or, without `follow`, staying in the world.
///
/// Only pairs are taken that show the same point: less than a tenth of a pixel beside the centre of
/// a pixel of b, and in the depth that is seen there.
Mean difference(const Frame& a, const Frame& b, bool follow) {
    const glm::mat4 motion =
        follow ? b.world_from_object * glm::inverse(a.world_from_object) : glm::mat4(1.0f);
    Mean mean;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (!a.shows_wood(x, y)) continue;
            const glm::vec3 p(motion * glm::vec4(a.P(x, y), 1.0f));
            const glm::vec2 at = b.pixel(p);
            const int u = int(std::floor(at.x)), v = int(std::floor(at.y));
            if (u < 0 || v < 0 || u >= width || v >= height || !b.shows_wood(u, v)) continue;
            if (glm::distance(at, glm::vec2(u + 0.5f, v + 0.5f)) > 0.1f && follow) continue;
            if (glm::distance(b.P(u, v), p) > 0.002f && follow) continue;  // a fifth of a pixel
            const glm::vec3 d = glm::abs(a.color(x, y) - b.color(u, v));
            mean.add((d.x + d.y + d.z) / 3.0f);
        }
    }
    return mean;
}

class Tumble : public ::testing::TestWithParam<const char*> {};

TEST_P(Tumble, CarriesItsPatternAlong) {
    const TemporaryFolder folder;
    done_in(folder, "estara-scenes tumble -o tumble.glb");
    done_in(folder, "estara-bake wood tumble.glb -o wood.vdb --resolution 480x270 --progress none");
    done_in(folder,
            std::string("estara-render tumble.glb --grids wood.vdb --frames 20-26x3 --spp 1 "
                        "--resolution 480x270 --aov albedo --aov P -o '#.exr' "
                        "--progress none --strategy ") +
                GetParam());
    const Scene scene = load_scene(folder / "tumble.glb");
    const Frame a = frame_of(scene, folder, 20);
    for (const int number : {23, 26}) {
        const Frame b = frame_of(scene, folder, number);
        const Mean moved = difference(a, b, true), unmoved = difference(a, b, false);
        EXPECT_GT(moved.count, 100);
        EXPECT_GT(unmoved.count, 1000);
        // A tenth of a pixel of a ring's edge, and half floats.
        EXPECT_LT(moved.value(), 0.008);
        EXPECT_GT(unmoved.value(), 0.03);
    }
}

INSTANTIATE_TEST_SUITE_P(With, Tumble, ::testing::Values("grid", "direct"),
                         [](const auto& named) { return std::string(named.param); });

}  // namespace
}  // namespace estara
