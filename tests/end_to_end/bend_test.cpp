// A pattern sticks to what bends: at points of the bent surface, computed here in double, pictures
// show what the shader is at the same points of the rest pose.
#include <gtest/gtest.h>

#include <random>

#include "../programs.h"
#include "estara/scenes/load.h"

namespace estara {
namespace {

using test::done_in;
using test::Image;
using test::TemporaryFolder;

constexpr int width = 480, height = 270;

/// Matrices of nodes, in double and without the scene's own code: glTF 2.0, 3.5.3.
glm::dmat4 world_from(const Scene& scene, int node, double time) {
    glm::dmat4 m(1.0);
    for (; node >= 0; node = scene.nodes[std::size_t(node)].parent) {
        const Node& n = scene.nodes[std::size_t(node)];
        glm::dquat r(n.rotation);
        if (!n.rotations.empty()) {  // keys are on frames
            const auto key = std::size_t(std::lround(time * 24.0)) - 1;
            r = glm::dquat(n.rotations.values.at(key));
        }
        glm::dmat4 local = glm::mat4_cast(glm::normalize(r));
        local[3] = glm::dvec4(n.translation, 1.0);
        m = local * m;
    }
    return m;
}

/// Vertices of an instance at a time.
std::vector<glm::dvec3> bent_vertices(const Scene& scene, const Instance& instance, double time) {
    const Object& object = scene.objects[std::size_t(instance.object)];
    const Node& node = scene.nodes[std::size_t(instance.node)];
    const Influences& how = object.bends.influences;
    std::vector<glm::dvec3> result;
    for (std::size_t i = 0; i < object.mesh.P.size(); ++i) {
        glm::dvec3 P(object.mesh.P[i]);
        for (std::size_t t = 0; t < node.weight_tracks.size(); ++t) {
            const auto key = std::size_t(std::lround(time * 24.0)) - 1;
            P += double(node.weight_tracks[t].values.at(key)) *
                 glm::dvec3(object.bends.targets[t].P[i]);
        }
        glm::dmat4 m(0.0);
        if (instance.skin < 0) m = world_from(scene, instance.node, time);
        const auto count = std::size_t(instance.skin < 0 ? 0 : how.count);
        for (std::size_t k = count * i; k < count * (i + 1); ++k) {
            const Skin& skin = scene.skins[std::size_t(instance.skin)];
            const int joint = how.joint[k];
            m += double(how.weight[k]) * world_from(scene, skin.joints[std::size_t(joint)], time) *
                 glm::dmat4(skin.joint_from_rest[std::size_t(joint)]);
        }
        result.emplace_back(m * glm::dvec4(P, 1.0));
    }
    return result;
}

const Instance& instance_of(const Scene& scene, const std::string& name) {
    return *std::find_if(scene.instances.begin(), scene.instances.end(), [&](const Instance& i) {
        return scene.objects[std::size_t(i.object)].name == name;
    });
}

struct Difference {
    double sum = 0.0;        ///< to the shader at the rest pose's point
    double sum_there = 0.0;  ///< to it at the bent point: what a pattern that slides would show
    int count = 0;
    double mean() const { return sum / std::max(1, count); }
};

/// Albedo in a picture against the shader at rest, at random points of an object that lie less than
/// a tenth of a pixel beside a pixel's centre and nearest to the eye there.
Difference difference(const Scene& scene, const std::string& name, const std::string& picture,
                      int frame, float filter_width) {
    const double time = frame / 24.0;
    const Instance& instance = instance_of(scene, name);
    const Object& object = scene.objects[std::size_t(instance.object)];
    const std::vector<glm::dvec3> vertices = bent_vertices(scene, instance, time);
    const Image image(picture);
    const int albedo = image.channel("albedo.R"), position = image.channel("P.X");
    const SceneCamera& camera = scene.cameras.front();
    const glm::dmat4 eye = world_from(scene, camera.node, time);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(0.0, 1.0);
    Difference d;
    for (int i = 0; i < 400000; ++i) {
        const auto triangle = std::uint32_t(random() % object.mesh.triangles.size());
        const glm::uvec3 t = object.mesh.triangles[triangle];
        double b1 = any(random), b2 = any(random);
        if (b1 + b2 > 1.0) b1 = 1.0 - b1, b2 = 1.0 - b2;
        const glm::dvec3 P =
            (1.0 - b1 - b2) * vertices[t.x] + b1 * vertices[t.y] + b2 * vertices[t.z];
        const glm::dvec3 way = glm::transpose(glm::dmat3(eye)) * (P - glm::dvec3(eye[3]));
        const double scale = height / (2.0 * std::tan(0.5 * double(camera.yfov)) * -way.z);
        const double x = 0.5 * width + way.x * scale, y = 0.5 * height - way.y * scale;
        const int u = int(std::floor(x)), v = int(std::floor(y));
        if (u < 0 || v < 0 || u >= width || v >= height) continue;
        if (std::hypot(x - u - 0.5, y - v - 0.5) > 0.1) continue;
        const auto p = image.triple(u, v, position);
        const double off = glm::distance(P, glm::dvec3(p[0], p[1], p[2]));
        if (off > 0.002) continue;  // a fifth of a pixel
        SurfaceBatch batch;
        const MeshPoint rest = mesh_point(object.mesh, triangle, float(b1), float(b2));
        batch.filter_width = filter_width;
        batch.size = 2;
        batch.set(0, rest.P, rest.N, rest.uv, tangent(object.mesh, rest));
        batch.set(1, glm::vec3(P), rest.N, rest.uv, tangent(object.mesh, rest));
        std::vector<float> planes(std::size_t(object.shader->info().baked_floats) * batch_capacity);
        object.shader->bake(batch, planes.data());
        const auto seen = image.triple(u, v, albedo);
        for (std::size_t c = 0; c < 3; ++c) {
            d.sum += std::abs(double(seen[c]) - double(planes[c * batch_capacity])) / 3.0;
            d.sum_there += std::abs(double(seen[c]) - double(planes[c * batch_capacity + 1])) / 3.0;
        }
        ++d.count;
    }
    return d;
}

class Bend : public ::testing::TestWithParam<const char*> {};

TEST_P(Bend, CarriesItsPatternAlong) {
    const TemporaryFolder folder;
    done_in(folder, "estara-scenes bend -o bend.glb");
    done_in(folder, "estara-bake wood bend.glb -o wood.vdb --resolution 480x270 --progress none");
    done_in(folder, std::string("estara-render bend.glb --grids wood.vdb --frames 13-21x4 --spp 1 "
                                "--resolution 480x270 --aov albedo --aov P -o '#.exr' "
                                "--progress none --stats s.json --strategy ") +
                        GetParam());
    const Scene scene = load_scene(folder / "bend.glb");
    const nlohmann::json stats = test::json_of(folder / "s.json");
    for (const char* name : {"post", "face"}) {
        float filter_width = 0.0f;
        for (const auto& object : stats["objects"]) {
            if (object["object"] == name) filter_width = object["filter_width"];
        }
        for (const int frame : {13, 17, 21}) {
            const Difference d = difference(scene, name, folder / (std::to_string(frame) + ".exr"),
                                            frame, filter_width);
            EXPECT_GT(d.count, 300) << name << frame;
            // As of Tumble: a tenth of a pixel of a ring's edge, and half floats.
            EXPECT_LT(d.mean(), 0.008) << name << frame;
            if (std::string(name) == "post") {
                EXPECT_GT(d.sum_there / d.count, 0.03) << frame;
            }
        }
    }
    EXPECT_GT(stats["frames"][1]["cost"]["refits"].get<int>() +
                  stats["frames"][1]["cost"]["rebuilds"].get<int>(),
              0);
}

INSTANTIATE_TEST_SUITE_P(With, Bend, ::testing::Values("grid", "direct", "cache"),
                         [](const auto& named) { return std::string(named.param); });

TEST(BakedLight, DoesNotFitWhatBendsAndSaysSo) {
    const TemporaryFolder folder;
    // Without its keys nothing moves, and the skin bends all the same.
    done_in(folder,
            "estara-scenes bend -o bend.glb\n"
            "python3 - <<'E'\n"
            "import json, struct\n"
            "b = open('bend.glb', 'rb').read()\n"
            "n = struct.unpack('<I', b[12:16])[0]\n"
            "j = json.loads(b[20:20 + n]); j.pop('animations'); t = json.dumps(j).encode()\n"
            "t += b' ' * (-len(t) % 4); rest = b[20 + n:]\n"
            "open('still.glb', 'wb').write(b'glTF' + struct.pack('<II', 2, 20 + len(t) + len(rest))"
            " + struct.pack('<I', len(t)) + b'JSON' + t + rest)\n"
            "E");
    const test::Ran ran = test::run_in(
        folder,
        "estara-bake wood still.glb -o w.vdb --irradiance --voxel-size 0.05 --progress none");
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_NE(
        ran.err.find("object \"post\": it bends, and light is baked on the shape that it has at "
                     "rest: it is baked without light"),
        std::string::npos)
        << ran.err;
}

}  // namespace
}  // namespace estara
