// The example scenes, from the program that writes them to the loader that reads them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <string>

#include "../text_of.h"
#include "estara/scenes/load.h"
#include "estara/scenes/ray_scene.h"
#include "estara/scenes/static_light.h"

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

/// The JSON of a .glb file, its first chunk.
nlohmann::json json_of(const std::string& path) {
    const std::string file = text_of(path);
    std::uint32_t size = 0;
    std::memcpy(&size, file.data() + 12, sizeof size);
    return nlohmann::json::parse(file.substr(20, size));
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

TEST(Examples, CamerasSeeFarInOtherProgramsToo) {
    const Folder folder;
    const std::string path = folder / "simple.glb";
    ASSERT_EQ(estara_scenes("simple -o " + path).status, 0);
    const nlohmann::json lens = json_of(path).at("cameras").at(0).at("perspective");
    EXPECT_GT(lens.at("znear"), 0.0);
    EXPECT_GT(lens.at("zfar"), 100.0);
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

/// Points on a mesh: many on each of few triangles, or one on each tenth of many.
std::vector<MeshPoint> some_points(const Mesh& mesh) {
    std::vector<MeshPoint> points;
    const bool few = mesh.triangles.size() < 2000;
    const int n = few ? 6 : 1;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += few ? 1 : 10)
        for (int i = 0; i < n; ++i)
            for (int j = 0; i + j < n; ++j)
                points.push_back(mesh_point(mesh, std::uint32_t(t), (float(i) + 0.33f) / float(n),
                                            (float(j) + 0.33f) / float(n)));
    return points;
}

PinholePose camera_at(const Scene& scene, int frame) {
    return pinhole_pose(scene, scene.cameras[0], pose_at(scene, frame / 24.0));
}

/// How far what the camera sees moves from one frame to the next in an image 360 pixels high.
double mean_motion(const Scene& scene, RayScene& rays, int frame) {
    constexpr int width = 64, height = 36;
    const Pose pose = pose_at(scene, frame / 24.0);
    rays.set_pose(pose);
    const PinholePose now = camera_at(scene, frame), next = camera_at(scene, frame + 1);
    double sum = 0.0;
    int count = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const glm::vec2 pixel(float(x) + 0.5f, float(y) + 0.5f);
            const Ray ray{now.eye, now.direction(pixel.x, pixel.y, width, height), 0.0f, INFINITY};
            Hit hit;
            rays.intersect({&ray, 1}, &hit);
            if (hit.instance == Hit::none) continue;
            const glm::vec3 to = ray.origin + hit.t * ray.direction - next.eye;
            const float depth = glm::dot(to, next.forward);
            const float scale = 0.5f * float(height) / (next.tan_half_yfov * depth);
            const glm::vec2 then(0.5f * float(width) + scale * glm::dot(to, next.right),
                                 0.5f * float(height) - scale * glm::dot(to, next.up));
            sum += glm::distance(pixel, then) * 360.0 / height;
            ++count;
        }
    return sum / count;
}

/// The paper's eleven shaders.
const std::set<std::string> paper_shaders{"blocks",      "carpet",      "cmarble", "colormarble",
                                          "cobblestone", "greenmarble", "spatter", "stone",
                                          "velvet",      "wood",        "RCSkin"};

/// Checks what the scenes of the paper have in common.
void expect_a_slow_walk_of_100_frames(const Scene& scene) {
    EXPECT_THAT(scene.warnings, IsEmpty());
    EXPECT_EQ(moving_node(scene), "") << "only the camera moves";
    const FrameRange range = animated_frames(scene, 24.0);
    EXPECT_EQ(range.first, 1);
    EXPECT_EQ(range.count(), 100);
    RayScene rays(scene);
    for (int frame = 1; frame < 100; frame += 7) {
        SCOPED_TRACE(frame);
        EXPECT_LE(mean_motion(scene, rays, frame), 6.0);
        EXPECT_EQ(seen(scene, rays, frame / 24.0).first, 1.0);
    }
    EXPECT_GE(mean_motion(scene, rays, 50), 0.5);
}

TEST(Simple, ShowsEachShaderOfThePaperOnAnObjectNamedAfterIt) {
    const Scene scene = example("simple");
    std::set<std::string> worn;
    for (const Object& object : scene.objects) {
        expect_sound(object, object.name != "floor");
        if (object.choice.name == "plastic") continue;
        EXPECT_EQ(object.name, object.choice.name);
        EXPECT_TRUE(worn.insert(object.choice.name).second) << object.name;
    }
    EXPECT_EQ(worn, paper_shaders);
    EXPECT_EQ(scene.lights.size(), 2u);
}

TEST(Simple, ShowsAllOfThemEquallyLargeAllTheTime) {
    const Scene scene = example("simple");
    expect_a_slow_walk_of_100_frames(scene);
    RayScene rays(scene);
    constexpr int width = 320, height = 180;
    for (const int frame : {1, 25, 50, 75, 100}) {
        SCOPED_TRACE(frame);
        const Pose pose = pose_at(scene, frame / 24.0);
        rays.set_pose(pose);
        const PinholePose camera = camera_at(scene, frame);
        std::map<std::string, int> pixels;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const Ray ray{camera.eye,
                              camera.direction(float(x) + 0.5f, float(y) + 0.5f, width, height),
                              0.0f, INFINITY};
                Hit hit;
                rays.intersect({&ray, 1}, &hit);
                const std::string name =
                    scene.objects[scene.instances[hit.instance].object].choice.name;
                if (name == "plastic") continue;
                ++pixels[name];
                EXPECT_TRUE(x > 1 && y > 1 && x < width - 2 && y < height - 2)
                    << name << " reaches the edge of the image";
            }
        const auto [least, most] =
            std::minmax_element(pixels.begin(), pixels.end(),
                                [](const auto& a, const auto& b) { return a.second < b.second; });
        EXPECT_EQ(pixels.size(), 11u);
        EXPECT_GE(least->second, width * height / 80) << least->first;
        EXPECT_LE(most->second, 2 * least->second) << most->first << " and " << least->first;
    }
}

TEST(Face, IsAClosedHeadOfSkinInGreenmarble) {
    const Scene scene = example("face");
    expect_a_slow_walk_of_100_frames(scene);
    EXPECT_EQ(scene.lights.size(), 3u);
    std::map<std::string, const Object*> objects;
    for (const Object& object : scene.objects) objects[object.name] = &object;
    ASSERT_TRUE(objects.contains("head") && objects.contains("garment"));
    EXPECT_EQ(objects["head"]->choice.name, "RCSkin");
    EXPECT_EQ(objects["garment"]->choice.name, "greenmarble");
    const Mesh& head = objects["head"]->mesh;
    EXPECT_GE(head.triangles.size(), 150000u);
    EXPECT_LE(head.triangles.size(), 450000u);
    for (const char* name : {"head", "hair", "garment", "lips", "brows"}) {
        SCOPED_TRACE(name);
        ASSERT_TRUE(objects.contains(name));
        const Mesh& mesh = objects[name]->mesh;
        EXPECT_TRUE(mesh.has_uv());
        EXPECT_TRUE(Edges(mesh).closed());
        // In a crease a corner's smooth normal may point away from a triangle next to it.
        int turned = 0;
        for (const glm::uvec3& t : mesh.triangles) {
            const glm::dvec3 a(mesh.P[t.x]), b(mesh.P[t.y]), c(mesh.P[t.z]);
            const glm::dvec3 normal = glm::cross(b - a, c - a);
            for (int k = 0; k < 3; ++k) turned += glm::dot(normal, glm::dvec3(mesh.N[t[k]])) < 0.0;
        }
        EXPECT_LE(turned, int(mesh.triangles.size() / 200));
    }
    // The oil lies along dP/du, which goes around the head everywhere but at the crown.
    for (const MeshPoint& point : some_points(head)) {
        const glm::vec3 along = tangent(head, point);
        EXPECT_TRUE(glm::length(along) > 0.0f && std::isfinite(glm::length(along)));
    }
}

TEST(Face, HasTwoSettingsOfTheSameSkin) {
    const Scene first = example("face"), second = example("face-b");
    ASSERT_EQ(first.objects.size(), second.objects.size());
    std::set<std::string> different;
    for (std::size_t i = 0; i < first.objects.size(); ++i) {
        EXPECT_EQ(mesh_digest(first.objects[i].mesh), mesh_digest(second.objects[i].mesh));
        if (shader_digest(*first.objects[i].shader) != shader_digest(*second.objects[i].shader))
            different.insert(first.objects[i].name);
    }
    EXPECT_EQ(different, (std::set<std::string>{"head", "lips"}));
}

TEST(Interior, WearsAllShadersOfThePaperButSkin) {
    const Scene scene = example("interior");
    EXPECT_GE(triangles(scene), 500000);
    EXPECT_LE(triangles(scene), 1000000);
    std::set<std::string> worn;
    for (const Object& object : scene.objects) {
        SCOPED_TRACE(object.name);
        worn.insert(object.choice.name);
        EXPECT_TRUE(object.mesh.has_uv());
        for (const glm::vec3& n : object.mesh.N) ASSERT_NEAR(glm::length(n), 1.0f, 1e-4f);
    }
    worn.erase("plastic");
    std::set<std::string> wanted = paper_shaders;
    wanted.erase("RCSkin");
    EXPECT_EQ(worn, wanted);
}

TEST(Interior, IsWalkedThroughSlowlyAndSeenWhole) {
    const Scene scene = example("interior");
    expect_a_slow_walk_of_100_frames(scene);
    RayScene rays(scene);
    std::set<std::string> shown;
    for (int frame = 1; frame <= 100; frame += 9)
        for (const int object : seen(scene, rays, frame / 24.0).second)
            shown.insert(scene.objects[object].choice.name);
    EXPECT_EQ(shown.size(), 11u) << "ten shaders and plastic";
}

TEST(Interior, KeepsItsCameraInTheRoomAndOutOfTheFurniture) {
    const Scene scene = example("interior");
    RayScene rays(scene);
    for (int frame = 1; frame <= 100; frame += 3) {
        SCOPED_TRACE(frame);
        const glm::vec3 eye = camera_at(scene, frame).eye;
        // Whatever is around the camera shows its outside, and is not close.
        for (int i = 0; i < 200; ++i) {
            const float y = (float(i) + 0.5f) / 100.0f - 1.0f, turn = 2.3999632f * float(i);
            const float r = std::sqrt(1.0f - y * y);
            const Ray ray{eye, {r * std::cos(turn), y, r * std::sin(turn)}, 0.0f, INFINITY};
            Hit hit;
            rays.intersect({&ray, 1}, &hit);
            ASSERT_NE(hit.instance, Hit::none) << "a hole in the room";
            EXPECT_GT(hit.t, 0.25f);
            const Instance& instance = scene.instances[hit.instance];
            const Object& object = scene.objects[instance.object];
            const glm::mat3 turned(pose_at(scene, 0.0).world_from_node[instance.node]);
            const MeshPoint point = mesh_point(object.mesh, hit.triangle, hit.b1, hit.b2);
            EXPECT_LT(glm::dot(turned * point.Ng, ray.direction), 0.0f) << object.name;
        }
    }
}

TEST(Interior, IsLitByFourLampsThatReachEveryObject) {
    const Scene scene = example("interior");
    ASSERT_EQ(scene.lights.size(), 4u);
    for (const SceneLight& light : scene.lights) EXPECT_TRUE(light.shadow) << light.name;
    const RayScene rays(scene);
    std::map<std::string, float> brightest;
    for (int i = 0; i < int(scene.instances.size()); ++i) {
        const Object& object = scene.objects[scene.instances[i].object];
        const std::vector<MeshPoint> points = some_points(object.mesh);
        std::vector<glm::vec3> E(points.size());
        StaticLight(scene, rays, i).irradiance(points, E.data());
        float& best = brightest[object.name];
        for (const glm::vec3& e : E) best = std::max(best, e.g);
    }
    brightest.erase("subfloor");  // under the boards
    for (const auto& [name, E] : brightest) EXPECT_GT(E, 0.005f) << name;
}

TEST(Examples, AreTheSameFileEveryTime) {
    const Folder folder;
    const auto bytes = [&](const std::string& scene) {
        const std::string path = folder / (scene + ".glb");
        EXPECT_EQ(estara_scenes(scene + " -o " + path).status, 0);
        return text_of(path);
    };
    for (const char* scene : {"tumble", "face"}) {  // from formulas, and by the mesher
        SCOPED_TRACE(scene);
        const std::string first = bytes(scene);
        EXPECT_GT(first.size(), 1000000u);
        EXPECT_TRUE(first == bytes(scene));
    }
}

TEST(Examples, AreListed) {
    const Outcome outcome = estara_scenes("--list");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.text,
              "still-life   wood, marble and stone on a table, the camera goes around\n"
              "tumble       a wooden knot that flies and turns, the camera stands still\n"
              "bend         a wooden post that joints bow, a face that shape keys change\n"
              "simple       each of the paper's eleven shaders on an object of its own\n"
              "face         a head of skin in a bust of green marble, the camera passes by\n"
              "face-b       the same head, its skin darker, oilier and more blemished\n"
              "interior     a furnished room in ten shaders, the camera walks in and turns\n");
}

TEST(Examples, SayWhatIsWrongInOneLine) {
    const Folder folder;
    const std::pair<std::string, std::string> cases[]{
        {"", "no scene named; estara-scenes --list says which there are"},
        {"teapot -o x.glb",
         "no scene 'teapot'; there are: still-life, tumble, bend, simple, face, face-b, interior"},
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
    const std::string limited = "ulimit -f 100; " ESTARA_BIN "/estara-scenes tumble -o " + path +
                                " 2> " + (folder / "said");
    const int status = std::system(("sh -c \"" + limited + "\"").c_str());
    EXPECT_EQ(WEXITSTATUS(status), 1);
    EXPECT_EQ(text_of(folder / "said"),
              "estara-scenes: " + path + ": cannot be written: File too large\n");
    EXPECT_FALSE(fs::exists(path));
    EXPECT_EQ(std::distance(fs::directory_iterator(fs::path(path).parent_path()), {}), 1)
        << "a temporary file was left";
}

}  // namespace
}  // namespace estara::test
