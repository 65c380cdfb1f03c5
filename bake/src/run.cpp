#include "estara/bake/run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>
#include <xxhash.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <set>

#include "describe.h"
#include "estara/bake/bake.h"
#include "estara/bake/irradiance.h"
#include "estara/scenes/load.h"
#include "estara/scenes/static_light.h"
#include "estara/shaders/batch.h"
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

nlohmann::json stats_of(const Options& options, const std::vector<Done>& bakes, std::uint64_t bytes,
                        double seconds) {
    nlohmann::json objects = nlohmann::json::array();
    for (const Done& done : bakes) objects.push_back(as_json(done));
    return {{"version", version},           {"shader", options.shader}, {"scene", options.scene},
            {"file", options.output},       {"bytes", bytes},           {"seconds", seconds},
            {"peak_memory", peak_memory()}, {"objects", objects}};
}

void write_stats(const std::string& file, const nlohmann::json& stats) {
    if (file.empty()) return;
    // A file's name need not be UTF-8.
    constexpr auto replace = nlohmann::json::error_handler_t::replace;
    write_text(file, stats.dump(2, ' ', false, replace) + "\n");
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

/// @param request  for the file's metadata, or ""
/// @return         what --stats says of it
nlohmann::json bake_all_jobs(const std::vector<Job>& jobs, const Scene& scene,
                             const Options& options, const Output& output,
                             const std::string& request) {
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
    for (TextureGrid& grid : grids) grid.request = request;
    const std::uint64_t bytes = write_file(options, grids);
    std::size_t written = 0;
    for (Done& done : bakes) {
        done.grid = std::move(grids[written++]);
        if (done.light) done.light = std::move(grids[written++]);
    }
    output.result(
        fmt::format("{}: {} in {}, {}", options.output, format_bytes(bytes),
                    bakes.size() == 1 ? "1 object" : fmt::format("{} objects", bakes.size()),
                    format_seconds(watch.seconds())));
    return stats_of(options, bakes, bytes, watch.seconds());
}

/// 16 hex digits that change whenever a bake of these jobs would give another file.
std::string request_of(const std::vector<Job>& jobs, const Scene& scene, const Options& options) {
    std::string text = fmt::format("{} {} {} {} {} {}", version, options.seed, options.file.half,
                                   int(options.file.compression),
                                   options.irradiance ? options.irradiance_error : 0.0,
                                   options.irradiance_voxel_size.value_or(0.0));
    for (const Job& job : jobs) {
        text += fmt::format(";{} {} {} {:a} {:a}", job.object->name, mesh_digest(job.object->mesh),
                            shader_digest(*job.shader), job.voxel_size.value_or(0.0),
                            options.max_error.value_or(0.0));
        for (const glm::vec3& value : job.shader->values()) {
            text += fmt::format(" {:a} {:a} {:a}", value.x, value.y, value.z);
        }
        const std::vector<int> places = instances_of(scene, int(job.object - scene.objects.data()));
        if (options.irradiance && places.size() == 1) {
            text += lights_digest(scene, places.front());
        }
    }
    return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

/// Whether a file is there, whole, and what would be baked again.
bool is_fresh(const std::string& file, const std::string& request, const Output& output) {
    std::error_code code;
    if (!std::filesystem::exists(file, code)) return false;
    try {
        const std::vector<TextureGrid> grids = read_vdb(file);
        return std::all_of(grids.begin(), grids.end(),
                           [&](const TextureGrid& grid) { return grid.request == request; });
    } catch (const Error& error) {
        output.message(fmt::format("warning: {}; baked again", error.what()));
        return false;
    }
}

/// Whether a shader paints everything alike: tried at points all over an object.
bool is_one_colour(const Object& object) {
    const Box box = bounds(object.mesh);
    SurfaceBatch batch;
    batch.filter_width = 1e-4f * std::max(box.diagonal(), 1e-30f);
    for (batch.size = 0; batch.size < 256;) {
        // The golden ratio's generalisation to three dimensions spreads evenly.
        const float i = float(batch.size);
        const glm::vec3 at(glm::fract(glm::vec3(0.8191725f, 0.6710436f, 0.5497005f) * i));
        batch.set(batch.size++, glm::mix(box.min, box.max, at),
                  glm::normalize(at - glm::vec3(0.49f)), glm::vec2(at), {1.0f, 0.0f, 0.0f});
    }
    const int floats = object.shader->info().baked_floats;
    std::vector<float> planes(std::size_t(floats) * batch_capacity);
    object.shader->bake(batch, planes.data());
    for (int k = 0; k < floats; ++k) {
        const float* const plane = planes.data() + k * batch_capacity;
        if (std::any_of(plane, plane + batch.size, [&](float v) { return v != plane[0]; })) {
            return false;
        }
    }
    return true;
}

/// The objects that wear a shader, as globs, of those that --object names; apart the shaders of
/// which there is nothing to bake.
std::map<std::string, std::vector<std::string>> objects_by_shader(const Scene& scene,
                                                                  const Options& options,
                                                                  std::set<std::string>& layered,
                                                                  std::set<std::string>& plain) {
    std::vector<int> chosen(scene.objects.size());
    std::iota(chosen.begin(), chosen.end(), 0);
    if (!options.objects.empty()) chosen = select_objects(scene, "", options.objects);
    std::map<std::string, std::vector<std::string>> found;
    for (const int o : chosen) {
        const Object& object = scene.objects[std::size_t(o)];
        if (!object.wears_shader()) continue;
        if (object.shader->layered()) {
            layered.insert(object.choice.name);
        } else if (is_one_colour(object)) {
            plain.insert(object.choice.name);
        } else {
            found[object.choice.name].push_back(object.name);
        }
    }
    return found;
}

/// What else lies in the folder, by a bake of another scene or another program.
void tell_of_others(const std::filesystem::path& folder, const std::set<std::string>& ours,
                    const Output& output) {
    std::set<std::string> others;
    std::error_code code;
    for (std::filesystem::directory_iterator it(folder, code), end; !code && it != end;
         it.increment(code)) {
        const std::string name = it->path().filename().string();
        if (name.ends_with(".vdb") && !name.starts_with('.') && !ours.contains(name)) {
            others.insert(name);
        }
    }
    if (others.empty()) return;
    output.message(fmt::format("warning: {}: left as they are, the scene needs none of: {}",
                               folder.string(), fmt::join(others, ", ")));
}

/// Bakes all that a scene needs into a folder, a file for each shader. What is fresh is not baked
/// again: a bake that was interrupted goes on where it was.
void bake_scene(const Scene& scene, const Options& options, const Output& output) {
    std::set<std::string> layered, plain, files;
    const auto by_shader = objects_by_shader(scene, options, layered, plain);
    if (!plain.empty()) {
        output.message(
            fmt::format("one colour all over, nothing to bake: {}", fmt::join(plain, ", ")));
    }
    if (!layered.empty()) {
        output.message(
            fmt::format("layered, left to estara-render's cache: {}", fmt::join(layered, ", ")));
    }
    if (by_shader.empty()) {
        throw Error(fmt::format("{}: no object wears a shader that can be baked", scene.path));
    }
    std::error_code code;
    if (std::filesystem::exists(options.output, code) &&
        !std::filesystem::is_directory(options.output, code)) {
        throw Error(
            fmt::format("-o {}: is a file; a scene is baked into a folder", options.output));
    }
    std::vector<double> sizes;
    if (!options.voxel_size && !options.max_error) sizes = sizes_from_camera(scene, options);
    std::vector<std::pair<Options, std::vector<Job>>> bakes;
    for (const auto& [shader, objects] : by_shader) {
        Options one = options;
        one.shader = shader;
        one.objects = objects;
        one.params.clear();  // the scene has them
        one.output = (std::filesystem::path(options.output) / (shader + ".vdb")).string();
        files.insert(shader + ".vdb");
        std::vector<Job> jobs = plan(scene, one, output.message, sizes);
        bakes.emplace_back(std::move(one), std::move(jobs));
    }
    nlohmann::json stats = nlohmann::json::array(), fresh = stats;
    for (const auto& [one, jobs] : bakes) {
        if (options.dry_run) {
            for (const Job& job : jobs) {
                output.result(naming(job, [&, &of = one] { return dry_run(job, of); }));
            }
            continue;
        }
        const std::string request = request_of(jobs, scene, one);
        if (is_fresh(one.output, request, output)) {
            output.result(fmt::format("{}: fresh, not baked again", one.output));
            fresh.push_back(one.output);
            continue;
        }
        check_writable(one);
        stats.push_back(bake_all_jobs(jobs, scene, one, output, request));
    }
    if (options.dry_run) return;
    tell_of_others(options.output, files, output);
    write_stats(options.stats, {{"version", version},
                                {"scene", options.scene},
                                {"folder", options.output},
                                {"files", stats},
                                {"fresh", fresh}});
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

void run(const Options& given, const Output& output) {
    Options options = given;
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
    if (!options.shader.empty()) check_shader(options.shader);
    Scene scene = load_scene(options.scene, options.allow_outside);
    options.fps = frame_rate(scene, given.fps);
    if (options.shader.empty()) set_parameters(scene, options.params);
    for (const std::string& warning : scene.warnings) output.message("warning: " + warning);
    if (options.irradiance) check_light(scene);
    if (options.shader.empty()) return bake_scene(scene, options, output);
    if (!options.dry_run) check_writable(options);
    const std::vector<Job> jobs = plan(scene, options, output.message);
    if (!options.dry_run)
        return write_stats(options.stats, bake_all_jobs(jobs, scene, options, output, ""));
    for (const Job& job : jobs) output.result(naming(job, [&] { return dry_run(job, options); }));
}

}  // namespace estara::bake
