#include "estara/bake/run.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "describe.h"
#include "estara/bake/bake.h"
#include "estara/bake/irradiance.h"
#include "estara/scenes/load.h"
#include "estara/scenes/static_light.h"
#include "plan.h"

namespace estara::bake {
namespace {

/// A finished bake and what it took.
struct Done {
    TextureGrid grid;
    std::optional<TextureGrid> light;
    double seconds = 0.0;
    int attempts = 1;
    std::uint64_t bytes = 0;  ///< estimated
};

void check_shader(const std::string& name) {
    if (find_shader(name) != nullptr) return;
    const BindResult wrong = bind_shader(name, {}, false);
    throw Error(wrong.problems.front().what + "; " + wrong.problems.front().hint);
}

TextureGrid bake_at_size(const Job& job, const Options& options) {
    const Mesh& mesh = job.object->mesh;
    const double size = *job.voxel_size;
    Progress progress(options.progress, "bake " + job.object->name, job.estimate.voxels);
    TextureGrid grid = bake_mesh(mesh, *job.shader, size, options.file.half,
                                 [&](std::uint64_t n) { progress.advance(n); });
    grid.errors = measure_error(mesh, *job.shader, grid, error_samples, options.seed);
    progress.advance(job.estimate.voxels);  // the estimate may have been too high
    return grid;
}

/// @param max_memory  what is left of --max-memory
BoundedBake bake_within_error(const Job& job, const Options& options, std::uint64_t max_memory) {
    std::unique_ptr<Progress> progress;
    const auto begin = [&](double size, std::uint64_t voxels) -> VoxelsDone {
        progress.reset();  // the last attempt's line ends before the next one's begins
        progress = std::make_unique<Progress>(
            options.progress, fmt::format("bake {} with voxels of {:.4g}", job.object->name, size),
            voxels);
        return [&](std::uint64_t n) { progress->advance(n); };
    };
    return bake_to_error(job.object->mesh, *job.shader, *options.max_error, options.file.half,
                         max_memory, options.seed, begin);
}

/// The scene's light on a job's object, or nothing, with a word why, if it cannot be baked.
std::optional<TextureGrid> bake_light(const Job& job, const TextureGrid& color, const Scene& scene,
                                      const RayScene& rays, const Options& options,
                                      std::uint64_t max_memory, const Output& output) {
    const int object = int(job.object - scene.objects.data());
    const std::string why = why_no_static_light(scene, object);
    if (!why.empty()) {
        output.message(fmt::format("warning: object \"{}\": {}: it is baked without light",
                                   job.object->name, why));
        return std::nullopt;
    }
    IrradianceSettings settings;
    settings.max_error = options.irradiance_error;
    settings.voxel_size = options.irradiance_voxel_size;
    settings.finest = color.voxel_size;
    settings.max_bytes = max_memory;
    settings.half = options.file.half;
    settings.seed = options.seed;
    TextureGrid light = bake_irradiance(scene, rays, object, settings);
    light.object = job.object->name;
    return light;
}

Done bake_job(const Job& job, const Options& options, std::uint64_t max_memory) {
    const Stopwatch watch;
    Done done;
    if (job.voxel_size) {
        done.grid = bake_at_size(job, options);
        done.bytes = job.estimate.bytes;
    } else {
        BoundedBake bounded = bake_within_error(job, options, max_memory);
        done.grid = std::move(bounded.grid);
        done.attempts = bounded.attempts;
        done.bytes = bounded.bytes;
    }
    done.grid.object = job.object->name;
    done.seconds = watch.seconds();
    return done;
}

std::string size_of(const TextureGrid& grid) {
    return fmt::format("{} voxels of {:.4g} on {} level{}", grid.levels.front().voxels(),
                       grid.voxel_size, grid.levels.size(), grid.levels.size() == 1 ? "" : "s");
}

std::string describe_light(const TextureGrid& light) {
    std::string text = fmt::format("\n    irradiance: {}, {:.2g} % left to rays", size_of(light),
                                   100.0 * masked_share(light));
    if (light.errors.empty()) return text;
    const ErrorFigures& e = light.errors.front();
    return text + fmt::format(
                      "\n    {:<9} error: rmse {:.5f}  mean {:.5f}  p99 {:.5f}  p99.9 {:.5f}  "
                      "max {:.5f}  ({} points outside)",
                      "light", e.rmse, e.mean, e.p99, e.p999, e.max, e.samples);
}

std::string describe_bake(const Done& done) {
    const TextureGrid& grid = done.grid;
    std::string text =
        fmt::format("{}: {}, {}", grid.object, size_of(grid), format_seconds(done.seconds));
    for (std::size_t c = 0; c < grid.channels.size(); ++c) {
        const ErrorFigures& e = grid.errors[c];
        text += fmt::format(
            "\n    {:<9} error: rmse {:.5f}  mean {:.5f}  p99 {:.5f}  p99.9 {:.5f}  max {:.5f}  "
            "({} points)",
            grid.channels[c].name, e.rmse, e.mean, e.p99, e.p999, e.max, e.samples);
    }
    if (done.light) text += describe_light(*done.light);
    return text;
}

nlohmann::json as_json(const ErrorFigures& e) {
    return {{"mean", e.mean}, {"rmse", e.rmse}, {"p99", e.p99},
            {"p999", e.p999}, {"max", e.max},   {"samples", e.samples}};
}

nlohmann::json levels_of(const TextureGrid& grid) {
    nlohmann::json levels = nlohmann::json::array();
    for (const GridLevel& level : grid.levels) levels.push_back(level.voxels());
    return levels;
}

nlohmann::json as_json(const Done& done) {
    const TextureGrid& grid = done.grid;
    nlohmann::json errors, params, light;
    for (std::size_t c = 0; c < grid.channels.size(); ++c) {
        errors[grid.channels[c].name] = as_json(grid.errors[c]);
    }
    if (done.light) {
        light = {{"voxels", levels_of(*done.light)},
                 {"voxel_size", done.light->voxel_size},
                 {"masked", masked_share(*done.light)}};
        if (!done.light->errors.empty()) light["error"] = as_json(done.light->errors.front());
    }
    for (const auto& [name, value] : grid.params) {
        params[name] = value.size() == 1 ? nlohmann::json(value.front()) : nlohmann::json(value);
    }
    return {{"object", grid.object},     {"shader", grid.shader},   {"params", params},
            {"voxels", levels_of(grid)}, {"irradiance", light},     {"voxel_size", grid.voxel_size},
            {"errors", errors},          {"seconds", done.seconds}, {"attempts", done.attempts}};
}

void write_stats(const Options& options, const std::vector<Done>& bakes, std::uint64_t bytes,
                 double seconds) {
    nlohmann::json objects = nlohmann::json::array();
    for (const Done& done : bakes) objects.push_back(as_json(done));
    const nlohmann::json stats{
        {"version", version},           {"shader", options.shader}, {"scene", options.scene},
        {"file", options.output},       {"bytes", bytes},           {"seconds", seconds},
        {"peak_memory", peak_memory()}, {"objects", objects}};
    // A file's name need not be UTF-8.
    constexpr auto replace = nlohmann::json::error_handler_t::replace;
    write_text(options.stats, stats.dump(2, ' ', false, replace) + "\n");
}

/// A number of voxels as exactly as it is known.
std::string rounded(std::uint64_t n) {
    std::uint64_t unit = 1;
    while (n / unit >= 1000) unit *= 10;
    return std::to_string((n + unit / 2) / unit * unit);
}

/// What a bake would cost: the speed is measured on a coarse bake of the same object.
std::string dry_run(const Job& job, const Options& options) {
    const Mesh& mesh = job.object->mesh;
    if (!job.voxel_size) {
        return fmt::format(
            "{}: --max-error finds the voxel size by baking; give --voxel-size for a dry run",
            job.object->name);
    }
    const double coarse = std::max(*job.voxel_size, double(bounds(mesh).diagonal()) / 256.0);
    const PendingFile scratch(std::filesystem::temp_directory_path() / "estara-dry-run.vdb");
    const Stopwatch watch;
    const TextureGrid grid = bake_mesh(mesh, *job.shader, coarse, options.file.half);
    write_vdb(scratch.path(), {grid}, options.file);
    const double seconds_per_voxel = watch.seconds() / double(grid.levels.front().voxels());
    return fmt::format("{}: about {} voxels of {:.4g}, {} of memory, {} with writing the file",
                       job.object->name, rounded(job.estimate.voxels), *job.voxel_size,
                       format_bytes(job.estimate.bytes),
                       format_seconds(seconds_per_voxel * double(job.estimate.voxels)));
}

std::uint64_t write_file(const Options& options, const std::vector<TextureGrid>& grids) {
    Progress progress(options.progress, "write " + options.output, 1);
    const std::uint64_t bytes = write_vdb(options.output, grids, options.file);
    progress.advance(1);
    return bytes;
}

/// Fails before the work instead of after it if nothing can be written where it is wanted.
void check_writable(const Options& options) {
    if (!options.stats.empty()) const PendingFile probe(options.stats);
    const PendingFile probe(options.output);
}

void bake_all_jobs(const std::vector<Job>& jobs, const Scene& scene, const Options& options,
                   const Output& output) {
    const Stopwatch watch;
    std::vector<Done> bakes;
    std::uint64_t held = program_bytes;  // and by the grids that are done
    const auto left = [&] { return options.max_memory > held ? options.max_memory - held : 0; };
    std::unique_ptr<RayScene> rays;
    if (options.irradiance) rays = std::make_unique<RayScene>(scene, near_origin(scene));
    for (const Job& job : jobs) {
        bakes.push_back(naming(job, [&] { return bake_job(job, options, left()); }));
        held += bakes.back().bytes;
        if (rays) {
            const Stopwatch light;
            bakes.back().light = naming(job, [&] {
                return bake_light(job, bakes.back().grid, scene, *rays, options, left(), output);
            });
            bakes.back().seconds += light.seconds();
        }
        output.result(describe_bake(bakes.back()));
    }
    std::vector<TextureGrid> grids;
    for (Done& done : bakes) {
        grids.push_back(std::move(done.grid));
        if (done.light) grids.push_back(std::move(*done.light));
    }
    const std::uint64_t bytes = write_file(options, grids);
    std::size_t written = 0;
    for (Done& done : bakes) {
        done.grid = std::move(grids[written++]);
        if (done.light) done.light = std::move(grids[written++]);
    }
    if (!options.stats.empty()) write_stats(options, bakes, bytes, watch.seconds());
    output.result(
        fmt::format("{}: {} in {}, {}", options.output, format_bytes(bytes),
                    bakes.size() == 1 ? "1 object" : fmt::format("{} objects", bakes.size()),
                    format_seconds(watch.seconds())));
}

void check_light(const Scene& scene) {
    const std::string moving = moving_node(scene);
    if (moving.empty()) return;
    throw Error(fmt::format(
        "{}: \"{}\" moves, so that light changes; --irradiance needs lights and objects that stand "
        "still",
        scene.path, moving));
}

}  // namespace

void run(const Options& options, const Output& output) {
    if (options.list_shaders) {
        if (options.markdown) return output.result(shader_table());
        for (const ShaderInfo& shader : all_shaders()) output.result(describe(shader));
        return;
    }
    if (!options.describe.empty()) {
        check_shader(options.describe);
        return output.result(describe(*find_shader(options.describe)));
    }
    std::unique_ptr<tbb::global_control> limit;
    if (options.threads > 0) {
        limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                      std::size_t(options.threads));
    }
    check_shader(options.shader);
    const Scene scene = load_scene(options.scene);
    for (const std::string& warning : scene.warnings) output.message("warning: " + warning);
    if (options.irradiance) check_light(scene);
    if (!options.dry_run) check_writable(options);
    const std::vector<Job> jobs = plan(scene, options, output.message);
    if (!options.dry_run) return bake_all_jobs(jobs, scene, options, output);
    for (const Job& job : jobs) output.result(naming(job, [&] { return dry_run(job, options); }));
}

}  // namespace estara::bake
