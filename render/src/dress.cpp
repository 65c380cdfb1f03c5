#include "estara/render/dress.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "estara/render/strategy.h"
#include "estara/scenes/error.h"
#include "estara/scenes/static_light.h"

namespace estara {
namespace {

/// A width that is > 0 even for an object without extent.
float positive(float width) noexcept { return width > 0.0f ? width : 1.0f; }

void tell_missing_grids(const Scene& scene, const GridMatch& match, const Say& say) {
    std::map<std::string, std::vector<std::string>> without;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const Object& object = scene.objects[i];
        if (match.grid_of_object[i] >= 0 || match.is_stale[i] || !object.wears_shader()) continue;
        without[std::string(object.shader->info().name)].push_back(object.name);
    }
    for (const auto& [shader, objects] : without) {
        say(fmt::format("shader '{}' is evaluated directly: no grid for {}", shader,
                        fmt::join(objects, ", ")));
    }
}

bool needs_direct_width(const Scene& scene, const GridMatch& match) {
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        if (match.grid_of_object[i] < 0 && scene.objects[i].wears_shader()) return true;
    }
    return false;
}

/// Each grid flattened once, however many objects share it.
std::vector<std::shared_ptr<const BrickPyramid>> flatten(std::vector<LoadedGrid>& grids,
                                                         const GridMatch& match) {
    std::vector<std::shared_ptr<const BrickPyramid>> pyramids(grids.size());
    const auto make = [&](int g) {
        if (g < 0 || pyramids[std::size_t(g)]) return;
        pyramids[std::size_t(g)] = std::make_shared<BrickPyramid>(grids[std::size_t(g)].grid);
        grids[std::size_t(g)].grid.levels.clear();  // as large again, and of no more use
    };
    std::for_each(match.grid_of_object.begin(), match.grid_of_object.end(), make);
    std::for_each(match.irradiance_of_object.begin(), match.irradiance_of_object.end(), make);
    return pyramids;
}

ObjectRecord record_of(const Object& object, const ObjectShading& shading) {
    ObjectRecord record{object.name,
                        std::string(object.shader->info().name),
                        describe_values(*object.shader),
                        shading.cached    ? Strategy::cache
                        : shading.pyramid ? Strategy::grid
                                          : Strategy::direct,
                        shading.filter_width,
                        ""};
    if (shading.pyramid) {
        record.voxel_size = shading.pyramid->voxel_size();
        record.levels = shading.pyramid->levels();
        record.grid_bytes = shading.pyramid->bytes();
    }
    if (shading.irradiance) record.grid_bytes += shading.irradiance->bytes();
    return record;
}

}  // namespace

void put_on(Scene& scene, const std::string& shader, const std::vector<Setting>& params) {
    if (shader.empty()) return;
    bind_choice({shader, params, "--shader"}, true);  // an error even if every object wears one
    for (Object& object : scene.objects) {
        if (object.wears_shader()) continue;
        object.choice = {shader, params, "--shader"};
        object.shader = bind_choice(object.choice, object.mesh.has_uv());
    }
}

std::vector<float> direct_filter_widths(const Scene& scene, RayScene& rays, int camera, double fps,
                                        int width, int height) {
    const std::vector<double> sizes =
        automatic_voxel_sizes(scene, rays, camera, animated_frames(scene, fps), fps, width, height);
    std::vector<float> widths;
    for (const double size : sizes) widths.push_back(float(size));
    return widths;
}

bool keeps_light(const Scene& scene, const Options& options) {
    const std::string moving = moving_node(scene);
    if (options.cache_light.value_or(false) && !moving.empty()) {
        throw Error(fmt::format(
            "--cache-light on: \"{}\" moves, so that light changes; use auto or off", moving));
    }
    return options.cache_light.value_or(moving.empty());
}

std::unique_ptr<ReuseCache> make_cache(const Scene& scene, const Options& options,
                                       const std::vector<ObjectShading>& shading) {
    if (std::none_of(shading.begin(), shading.end(),
                     [](const ObjectShading& s) { return s.cached; })) {
        return nullptr;
    }
    const int lights = keeps_light(scene, options) ? int(scene.lights.size()) : -1;
    std::vector<int> objects;
    std::vector<bool> bent(scene.objects.size(), false);
    for (const Instance& instance : scene.instances) {
        objects.push_back(instance.object);
        if (bends(scene, instance)) bent[std::size_t(instance.object)] = true;
    }
    std::vector<RecordLayout> layouts;
    for (std::size_t o = 0; o < shading.size(); ++o) {
        layouts.push_back(record_layout(shading[o].shader->info(), lights, bent[o]));
    }
    return std::make_unique<ReuseCache>(options.cache_memory, std::move(layouts),
                                        std::move(objects));
}

Wardrobe dress(Scene& scene, RayScene& rays, const Options& options, int camera,
               const FrameRange& range, const Say& say) {
    const bool is_used = std::any_of(scene.objects.begin(), scene.objects.end(),
                                     [](const Object& o) { return !o.wears_shader(); });
    put_on(scene, options.shader, options.params);
    if (!options.shader.empty() && !is_used) {
        say(fmt::format("warning: --shader {}: not used, every object of {} wears a shader",
                        options.shader, scene.path));
    }
    std::vector<LoadedGrid> grids = load_grids(options.grids, say);
    const GridMatch match = match_grids(scene, grids);
    for (const std::string& warning : match.warnings) say("warning: " + warning);
    const bool uses_grids =
        options.strategy == Strategy::grid || options.strategy == Strategy::automatic;
    if (options.strategy == Strategy::grid) tell_missing_grids(scene, match, say);

    std::vector<float> widths(scene.objects.size());
    if (needs_direct_width(scene, match)) {
        widths = direct_filter_widths(scene, rays, camera, *options.fps, options.frame.width,
                                      options.frame.height);
    }
    std::vector<std::shared_ptr<const BrickPyramid>> pyramids(grids.size());
    if (uses_grids) pyramids = flatten(grids, match);

    Wardrobe wardrobe;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const int g = match.grid_of_object[i];
        ObjectShading shading{scene.objects[i].shader, nullptr, positive(widths[i]), nullptr};
        if (g >= 0) shading.filter_width = float(grids[std::size_t(g)].grid.voxel_size);
        wardrobe.direct.push_back(shading);
        if (g >= 0) shading.pyramid = pyramids[std::size_t(g)];
        const int light = match.irradiance_of_object[i];
        if (light >= 0) shading.irradiance = pyramids[std::size_t(light)];
        wardrobe.chosen.push_back(std::move(shading));
    }
    std::vector<StrategyChoice> choices;
    if (options.strategy == Strategy::automatic) {
        std::vector<int> frames;
        for (int i = 0; i < range.count(); ++i) frames.push_back(range.at(i));
        choices = choose_strategies(scene, rays, options, camera, frames, wardrobe.direct,
                                    wardrobe.chosen);
        for (const std::string& line : describe_choices(scene, choices)) say(line);
    }
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const Strategy strategy = choices.empty() ? options.strategy : choices[i].chosen;
        ObjectShading& chosen = wardrobe.chosen[i];
        if (strategy == Strategy::cache || strategy == Strategy::direct) {
            chosen = wardrobe.direct[i];
            chosen.cached = strategy == Strategy::cache;
        }
        wardrobe.records.push_back(record_of(scene.objects[i], chosen));
        if (!choices.empty()) wardrobe.records.back().choice = choices[i];
        if (chosen.pyramid) {
            wardrobe.records.back().grid_file = grids[std::size_t(match.grid_of_object[i])].file;
        }
    }
    return wardrobe;
}

}  // namespace estara
