#include "meshes.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "estara/bake/bake.h"
#include "estara/scenes/error.h"
#include "estara/scenes/load.h"

namespace estara::bench {
namespace {

glm::vec3 bumpy_point(double latitude, double longitude) {
    const glm::dvec3 unit(std::cos(latitude) * std::cos(longitude), std::sin(latitude),
                          std::cos(latitude) * std::sin(longitude));
    const double bumps = std::sin(9 * unit.x) * std::sin(8 * unit.y) * std::sin(7 * unit.z);
    return glm::vec3(unit * (1.0 + 0.1 * bumps));
}

struct Surface {
    Mesh mesh;
    std::string name;
};

const Surface& loaded_surface() {
    static const Surface loaded = [] {
        const std::string bunny = std::string(ESTARA_MODELS) + "/stanford-bunny.obj";
        if (!std::filesystem::exists(bunny)) {
            return Surface{bumpy_sphere(140e3), "generated bumpy sphere, 140,000 triangles"};
        }
        return Surface{std::move(load_scene(bunny).objects.front().mesh), "Stanford bunny"};
    }();
    return loaded;
}

}  // namespace

Mesh bumpy_sphere(double triangles) {
    constexpr double pi = std::numbers::pi;
    // `rows` rings of 2 * rows vertices between two poles: 4 rows^2 triangles.
    const auto rows = std::uint32_t(std::sqrt(triangles / 4.0)), columns = 2 * rows;
    Mesh mesh;
    for (std::uint32_t r = 0; r < rows; ++r) {
        for (std::uint32_t c = 0; c < columns; ++c) {
            mesh.P.push_back(bumpy_point(pi * ((r + 1.0) / (rows + 1.0) - 0.5), pi * c / rows));
        }
    }
    const std::uint32_t south = rows * columns, north = south + 1;
    mesh.P.push_back(bumpy_point(-0.5 * pi, 0.0));
    mesh.P.push_back(bumpy_point(0.5 * pi, 0.0));
    const auto at = [=](std::uint32_t r, std::uint32_t c) { return r * columns + c % columns; };
    for (std::uint32_t c = 0; c < columns; ++c) {
        mesh.triangles.push_back({south, at(0, c), at(0, c + 1)});
        mesh.triangles.push_back({north, at(rows - 1, c + 1), at(rows - 1, c)});
        for (std::uint32_t r = 0; r + 1 < rows; ++r) {
            mesh.triangles.push_back({at(r, c), at(r + 1, c), at(r + 1, c + 1)});
            mesh.triangles.push_back({at(r, c), at(r + 1, c + 1), at(r, c + 1)});
        }
    }
    return mesh;
}

const Mesh& surface() { return loaded_surface().mesh; }
const std::string& surface_name() { return loaded_surface().name; }

double voxel_size_for(const Mesh& mesh, const BoundShader& shader, double voxels) {
    const double coarse = double(bounds(mesh).diagonal()) / 128.0;
    const BakeEstimate estimate = estimate_bake(mesh, shader.info(), coarse);
    return coarse * std::sqrt(double(estimate.voxels) / voxels);
}

Scene scene_of(Mesh mesh, const BoundShaderPtr& shader) {
    Scene scene;
    scene.path = "benchmark";
    scene.nodes.resize(2);
    scene.nodes[1].translation = bounds(mesh).max + bounds(mesh).diagonal();
    Object object;
    object.name = "surface";
    object.mesh = std::move(mesh);
    object.shader = shader;
    scene.objects.push_back(std::move(object));
    scene.instances.push_back({0, 0});
    SceneLight light;
    light.node = 1;
    light.intensity = 683.0f;
    scene.lights.push_back(light);
    return scene;
}

void write_ply(const std::string& path, const Mesh& mesh) {
    std::ofstream file(path, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.P.size()
         << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
         << mesh.triangles.size() << "\nproperty list uchar uint vertex_indices\nend_header\n";
    file.write(reinterpret_cast<const char*>(mesh.P.data()),
               std::streamsize(mesh.P.size() * sizeof(glm::vec3)));
    for (const glm::uvec3& triangle : mesh.triangles) {
        file.put(3);
        file.write(reinterpret_cast<const char*>(&triangle), sizeof triangle);
    }
    if (!file.flush()) throw Error(path + ": cannot be written", ExitStatus::failed);
}

BoundShaderPtr bound(const std::string& name, InstructionSet limit) {
    BindResult result = bind_shader(name, {}, false, limit);
    if (!result.shader) throw Error(result.problems.front().what);
    return std::move(result.shader);
}

}  // namespace estara::bench
