// A whole frame from grids, against the bare rays that it cannot do without and against direct
// evaluation.
#include "estara/render/frame.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "estara/render/compare.h"
#include "raster.h"
#include "rounds.h"
#include "rows.h"
#include "still_life.h"

namespace estara::bench {
namespace {

constexpr Raster raster{1280, 720};
constexpr int round_count = 11;

FrameSettings frame_settings() {
    FrameSettings settings;
    settings.width = raster.width;
    settings.height = raster.height;
    settings.spp = 1;
    settings.shadows = false;
    return settings;
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
    Scene scene = still_life_in({"greenmarble", {}, "benchmark"}, bench.folder);
    scene.lights.resize(1);  // its key light
    RayScene ray_scene(scene);
    const std::vector<ObjectShading> grids = baked(scene, ray_scene, raster.width, raster.height);
    const std::vector<ObjectShading> evaluated = direct(grids);

    const FrameSettings settings = frame_settings();
    FrameRenderer renderer(scene, ray_scene, settings);
    Film grid_film(raster.width, raster.height, {}), direct_film = grid_film;
    FrameStatistics counts;
    const Pose pose = pose_at(scene, 0.0);
    const Camera camera(pinhole_pose(scene, scene.cameras.front(), pose), raster.width,
                        raster.height);
    const auto costs =
        rounds(round_count, {[&] { counts = renderer.render(grids, 0, 0.0, grid_film, {}); },
                             [&] { renderer.render(evaluated, 0, 0.0, direct_film, {}); },
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
