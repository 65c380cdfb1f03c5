#include "plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estara/scenes/ray_scene.h"

namespace estara::bake {
namespace {

/// The scene's own settings if the object wears the shader there, with --param over them.
ShaderChoice choose(const Object& object, const Options& options) {
    ShaderChoice choice{
        options.shader, {}, fmt::format("{}: object \"{}\"", options.scene, object.name)};
    if (object.choice.name == options.shader) choice = object.choice;
    for (const Setting& setting : options.params) {
        std::erase_if(choice.settings, [&](const Setting& s) { return s.name == setting.name; });
    }
    if (!options.params.empty()) choice.where = "--param";
    choice.settings.insert(choice.settings.end(), options.params.begin(), options.params.end());
    return choice;
}

/// The setting without which the shader would not be layered, or "" if there is none.
std::string layering_parameter(const ShaderChoice& choice, bool has_uv) {
    for (const Setting& setting : choice.settings) {
        std::vector<Setting> others = choice.settings;
        std::erase_if(others, [&](const Setting& s) { return s.name == setting.name; });
        const BindResult without = bind_shader(choice.name, others, has_uv);
        if (without.shader && !without.shader->layered()) return setting.name;
    }
    return "";
}

/// The choice's shader. Error for one that a grid cannot hold.
BoundShaderPtr bind_solid(const ShaderChoice& choice, bool has_uv) {
    BoundShaderPtr shader = bind_choice(choice, has_uv);
    if (!shader->layered()) return shader;
    const std::string name = layering_parameter(choice, has_uv);
    std::string action = "; estara-render needs no grid for it";
    if (!name.empty()) {
        const auto& params = shader->info().params;
        const auto param = std::find_if(params.begin(), params.end(),
                                        [&](const ParamInfo& p) { return p.name == name; });
        action = fmt::format("; set {} {} to bake it", name, to_string(param->default_value.x));
    }
    throw Error(
        fmt::format("{}: shader '{}' is layered: its record is kept in estara-render's cache, "
                    "there is nothing to bake{}",
                    choice.where, choice.name, action));
}

/// Error for an object so small that squares of its lengths, or of a voxel's, are no floats.
void check_object(const Job& job) {
    constexpr double least = 1e-12;
    const Box box = bounds(job.object->mesh);
    const double diagonal = glm::distance(glm::dvec3(box.min), glm::dvec3(box.max));
    if (diagonal >= least) return;
    throw Error(diagonal > 0.0
                    ? fmt::format("it measures {:.4g}; what is smaller than {:.0e} cannot be baked",
                                  diagonal, least)
                    : "all of it is one point");
}

void check_size(const Job& job, double size) {
    const double diagonal = bounds(job.object->mesh).diagonal();
    if (size <= diagonal) return;
    throw Error(fmt::format("voxel size {:.4g} is larger than the object, which measures {:.4g}",
                            size, diagonal));
}

/// Estimates all jobs with their voxels `factor` times as large.
/// @return bytes of all of them: they go into one file and are in memory together
std::uint64_t estimate(std::vector<Job>& jobs, double factor) {
    std::uint64_t bytes = program_bytes;
    for (Job& job : jobs) {
        if (!job.voxel_size) continue;
        job.estimate = naming(job, [&] {
            return estimate_bake(job.object->mesh, job.shader->info(), *job.voxel_size * factor);
        });
        bytes += job.estimate.bytes;
    }
    return bytes;
}

/// By how much the voxels must grow for all jobs to fit. Error if no growth helps.
double fitting_factor(std::vector<Job> jobs, std::uint64_t bytes, std::uint64_t max_memory) {
    double factor = 1.0;
    for (int step = 0; step < 24 && bytes > max_memory; ++step) {
        factor *= 1.02 * std::sqrt(double(bytes) / double(max_memory));
        bytes = estimate(jobs, factor);
    }
    if (bytes <= max_memory) return factor;
    throw Error(fmt::format("--max-memory {}: too little for any voxel size; the coarsest needs {}",
                            format_bytes(max_memory), format_bytes(bytes)),
                ExitStatus::failed);
}

void fit_memory(std::vector<Job>& jobs, const Options& options,
                const std::function<void(const std::string&)>& message) {
    const std::uint64_t bytes = estimate(jobs, 1.0);
    if (bytes <= options.max_memory) return;
    const double factor = fitting_factor(jobs, bytes, options.max_memory);
    const std::string need =
        fmt::format("{} about {}, --max-memory is {}",
                    jobs.size() == 1 ? fmt::format("object \"{}\" needs", jobs.front().object->name)
                                     : fmt::format("{} objects need", jobs.size()),
                    format_bytes(bytes), format_bytes(options.max_memory));
    if (options.voxel_size) {
        throw Error(
            fmt::format("{}; this fits: --voxel-size {:.4g}", need, *options.voxel_size * factor),
            ExitStatus::failed);
    }
    message(
        fmt::format("warning: {}; baked with voxels {:.3g} times as large as the camera path "
                    "asks for",
                    need, factor));
    for (Job& job : jobs) *job.voxel_size *= factor;
    estimate(jobs, 1.0);
}

}  // namespace

std::vector<double> sizes_from_camera(const Scene& scene, const Options& options) {
    RayScene rays(scene);
    return automatic_voxel_sizes(scene, rays, find_camera(scene, options.camera),
                                 options.frames.value_or(animated_frames(scene, *options.fps)),
                                 *options.fps, options.resolution.x, options.resolution.y);
}

std::vector<Job> plan(const Scene& scene, const Options& options,
                      const std::function<void(const std::string&)>& message,
                      std::vector<double> sizes) {
    if (!options.camera.empty()) find_camera(scene, options.camera);
    const std::vector<int> selected = select_objects(scene, options.shader, options.objects);
    std::vector<Job> jobs;
    for (const int index : selected) {
        const Object& object = scene.objects[std::size_t(index)];
        jobs.push_back(
            {&object, bind_solid(choose(object, options), object.mesh.has_uv()), {}, {}});
        naming(jobs.back(), [&] { check_object(jobs.back()); });
    }
    if (options.max_error) return jobs;
    if (!options.voxel_size && sizes.empty()) sizes = sizes_from_camera(scene, options);
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        Job& job = jobs[i];
        job.voxel_size = options.voxel_size ? *options.voxel_size : sizes[std::size_t(selected[i])];
        if (options.voxel_size) naming(job, [&] { check_size(job, *job.voxel_size); });
    }
    fit_memory(jobs, options, message);
    return jobs;
}

}  // namespace estara::bake
