// The example scenes, from the program that writes them to the loader that reads them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "estara/scenes/load.h"
#include "estara/scenes/ray_scene.h"

namespace estara::test {
namespace {

using ::testing::IsEmpty;
namespace fs = std::filesystem;

/// A folder of its own that is gone after the test.
class Folder {
public:
    Folder() {
        std::string name = (fs::temp_directory_path() / "estara-examples-XXXXXX").string();
        m_path = mkdtemp(name.data());
    }
    ~Folder() { fs::remove_all(m_path); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::string operator/(const std::string& name) const { return (m_path / name).string(); }

private:
    fs::path m_path;
};

struct Outcome {
    int status;
    std::string text;  ///< stdout and stderr
};

Outcome estara_scenes(const std::string& arguments) {
    FILE* pipe = popen((ESTARA_BIN "/estara-scenes " + arguments + " 2>&1").c_str(), "r");
    std::string text;
    std::array<char, 4096> part{};
    while (const std::size_t n = fread(part.data(), 1, part.size(), pipe))
        text.append(part.data(), n);
    const int status = pclose(pipe);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text};
}

Scene example(const std::string& name) {
    const Folder folder;
    const std::string path = folder / (name + ".glb");
    const Outcome outcome = estara_scenes(name + " -o " + path);
    EXPECT_EQ(outcome.status, 0) << outcome.text;
    EXPECT_EQ(outcome.text, "");
    return load_scene(path);
}

/// Vertices in one place are one corner.
struct Edges {
    std::map<std::pair<int, int>, int>
        balance;  ///< crossings from lower to higher corner, less back

    explicit Edges(const Mesh& mesh) {
        std::map<std::array<float, 3>, int> corners;
        const auto corner = [&](glm::uint i) {
            const glm::vec3 p = mesh.P[i] + 0.0f;  // -0 is 0
            return corners.try_emplace({p.x, p.y, p.z}, int(corners.size())).first->second;
        };
        for (const glm::uvec3& t : mesh.triangles)
            for (int c = 0; c < 3; ++c) {
                const int a = corner(t[c]), b = corner(t[(c + 1) % 3]);
                balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
            }
    }
    /// Each edge is gone along as often one way as the other: watertight, and turned one way.
    bool closed() const {
        return std::all_of(balance.begin(), balance.end(),
                           [](const auto& edge) { return edge.second == 0; });
    }
};

/// Checks what every mesh of an example promises.
void expect_sound(const Object& object, bool closed) {
    SCOPED_TRACE(object.name);
    const Mesh& mesh = object.mesh;
    ASSERT_FALSE(mesh.triangles.empty());
    ASSERT_EQ(mesh.N.size(), mesh.P.size());
    ASSERT_EQ(mesh.uv.size(), mesh.P.size());
    int flat = 0, turned = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.P[t.x]), b(mesh.P[t.y]), c(mesh.P[t.z]);
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        flat += glm::length(normal) == 0.0;
        for (int k = 0; k < 3; ++k) turned += glm::dot(normal, glm::dvec3(mesh.N[t[k]])) < 0.0;
    }
    EXPECT_EQ(flat, 0);
    EXPECT_EQ(turned, 0);
    EXPECT_EQ(Edges(mesh).closed(), closed);
}

int triangles(const Scene& scene) {
    int n = 0;
    for (const Object& object : scene.objects) n += int(object.mesh.triangles.size());
    return n;
}

/// How much of an image meets anything, and which objects it shows.
std::pair<double, std::set<int>> seen(const Scene& scene, RayScene& rays, double time) {
    constexpr int width = 320, height = 180;
    const Pose pose = pose_at(scene, time);
    rays.set_pose(pose);
    const PinholePose camera = pinhole_pose(scene, scene.cameras[0], pose);
    std::vector<Ray> some;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            some.push_back({camera.eye,
                            camera.direction(float(x) + 0.5f, float(y) + 0.5f, width, height), 0.0f,
                            INFINITY});
    std::vector<Hit> hits(some.size());
    rays.intersect(some, hits.data());
    std::set<int> objects;
    int count = 0;
    for (const Hit& hit : hits)
        if (hit.instance != Hit::none) {
            ++count;
            objects.insert(scene.instances[hit.instance].object);
        }
    return {double(count) / (width * height), objects};
}

TEST(StillLife, WearsAllFourShadersOnManySmoothObjects) {
    const Scene scene = example("still-life");
    EXPECT_THAT(scene.warnings, IsEmpty());
    EXPECT_GE(scene.objects.size(), 7u);
    EXPECT_GE(triangles(scene), 350000);
    EXPECT_LE(triangles(scene), 450000);
    std::map<std::string, std::set<std::string>> settings;  // by shader
    for (const Object& object : scene.objects)
        settings[object.choice.name].insert(shader_digest(*object.shader));
    for (const char* shader : {"wood", "stone", "cobblestone", "greenmarble"})
        EXPECT_GE(settings[shader].size(), 2u) << shader;
    for (const Object& object : scene.objects)
        expect_sound(object, object.name != "table" && object.name != "backdrop");
}

TEST(StillLife, IsFullyInViewAllTheWayAround) {
    const Scene scene = example("still-life");
    RayScene rays(scene);
    for (const int frame : {1, 7, 13, 19, 25, 31, 37, 43}) {
        SCOPED_TRACE(frame);
        const auto [covered, objects] = seen(scene, rays, frame / 24.0);
        EXPECT_EQ(covered, 1.0);
        EXPECT_GE(objects.size(), 9u);
    }
}

TEST(StillLife, IsGoneAroundOnceIn48Frames) {
    const Scene scene = example("still-life");
    const FrameRange range = animated_frames(scene, 24.0);
    EXPECT_EQ(range.first, 1);
    EXPECT_EQ(range.last, 48);
    const auto angle = [&](int frame) {
        const PinholePose camera =
            pinhole_pose(scene, scene.cameras[0], pose_at(scene, frame / 24.0));
        return std::atan2(camera.eye.x, camera.eye.z);
    };
    for (int frame = 1; frame < 48; ++frame) {
        const double step = std::remainder(angle(frame + 1) - angle(frame), 2 * std::numbers::pi);
        EXPECT_NEAR(step, 2 * std::numbers::pi / 48, 1e-4) << frame;
    }
}

TEST(StillLife, IsLitByAKeyAndAFillOfAFifth) {
    const Scene scene = example("still-life");
    ASSERT_EQ(scene.lights.size(), 2u);
    const glm::vec3 middle(0.0f, 0.3f, 0.0f);
    std::vector<float> strength;
    for (const PosedLight& light : posed_lights(scene, pose_at(scene, 0.0)))
        strength.push_back(sample_light(light, middle).Cl.r);
    EXPECT_GT(strength[0], 1.0f);
    EXPECT_LT(strength[0], 1.5f);
    EXPECT_NEAR(strength[1] / strength[0], 0.2f, 0.1f);
    for (int c = 0; c < 3; ++c) {
        EXPECT_GE(scene.ambient[c], 0.3f);
        EXPECT_LE(scene.ambient[c], 1.0f);
    }
}

TEST(Tumble, TurnsOneShadedObjectBeforeAStillCamera) {
    const Scene scene = example("tumble");
    EXPECT_THAT(scene.warnings, IsEmpty());
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[0].choice.name, "wood");
    expect_sound(scene.objects[0], true);
    expect_sound(scene.objects[1], false);
    const FrameRange range = animated_frames(scene, 24.0);
    EXPECT_EQ(range.first, 1);
    EXPECT_EQ(range.last, 48);

    const int node = scene.instances[0].node, camera = scene.cameras[0].node;
    const Pose begin = pose_at(scene, 1 / 24.0), later = pose_at(scene, 20 / 24.0);
    EXPECT_EQ(begin.world_from_node[camera], later.world_from_node[camera]);
    EXPECT_GT(glm::length(begin.world_from_node[node][3] - later.world_from_node[node][3]), 0.5f);
    EXPECT_GT(glm::length(begin.world_from_node[node][0] - later.world_from_node[node][0]), 0.5f);
}

TEST(Tumble, KeepsItsObjectInViewAndItsImageFull) {
    const Scene scene = example("tumble");
    RayScene rays(scene);
    for (const int frame : {1, 12, 24, 36, 48}) {
        const auto [covered, objects] = seen(scene, rays, frame / 24.0);
        EXPECT_EQ(covered, 1.0) << frame;
        EXPECT_EQ(objects, (std::set<int>{0, 1})) << frame;
    }
}

TEST(Examples, AreTheSameFileEveryTime) {
    const Folder folder;
    const auto bytes = [&](const std::string& name) {
        EXPECT_EQ(estara_scenes("tumble -o " + (folder / name)).status, 0);
        std::ifstream file(folder / name, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    const std::string first = bytes("a.glb");
    EXPECT_GT(first.size(), 1000000u);
    EXPECT_TRUE(first == bytes("b.glb"));
}

TEST(Examples, AreListed) {
    const Outcome outcome = estara_scenes("--list");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.text,
              "still-life   wood, marble and stone on a table, the camera goes around\n"
              "tumble       a wooden knot that flies and turns, the camera stands still\n"
              "simple       each of the paper's eleven shaders on an object of its own\n"
              "face         a head of skin in a bust of green marble, the camera passes by\n"
              "face-b       the same head, its skin darker, oilier and more blemished\n"
              "interior     a furnished room in ten shaders, the camera walks in and turns\n");
}

TEST(Examples, SayWhatIsWrongInOneLine) {
    const Folder folder;
    const std::pair<std::string, std::string> cases[]{
        {"", "no scene named; estara-scenes --list says which there are"},
        {"teapot -o x.glb", "no scene 'teapot'; there are: still-life, tumble, simple, face, face-b, interior"},
        {"tumble", "no file named; say where to write with -o FILE.glb"},
        {"tumble -o x.obj", "x.obj: scenes are written as .glb; give the name that ending"},
        {"tumble --colour", "no option --colour; --help lists the options"},
    };
    for (const auto& [arguments, message] : cases) {
        const Outcome outcome = estara_scenes(arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_EQ(outcome.text, "estara-scenes: " + message + "\n");
    }
}

TEST(Examples, AreWholeOrNotThereWhenTheDiskIsFull) {
    const Outcome full = estara_scenes("tumble -o /dev/full/x.glb");
    EXPECT_NE(full.status, 0);
    // A limit on the size of files stands for the disk: the write fails half way.
    const Folder folder;
    const std::string path = folder / "x.glb";
    const std::string limited = "trap '' XFSZ; ulimit -f 100; " ESTARA_BIN
                                "/estara-scenes tumble -o " +
                                path + " 2> " + (folder / "said");
    const int status = std::system(("sh -c \"" + limited + "\"").c_str());
    EXPECT_EQ(WEXITSTATUS(status), 1);
    std::ifstream said(folder / "said");
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(said), {}),
              "estara-scenes: " + path + ": cannot be written whole; is the disk full?\n");
    EXPECT_FALSE(fs::exists(path));
    EXPECT_EQ(std::distance(fs::directory_iterator(fs::path(path).parent_path()), {}), 1)
        << "a temporary file was left";
}

}  // namespace
}  // namespace estara::test
