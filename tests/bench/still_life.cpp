#include "still_life.h"

#include <algorithm>

#include "estara/bake/bake.h"
#include "estara/bake/irradiance.h"
#include "estara/scenes/load.h"
#include "meshes.h"
#include "run_command.h"

namespace estara::bench {
namespace {

constexpr double max_voxels = 4e6;  ///< of an object

}  // namespace

Scene still_life_in(const ShaderChoice& choice, const std::filesystem::path& folder) {
    const std::string path = folder / "still-life.glb";
    run_command("estara-scenes still-life -o '" + path + "'");
    Scene scene = load_scene(path);
    for (Object& object : scene.objects) {
        object.choice = choice;
        object.shader = bind_choice(object.choice, object.mesh.has_uv());
    }
    return scene;
}

std::vector<ObjectShading> baked(const Scene& scene, RayScene& rays, int width, int height) {
    const double fps = 24.0;
    const std::vector<double> sizes =
        automatic_voxel_sizes(scene, rays, 0, animated_frames(scene, fps), fps, width, height);
    std::vector<ObjectShading> shading;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const Mesh& mesh = scene.objects[i].mesh;
        const BoundShaderPtr& shader = scene.objects[i].shader;
        const double size = std::max(sizes[i], voxel_size_for(mesh, *shader, max_voxels));
        auto pyramid = std::make_shared<BrickPyramid>(bake_mesh(mesh, *shader, size, false));
        shading.push_back({shader, std::move(pyramid), float(size), nullptr});
    }
    return shading;
}

std::vector<ObjectShading> with_light(std::vector<ObjectShading> shading, const Scene& scene,
                                      const RayScene& rays) {
    for (std::size_t i = 0; i < shading.size(); ++i) {
        IrradianceSettings settings;
        settings.finest = shading[i].filter_width;
        settings.max_bytes = std::uint64_t{2} << 30;
        shading[i].irradiance =
            std::make_shared<BrickPyramid>(bake_irradiance(scene, rays, int(i), settings));
    }
    return shading;
}

std::vector<ObjectShading> direct(std::vector<ObjectShading> shading) {
    for (ObjectShading& object : shading) object.pyramid = nullptr;
    return shading;
}

}  // namespace estara::bench
