#include "estara/bake/run.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "describe.h"
#include "estara/bake/bake.h"
#include "estara/scenes/load.h"
#include "estara/scenes/ray_scene.h"

namespace estara::bake {
namespace {

/// An object to bake, with the shader it wears for this bake.
struct Job {
    const Object* object;
    BoundShaderPtr shader;
    double voxel_size = 0.0;  ///< 0: to be found by --max-error
};

/// A finished bake and what it took.
struct Done {
    TextureGrid grid;
    double seconds = 0.0;
    int attempts = 1;
};

/// The scene's own settings if the object wears the shader there, with --param over them.
ShaderChoice choose(const Object& object, const Options& options) {
    ShaderChoice choice{options.shader, {}, fmt::format("{}: object \"{}\"", options.scene, object.name)};
    if (object.choice.name == options.shader) choice = object.choice;
    for (const Setting& setting : options.params) {
        const auto same = [&](const Setting& s) { return s.name == setting.name; };
        std::erase_if(choice.settings, same);
    }
    if (!options.params.empty()) choice.where = "--param";
    choice.settings.insert(choice.settings.end(), options.params.begin(), options.params.end());
    return choice;
}

void check_shader(const std::string& name) {
    if (find_shader(name) != nullptr) return;
    const BindResult wrong = bind_shader(name, {}, false);
    throw Error(wrong.problems.front().what + "; " + wrong.problems.front().hint);
}

/// Half the smallest pixel footprint on each object over the camera path: the voxel at which the
/// blur of a lookup stays below the pixel (DESIGN.md, section 4).
std::vector<double> voxel_sizes_from_camera(const Scene& scene, const Options& options) {
    RayScene rays(scene);
    const FrameRange frames = options.frames.value_or(animated_frames(scene, options.fps));
    const std::vector<float> footprints =
        smallest_footprints(scene, rays, find_camera(scene, options.camera), frames, options.fps,
                            options.resolution.x, options.resolution.y);
    std::vector<double> sizes;
    for (std::size_t i = 0; i < footprints.size(); ++i) {
        const double diagonal = bounds(scene.objects[i].mesh).diagonal();
        // What no pixel sees gets a middling voxel; what fills less than 16 pixels or is seen from
        // within a hair's breadth stays within what makes sense for the object.
        const double wanted = std::isfinite(footprints[i]) ? 0.5 * double(footprints[i]) : diagonal / 512.0;
        sizes.push_back(std::clamp(wanted, diagonal / 16384.0, diagonal / 32.0));
    }
    return sizes;
}

std::vector<Job> plan(const Scene& scene, const Options& options) {
    std::vector<Job> jobs;
    const std::vector<int> selected = select_objects(scene, options.shader, options.objects);
    std::vector<double> sizes;
    if (!options.voxel_size && !options.max_error) sizes = voxel_sizes_from_camera(scene, options);
    for (const int index : selected) {
        const Object& object = scene.objects[std::size_t(index)];
        Job job{&object, bind_choice(choose(object, options), object.mesh.has_uv())};
        if (options.voxel_size) job.voxel_size = *options.voxel_size;
        if (!sizes.empty()) job.voxel_size = sizes[std::size_t(index)];
        jobs.push_back(std::move(job));
    }
    return jobs;
}

/// Puts the object before what is wrong with it.
template <class F>
auto naming(const Job& job, F work) {
    try {
        return work();
    } catch (const Error& error) {
        throw Error(fmt::format("object \"{}\": {}", job.object->name, error.what()), error.status());
    }
}

/// Refuses bakes that would not fit together (they go into one file), with voxel sizes that would.
void check_memory(const std::vector<Job>& jobs, std::uint64_t max_memory) {
    std::uint64_t bytes = 0, voxels = 0;
    for (const Job& job : jobs) {
        if (job.voxel_size == 0.0) continue;
        const BakeEstimate estimate =
            naming(job, [&] { return estimate_bake(job.object->mesh, job.shader->info(), job.voxel_size); });
        bytes += estimate.bytes;
        voxels += estimate.voxels;
    }
    if (bytes <= max_memory) return;
    const double larger = std::sqrt(double(bytes) / double(max_memory)) * 1.05;
    const std::string what = jobs.size() == 1 ? fmt::format("object \"{}\"", jobs.front().object->name)
                                              : fmt::format("{} objects", jobs.size());
    throw Error(fmt::format("{}: {} voxels need about {}, --max-memory is {}; voxels {:.3g} times as large fit: "
                            "--voxel-size {:.4g}",
                            what, voxels, format_bytes(bytes), format_bytes(max_memory), larger,
                            larger * jobs.front().voxel_size),
                ExitStatus::failed);
}

Done bake_job(const Job& job, const Options& options) {
    const Stopwatch watch;
    const Mesh& mesh = job.object->mesh;
    Done done;
    if (options.max_error) {
        Progress progress(options.progress, "bake " + job.object->name, 0);
        BoundedBake bounded = bake_to_error(mesh, *job.shader, *options.max_error, options.file.half,
                                            options.max_memory, options.seed,
                                            [&](std::uint64_t n) { progress.advance(n); });
        done.grid = std::move(bounded.grid);
        done.attempts = bounded.attempts;
    } else {
        const BakeEstimate estimate = estimate_bake(mesh, job.shader->info(), job.voxel_size);
        Progress progress(options.progress, "bake " + job.object->name, estimate.voxels);
        done.grid = bake_mesh(mesh, *job.shader, job.voxel_size, options.file.half,
                              [&](std::uint64_t n) { progress.advance(n); });
        progress.advance(estimate.voxels);  // the estimate may have been too high
        done.grid.errors = measure_error(mesh, *job.shader, BrickPyramid(done.grid), job.voxel_size,
                                         error_samples, options.seed);
    }
    done.grid.object = job.object->name;
    done.seconds = watch.seconds();
    return done;
}

std::string describe_bake(const Done& done) {
    const TextureGrid& grid = done.grid;
    std::string text = fmt::format("{}: {} voxels of {:.4g} on {} levels, {}", grid.object,
                                   grid.levels.front().voxels(), grid.voxel_size, grid.levels.size(),
                                   format_seconds(done.seconds));
    for (std::size_t c = 0; c < grid.channels.size(); ++c) {
        const ErrorFigures& e = grid.errors[c];
        text += fmt::format("\n    {:<9} error: rmse {:.5f}  mean {:.5f}  p99 {:.5f}  p99.9 {:.5f}  max {:.5f}  ({} points)",
                            grid.channels[c].name, e.rmse, e.mean, e.p99, e.p999, e.max, e.samples);
    }
    return text;
}

nlohmann::json as_json(const Done& done) {
    const TextureGrid& grid = done.grid;
    nlohmann::json errors, params, levels = nlohmann::json::array();
    for (std::size_t c = 0; c < grid.channels.size(); ++c) {
        const ErrorFigures& e = grid.errors[c];
        errors[grid.channels[c].name] = {{"mean", e.mean}, {"rmse", e.rmse}, {"p99", e.p99},
                                         {"p999", e.p999}, {"max", e.max},   {"samples", e.samples}};
    }
    for (const auto& [name, value] : grid.params) {
        params[name] = value.size() == 1 ? nlohmann::json(value.front()) : nlohmann::json(value);
    }
    for (const GridLevel& level : grid.levels) levels.push_back(level.voxels());
    return {{"object", grid.object}, {"shader", grid.shader},     {"params", params},
            {"voxels", levels},      {"voxel_size", grid.voxel_size}, {"errors", errors},
            {"seconds", done.seconds}, {"attempts", done.attempts}};
}

void write_stats(const Options& options, const std::vector<Done>& bakes, std::uint64_t bytes, double seconds) {
    nlohmann::json objects = nlohmann::json::array();
    for (const Done& done : bakes) objects.push_back(as_json(done));
    const nlohmann::json stats{{"version", version},     {"shader", options.shader}, {"scene", options.scene},
                               {"file", options.output}, {"bytes", bytes},           {"seconds", seconds},
                               {"peak_memory", peak_memory()}, {"objects", objects}};
    PendingFile file(options.stats);
    std::ofstream out(file.path());
    out << stats.dump(2) << '\n';
    out.close();
    if (!out) throw Error(options.stats + ": cannot be written; is the disk full?", ExitStatus::failed);
    file.commit();
}

/// What a bake would cost: the shading speed is measured on a coarse bake of the same object.
std::string dry_run(const Job& job) {
    const Mesh& mesh = job.object->mesh;
    if (job.voxel_size == 0.0) {
        return fmt::format("{}: --max-error finds the voxel size by baking; give --voxel-size for a dry run",
                           job.object->name);
    }
    const double coarse = std::max(job.voxel_size, double(bounds(mesh).diagonal()) / 128.0);
    const Stopwatch watch;
    const std::uint64_t voxels = bake_mesh(mesh, *job.shader, coarse, false).levels.front().voxels();
    const double seconds_per_voxel = watch.seconds() / double(voxels);
    const BakeEstimate estimate = estimate_bake(mesh, job.shader->info(), job.voxel_size);
    return fmt::format("{}: about {} voxels of {:.4g}, {} of memory, {}", job.object->name, estimate.voxels,
                       job.voxel_size, format_bytes(estimate.bytes),
                       format_seconds(seconds_per_voxel * double(estimate.voxels)));
}

void bake_all_jobs(const std::vector<Job>& jobs, const Options& options, const Output& output) {
    const Stopwatch watch;
    if (!options.stats.empty()) const PendingFile writable(options.stats);
    const PendingFile writable(options.output);  // fails now rather than after the work
    check_memory(jobs, options.max_memory);
    std::vector<Done> bakes;
    for (const Job& job : jobs) {
        bakes.push_back(naming(job, [&] { return bake_job(job, options); }));
        output.result(describe_bake(bakes.back()));
    }
    std::vector<TextureGrid> grids;
    for (Done& done : bakes) grids.push_back(std::move(done.grid));
    if (grids.size() == 1) grids.front().object.clear();
    const std::uint64_t bytes = write_vdb(options.output, grids, options.file);
    for (std::size_t i = 0; i < bakes.size(); ++i) {
        bakes[i].grid = std::move(grids[i]);
        bakes[i].grid.object = jobs[i].object->name;
    }
    if (!options.stats.empty()) write_stats(options, bakes, bytes, watch.seconds());
    output.result(fmt::format("{}: {} in {}, {}", options.output, format_bytes(bytes),
                              bakes.size() == 1 ? "1 object" : fmt::format("{} objects", bakes.size()),
                              format_seconds(watch.seconds())));
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
    const std::vector<Job> jobs = plan(scene, options);
    if (!options.dry_run) return bake_all_jobs(jobs, options, output);
    for (const Job& job : jobs) output.result(naming(job, [&] { return dry_run(job); }));
}

}  // namespace estara::bake
