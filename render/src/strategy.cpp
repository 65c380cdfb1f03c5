#include "estara/render/strategy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "tile_grid.h"

namespace estara {
namespace {

constexpr int tiles_measured = 48;

/// a / b, 0 where there is nothing to divide by.
double per(double a, std::uint64_t b) noexcept { return b > 0 ? a / double(b) : 0.0; }

/// Costs of the second of two frames.
struct Trial {
    FrameStatistics direct, grid, cache;
};

/// One after the other, each after a frame that warms it up.
class Trials {
public:
    Trials(const Scene& scene, RayScene& rays, const Options& options, int camera)
        : m_scene(scene), m_options(options), m_camera(camera), m_settings(options.frame) {
        m_settings.aovs = {};
        const TileGrid tiles(m_settings.width, m_settings.height);
        m_settings.tile_step = std::max(1, tiles.count() / tiles_measured);
        // Else the tiles would all lie below one another.
        while (std::gcd(m_settings.tile_step, tiles.columns) != 1) ++m_settings.tile_step;
        m_renderer = std::make_unique<FrameRenderer>(scene, rays, m_settings);
    }

    FrameStatistics measure(const std::vector<ObjectShading>& shading, int first, int second,
                            ReuseCache* cache) {
        Film film(m_settings.width, m_settings.height, {});
        for (int warm = 0; warm < 2; ++warm) {
            if (cache != nullptr) cache->clear();
            render(shading, first, film, cache);
            if (cache != nullptr) break;
        }
        return render(shading, second, film, cache);
    }

private:
    FrameStatistics render(const std::vector<ObjectShading>& shading, int frame, Film& film,
                           ReuseCache* cache) {
        return m_renderer->render(shading, m_camera, frame / *m_options.fps, film, {}, cache);
    }

    const Scene& m_scene;
    const Options& m_options;
    int m_camera;
    FrameSettings m_settings;
    std::unique_ptr<FrameRenderer> m_renderer;
};

ObjectCost cost_of(const FrameStatistics& statistics, std::size_t object) {
    return object < statistics.objects.size() ? statistics.objects[object] : ObjectCost{};
}

/// How many of the frames a window has, on average.
double frames_together(const Options& options, const std::vector<int>& frames) {
    std::set<int> windows;
    for (const int frame : frames) windows.insert(window_of(options, frame));
    return windows.empty() ? 0.0 : double(frames.size()) / double(windows.size());
}

/// What a sample of an object costs by each strategy.
StrategyChoice weigh(const Trial& trial, std::size_t o, bool has_grid, bool keeps_light,
                     bool may_cache, double window) {
    StrategyChoice choice;
    const ObjectCost direct = cost_of(trial.direct, o), cache = cost_of(trial.cache, o),
                     grid = cost_of(trial.grid, o);
    if (direct.evaluated == 0) return choice;
    choice.samples = direct.evaluated;
    const double bake = per(direct.evaluation, direct.evaluated);
    const double light =
        per(trial.direct.light_seconds + trial.direct.shadow_seconds, trial.direct.lit);
    // A recalled sample is still asked what each light's highlight is.
    const double kept_light =
        may_cache && keeps_light
            ? std::max(0.0, light - per(trial.cache.light_seconds, trial.cache.samples))
            : 0.0;
    const double view = per(direct.view, direct.evaluated);
    SampleTimes& t = choice.times;
    t.vi = bake + kept_light;
    t.vd = view + light - kept_light;
    choice.lookup = has_grid && grid.evaluated > 0 ? per(grid.evaluation, grid.evaluated) : 0.0;

    const double straight = t.without_reuse();
    double best = straight / least_gain;
    choice.cost = straight;
    if (has_grid && grid.evaluated > 0 && straight - bake + choice.lookup < best) {
        best = choice.cost = straight - bake + choice.lookup;
        choice.chosen = Strategy::grid;
    }
    if (!may_cache || cache.recalled == 0) return choice;
    // Reprojection is of all points and slots, the samples are of some tiles.
    const double projecting = per(trial.cache.reuse.projection_seconds, trial.cache.reuse.slots);
    t.save = per(cache.keep, cache.kept) +
             per(trial.cache.reuse.insertion_seconds, trial.cache.reuse.kept);
    t.extract = per(cache.recall, cache.recalled) +
                per(trial.cache.reuse.listing_seconds, trial.cache.reuse.hits) + projecting;
    const double recalled = double(cache.recalled) / double(cache.recalled + cache.evaluated);
    choice.frames = recalled < 1.0 ? std::min(window, 1.0 / (1.0 - recalled)) : window;
    choice.speedup = predicted_speedup(t, choice.frames);
    const double reuse = time_with_reuse(t, choice.frames) / choice.frames;
    if (reuse < best) {
        choice.cost = reuse;
        choice.chosen = Strategy::cache;
    }
    return choice;
}

}  // namespace

std::vector<StrategyChoice> choose_strategies(const Scene& scene, RayScene& rays,
                                              const Options& options, int camera,
                                              const std::vector<int>& frames,
                                              const std::vector<ObjectShading>& direct,
                                              const std::vector<ObjectShading>& gridded) {
    const double together = frames_together(options, frames);
    const bool may_cache = together > 1.0;
    const bool any_grid = std::any_of(gridded.begin(), gridded.end(),
                                      [](const ObjectShading& s) { return bool(s.pyramid); });
    if (!may_cache && !any_grid) return {};
    const std::size_t middle = frames.size() > 1 ? (frames.size() - 1) / 2 : 0;
    const int first = frames[middle], second = may_cache ? frames[middle + 1] : first;
    Trials trials(scene, rays, options, camera);
    Trial trial;
    trial.direct = trials.measure(direct, first, second, nullptr);
    if (any_grid) trial.grid = trials.measure(gridded, first, second, nullptr);
    if (may_cache) {
        std::vector<ObjectShading> cached = direct;
        for (ObjectShading& shading : cached) shading.cached = true;
        const std::unique_ptr<ReuseCache> cache = make_cache(scene, options, cached);
        trial.cache = trials.measure(cached, first, second, cache.get());
    }
    const bool light = keeps_light(scene, options);
    std::vector<StrategyChoice> choices;
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        choices.push_back(weigh(trial, o, bool(gridded[o].pyramid), light, may_cache, together));
    }
    return choices;
}

std::vector<std::string> describe_choices(const Scene& scene,
                                          const std::vector<StrategyChoice>& choices) {
    std::map<std::pair<std::string, Strategy>, std::vector<const StrategyChoice*>> groups;
    for (std::size_t o = 0; o < choices.size(); ++o) {
        if (choices[o].samples == 0) continue;
        groups[{std::string(scene.objects[o].shader->info().name), choices[o].chosen}].push_back(
            &choices[o]);
    }
    std::vector<std::string> lines;
    for (const auto& [key, group] : groups) {
        SampleTimes mean;
        double weight = 0.0, frames = 0.0, lookup = 0.0;
        for (const StrategyChoice* choice : group) {
            const auto w = double(choice->samples);
            mean.vi += w * choice->times.vi;
            mean.vd += w * choice->times.vd;
            mean.save += w * choice->times.save;
            mean.extract += w * choice->times.extract;
            frames += w * choice->frames;
            lookup += w * choice->lookup;
            weight += w;
        }
        mean = {mean.vi / weight, mean.vd / weight, mean.save / weight, mean.extract / weight};
        frames /= weight;
        std::string line = fmt::format("auto: {}: {}", key.first, to_string(key.second));
        if (group.size() > 1) line += fmt::format(" for {} objects", group.size());
        line += fmt::format("; a sample takes {:.0f} ns + {:.0f} ns that depend on the view",
                            1e9 * mean.vi, 1e9 * mean.vd);
        if (lookup > 0.0) line += fmt::format(", looked up {:.0f} ns", 1e9 * lookup / weight);
        if (mean.extract > 0.0) {
            line += fmt::format(
                ", recalled {:.0f} ns, saved {:.0f} ns: over {:.3g} frames reuse is {:.2f} times "
                "as fast (pays from {:.2g} on, tends to {:.2f})",
                1e9 * mean.extract, 1e9 * mean.save, frames, predicted_speedup(mean, frames),
                break_even(mean), limit_of_speedup(mean));
        }
        lines.push_back(line);
    }
    return lines;
}

}  // namespace estara
