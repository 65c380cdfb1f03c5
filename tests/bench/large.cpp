// The largest that a machine of 24 GiB is meant for: a bake of 200 million voxels, a scene of five
// million triangles, and the bound that --max-memory sets.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "estara/render/frame.h"
#include "estara/scenes/load.h"
#include "estara/scenes/program.h"
#include "memory.h"
#include "meshes.h"
#include "rows.h"
#include "run_command.h"

namespace estara::bench {
namespace {

constexpr double gibi = 1024.0 * 1024.0 * 1024.0;
/// Of a file with three floats a voxel and a fourth for its surface, all levels, not compressed.
constexpr double file_bytes_per_voxel = 24.0;
constexpr double scene_triangles = 5e6;

std::optional<nlohmann::json> bake_with(Bench& bench, const std::string& options) {
    const std::string mesh = bench.folder / "large-bake.ply", stats = bench.folder / "large.json";
    const bool done = command_succeeds(
        fmt::format("estara-bake greenmarble '{}' -o '{}' {} --stats '{}' --progress none", mesh,
                    (bench.folder / "large.vdb").string(), options, stats));
    if (!done) return std::nullopt;
    return nlohmann::json::parse(std::ifstream(stats));
}

/// Peak memory of a bake over its --max-memory: more than 1 breaks the promise.
void add_bound(Rows& rows, const std::string& name, double peak, double bound,
               const std::string& what) {
    rows.add({name, once(peak / bound), "ratio", "",
              fmt::format("peak memory over --max-memory of {:.3g} GiB, {}", bound / gibi, what)});
    if (peak > bound) rows.disagree(name + ": --max-memory does not hold");
}

void large_bake(Bench& bench, double max_memory) {
    const std::string what = fmt::format("bake of {:.3g} voxels to a file", bench.large_voxels);
    const double disk = file_bytes_per_voxel * bench.large_voxels;
    if (double(std::filesystem::space(bench.folder).available) < disk) {
        return bench.rows.missing(fmt::format("large/bake: it may need {:.3g} GiB of disk in {}",
                                              disk / gibi, bench.folder.string()));
    }
    const Mesh mesh = bumpy_sphere(500e3);
    const double voxel = voxel_size_for(mesh, *bound("greenmarble"), bench.large_voxels);
    const auto stats =
        bake_with(bench, fmt::format("--voxel-size {} --max-memory {:.0f}", voxel, max_memory));
    if (!stats) {
        return bench.rows.missing(
            fmt::format("large/bake: estara-bake did not do it in {:.3g} GiB, as it says above",
                        max_memory / gibi));
    }
    const nlohmann::json& object = stats->at("objects").at(0);
    const double voxels = object.at("voxels").at(0), peak = stats->at("peak_memory");
    const std::string error =
        fmt::format("rmse {:.2g}", object.at("errors").at("color").at("rmse").get<double>());
    Rows& rows = bench.rows;
    rows.add({"large/bake/seconds", once(stats->at("seconds")), "s", error, what});
    rows.add({"large/bake/peak_bytes", once(peak), "bytes", "", what});
    rows.add({"large/bake/bytes_per_voxel", once(peak / voxels), "bytes", "",
              fmt::format("peak memory over {:.0f} active voxels of level 0", voxels)});
    rows.add({"large/bake/file_bytes_per_voxel", once(double(stats->at("bytes")) / voxels), "bytes",
              "", "the whole file, zip"});
    add_bound(rows, "large/bake/max_memory_ratio", peak, max_memory, what);
}

/// A bake that wants far more than it may take, and has to make its voxels larger.
void bounded_bake(Bench& bench) {
    const double max_memory = 0.5 * gibi;
    const auto stats =
        bake_with(bench, fmt::format("--resolution 7680x4320 --max-memory {:.0f}", max_memory));
    if (!stats) return bench.rows.missing("large/bounded: estara-bake failed, as it says above");
    add_bound(bench.rows, "large/bounded/max_memory_ratio", stats->at("peak_memory"), max_memory,
              fmt::format("bake for 7680x4320 pixels, {} voxels",
                          stats->at("objects").at(0).at("voxels").at(0).get<std::uint64_t>()));
}

void large_scene(Bench& bench) {
    const std::string path = bench.folder / "large-scene.ply";
    write_ply(path, bumpy_sphere(scene_triangles));
    double load_seconds = 0.0, build_seconds = 0.0;
    FrameStatistics frame;
    std::size_t triangles = 0;
    const std::uint64_t peak = peak_growth([&] {
        const Stopwatch load_watch;
        Scene scene = load_scene(path);
        load_seconds = load_watch.seconds();
        triangles = scene.objects.front().mesh.triangles.size();
        const Stopwatch build_watch;
        RayScene rays(scene);
        build_seconds = build_watch.seconds();
        FrameSettings settings;
        settings.width = 1280;
        settings.height = 720;
        settings.spp = 1;
        Film film(settings.width, settings.height, {});
        frame = FrameRenderer(scene, rays, settings)
                    .render({{bound("greenmarble"), nullptr, 1e-3f, nullptr}}, 0, 0.0, film, {});
    });
    const std::string what = fmt::format("{} triangles, ", triangles);
    Rows& rows = bench.rows;
    rows.add({"large/scene/load_seconds", once(load_seconds), "s", "", what + "from a binary PLY"});
    rows.add({"large/scene/build_seconds", once(build_seconds), "s", "", what + "RayScene"});
    rows.add({"large/scene/frame_seconds", once(frame.seconds), "s", "",
              what + fmt::format("1280x720, 1 spp, the first frame, evaluated directly, {} samples",
                                 frame.samples)});
    rows.add({"large/scene/peak_bytes", once(double(peak)), "bytes", "",
              what + "growth of the process over all of that"});
}

}  // namespace

void large(Bench& bench) {
    large_scene(bench);
    write_ply(bench.folder / "large-bake.ply", bumpy_sphere(500e3));
    bounded_bake(bench);
    // The system and other programs want a part of the memory too.
    large_bake(bench, std::min(20.0 * gibi, 0.85 * double(physical_memory())));
    std::filesystem::remove(bench.folder / "large.vdb");
}

}  // namespace estara::bench
