// A whole frame from grids, against the bare rays that it cannot do without and against direct
// evaluation.
#include "estara/render/frame.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "estara/bake/bake.h"
#include "estara/render/compare.h"
#include "estara/scenes/load.h"
#include "meshes.h"
#include "raster.h"
#include "rounds.h"
#include "rows.h"
#include "run_command.h"

namespace estara::bench {
namespace {

constexpr Raster raster{1280, 720};
constexpr int round_count = 11;
constexpr double max_voxels = 4e6;  ///< of an object
/// RMSE of grids against direct evaluation; tests/README.md, "Image error".
constexpr double allowed_rmse = 0.01;

FrameSettings frame_settings() {
    FrameSettings settings;
    settings.width = raster.width;
    settings.height = raster.height;
    settings.spp = 1;
    settings.shadows = false;
    return settings;
}

/// The still life with every object in greenmarble and only its key light.
Scene marble_scene(const std::filesystem::path& folder) {
    const std::string path = folder / "still-life.glb";
    run_command("estara-scenes still-life -o '" + path + "'");
    Scene scene = load_scene(path);
    scene.lights.resize(1);
    for (Object& object : scene.objects) {
        object.choice = {"greenmarble", {}, "benchmark"};
        object.shader = bind_choice(object.choice, object.mesh.has_uv());
    }
    return scene;
}

/// Every object baked with the voxels that estara-bake would choose, or with larger ones where that
/// would be more than max_voxels: the backdrop alone would be 330 million.
std::vector<ObjectShading> baked(const Scene& scene, RayScene& rays) {
    const double fps = 24.0;
    const std::vector<double> sizes = automatic_voxel_sizes(
        scene, rays, 0, animated_frames(scene, fps), fps, raster.width, raster.height);
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

/// The primary rays of a frame and nothing else.
void trace_all(const Camera& camera, const RayScene& rays) {
    tbb::parallel_for(0, raster.tiles(), [&](int tile) {
        thread_local RayBatch some;
        thread_local HitBatch hits;
        raster.rays(camera, tile, some);
        rays.intersect(some, hits);
    });
}

}  // namespace

void frame(Bench& bench) {
    Rows& rows = bench.rows;
    const Scene scene = marble_scene(bench.folder);
    RayScene ray_scene(scene);
    const std::vector<ObjectShading> grids = baked(scene, ray_scene);
    std::vector<ObjectShading> direct = grids;
    for (ObjectShading& shading : direct) shading.pyramid = nullptr;

    const FrameSettings settings = frame_settings();
    FrameRenderer renderer(scene, ray_scene, settings);
    Film grid_film(raster.width, raster.height, {}), direct_film = grid_film;
    FrameStatistics counts;
    const Pose pose = pose_at(scene, 0.0);
    const Camera camera(pinhole_pose(scene, scene.cameras.front(), pose), raster.width,
                        raster.height);
    const auto costs =
        rounds(round_count, {[&] { counts = renderer.render(grids, 0, 0.0, grid_film, {}); },
                             [&] { renderer.render(direct, 0, 0.0, direct_film, {}); },
                             [&] { trace_all(camera, ray_scene); }});

    const double rmse = compare_films(grid_film, direct_film).rmse;
    const std::string error = fmt::format("rmse {:.2g}", rmse);
    if (!(rmse <= allowed_rmse)) {
        rows.disagree(
            fmt::format("frame: RMSE {} from grids to direct, above {}", rmse, allowed_rmse));
    }
    const std::string what = fmt::format("still life in greenmarble, {}x{}, 1 spp, {} shadow rays",
                                         raster.width, raster.height, counts.shadow_rays);
    const std::string whole = "frame from grids over its bare primary rays, ";
    rows.add({"frame/limit_ratio", ratio(costs[0], costs[2], &Cost::wall), "ratio", error,
              whole + "wall time; " + what});
    rows.add({"frame/limit_ratio/cpu", ratio(costs[0], costs[2], &Cost::cpu), "ratio", error,
              whole + "CPU time"});
    rows.add({"frame/direct_over_grid", ratio(costs[1], costs[0], &Cost::wall), "ratio", error,
              "frame evaluated directly over the one from grids, wall time: above 1 grids win"});

    const auto ns = [&](const Cost& cost) { return 1e9 * cost.cpu / double(counts.samples); };
    const char* names[]{"grid", "direct", "rays"};
    for (std::size_t i = 0; i < 3; ++i) {
        rows.add({std::string("frame/ns_per_sample/") + names[i], spread_of(costs[i], ns), "ns",
                  i == 2 ? "" : error,
                  fmt::format("CPU time of the frame over its {} shaded samples", counts.samples)});
    }
    const double threads = tbb::this_task_arena::max_concurrency();
    rows.add({"frame/busy",
              spread_of(costs[0], [&](const Cost& c) { return c.cpu / (c.wall * threads); }),
              "share", "", "CPU time over wall time times threads, frame from grids"});
    rows.add({"frame/rmse", once(rmse), "colour", "", "frame from grids against direct"});
    rows.add({"frame/misses", once(double(counts.misses)), "samples", "",
              fmt::format("lookups off the grids, of {}", counts.lookups)});
}

}  // namespace estara::bench
