// estara-paper: the paper's Tables 2 and 3 once more, the paper's figures beside ours, and the
// error and the flicker that it gives no figures for.
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "estara/bake/bake.h"
#include "estara/render/compare.h"
#include "estara/render/dress.h"
#include "estara/render/flicker.h"
#include "estara/scenes/load.h"
#include "fixed_points.h"
#include "meshes.h"
#include "rounds.h"
#include "run_command.h"

namespace estara::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Settings {
    std::vector<std::string> tables;
    std::string folder = "build", resolution = "320x180";
    int runs = 5, spp = 16, positions = 100, reference_spp = 256;
    bool has(const char* table) const {
        return tables.empty() || std::find(tables.begin(), tables.end(), table) != tables.end();
    }
};

constexpr double fps = 24.0;

/// Speedups of the paper's Table 2, at 50 and 100 camera positions.
struct PaperRow {
    const char* shader;
    double at_50, at_100;
};
constexpr PaperRow paper_table_2[]{
    {"blocks", 3.18, 3.26},      {"carpet", 2.78, 2.91},      {"cmarble", 4.27, 4.43},
    {"colormarble", 4.01, 4.25}, {"cobblestone", 2.28, 2.29}, {"greenmarble", 2.92, 2.96},
    {"spatter", 1.75, 1.75},     {"stone", 1.19, 1.27},       {"velvet", 0.99, 1.03},
    {"wood", 1.67, 1.72},        {"RCSkin", 2.07, 2.38}};

Scene made_scene(const Settings& settings, const std::string& name) {
    const std::string path = settings.folder + "/paper/" + name + ".glb";
    run_command("estara-scenes " + name + " -o '" + path + "'");
    return load_scene(path);
}

Json spread_json(const Spread& s) { return {{"median", s.median}, {"min", s.min}, {"max", s.max}}; }

Json table_2(const Settings& settings, std::string& markdown) {
    Scene scene = made_scene(settings, "simple");
    markdown +=
        "### Table 2: shading only, no visibility test\n\n"
        "Hit points of `simple`, lit without shadows; NOREUSE evaluates the shader, its light and "
        "its view-dependent part for every camera position, REUSE the first two once. Milliseconds "
        "of one thread, medians of " +
        fmt::format("{}", settings.runs) +
        " paired runs; in brackets the least and the largest ratio. RMSE: colours of REUSE against "
        "NOREUSE at the last position.\n\n"
        "| shader | 50: NOREUSE | REUSE | speedup | paper | 100: NOREUSE | REUSE | speedup | paper "
        "| RMSE | VI, VD, save, extract: ns | Eq. 4 predicts | auto |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    Json table;
    for (const PaperRow& row : paper_table_2) {
        FixedPoints points(scene, row.shader);
        Json entry;
        std::string line = fmt::format("| {} |", row.shader);
        double rmse = 0.0;
        for (const int n : {50, 100}) {
            const auto costs = rounds(
                settings.runs, {[&] { points.without_reuse(n); }, [&] { points.with_reuse(n); }});
            const double error = points.rmse();
            rmse = std::max(rmse, error);
            const Spread speedup = ratio(costs[0], costs[1], &Cost::cpu);
            const auto ms = [](const Cost& c) { return 1e3 * c.cpu; };
            const Spread direct = spread_of(costs[0], ms), reuse = spread_of(costs[1], ms);
            entry[std::to_string(n)] = {{"noreuse_s", 1e-3 * direct.median},
                                        {"reuse_s", 1e-3 * reuse.median},
                                        {"speedup", speedup.median},
                                        {"speedup_min", speedup.min},
                                        {"speedup_max", speedup.max},
                                        {"rmse", error},
                                        {"paper", n == 50 ? row.at_50 : row.at_100}};
            line += fmt::format(" {:.1f} | {:.1f} | **{:.2f}** ({:.2f} to {:.2f}) | {:.2f} |",
                                direct.median, reuse.median, speedup.median, speedup.min,
                                speedup.max, n == 50 ? row.at_50 : row.at_100);
        }
        const SampleTimes t = points.times();
        const double predicted = predicted_speedup(t, 100.0);
        entry["samples"] = points.count();
        entry["predicted_100"] = predicted;
        entry["limit"] = limit_of_speedup(t);
        entry["break_even"] = break_even(t);
        const bool declined = predicted < least_gain;
        entry["auto"] = declined ? "direct" : "cache";
        if (declined) {
            for (const char* n : {"50", "100"}) {  // what estara-render does of its own accord
                entry[n]["speedup_forced"] = entry[n]["speedup"];
                entry[n]["speedup"] = 1.0;
            }
        }
        line += fmt::format(" {:.1g} | {:.1f}, {:.1f}, {:.1f}, {:.1f} | {:.2f} | {} |\n", rmse,
                            1e9 * t.vi, 1e9 * t.vd, 1e9 * t.save, 1e9 * t.extract, predicted,
                            std::string(entry["auto"]));
        markdown += line;
        table[row.shader] = entry;
        fmt::print(stderr, "{}", line);
    }
    markdown += "\n";
    return table;
}

/// Films of the frames in which errors are measured.
using Films = std::map<int, Film>;

/// Each of these frames and the one before it.
std::vector<int> measured_frames(const Settings& settings) {
    std::vector<int> frames;
    for (int i = 1; i <= 5; ++i) frames.push_back(settings.positions * i / 5);
    return frames;
}

struct Quality {
    ImageError against_reference;
    Flicker flicker;
};

/// As a display shows it: else the few pixels that are far brighter than white, beside lamps, would
/// be all that an RMSE tells of.
Film clipped(Film film) {
    for (glm::vec4& pixel : film.color) pixel = glm::clamp(pixel, 0.0f, 1.0f);
    return film;
}

class Animated {
public:
    Animated(const Settings& settings, const std::string& name)
        : m_settings(settings), m_scene(made_scene(settings, name)), m_rays(m_scene) {
        m_options.scene = name + ".glb";
        m_options.fps = fps;
        m_options.frame.spp = settings.spp;
        const glm::ivec2 size = parse_resolution(settings.resolution);
        m_options.frame.width = size.x;
        m_options.frame.height = size.y;
        const std::vector<float> widths =
            direct_filter_widths(m_scene, m_rays, 0, fps, size.x, size.y);
        for (std::size_t i = 0; i < m_scene.objects.size(); ++i) {
            m_direct.push_back({m_scene.objects[i].shader, nullptr, widths[i]});
        }
        m_cached = m_direct;
        for (ObjectShading& shading : m_cached) shading.cached = true;
        m_cache = make_cache(m_scene, m_options, m_cached);
        m_renderer = std::make_unique<FrameRenderer>(m_scene, m_rays, m_options.frame);
    }

    /// Renders the animation; keeps the films of measured frames and those before them.
    void render(bool reuse, Films* kept) {
        if (reuse) m_cache->clear();
        for (int frame = 1; frame <= m_settings.positions; ++frame) {
            Film film = render_frame(*m_renderer, reuse ? m_cached : m_direct, frame,
                                     reuse ? m_cache.get() : nullptr);
            if (kept != nullptr && is_kept(frame)) kept->emplace(frame, clipped(std::move(film)));
        }
    }

    /// The measured frames alone, from grids of at most so many voxels an object where that can be.
    double render_grids(double voxels, Films& kept, double& direct_seconds) {
        std::vector<ObjectShading> gridded = m_direct;
        for (std::size_t i = 0; i < m_scene.objects.size(); ++i) {
            const Object& object = m_scene.objects[i];
            if (object.shader->layered() || object.shader->info().name == "plastic") continue;
            const double size = std::max(double(m_direct[i].filter_width),
                                         voxel_size_for(object.mesh, *object.shader, voxels));
            gridded[i].pyramid =
                std::make_shared<BrickPyramid>(bake_mesh(object.mesh, *object.shader, size, false));
            gridded[i].filter_width = float(size);
        }
        double seconds = 0.0;
        for (int frame = 1; frame <= m_settings.positions; ++frame) {
            if (!is_kept(frame)) continue;
            kept.emplace(frame, clipped(render_frame(*m_renderer, gridded, frame, nullptr)));
            seconds += m_last.seconds;
            render_frame(*m_renderer, m_direct, frame, nullptr);
            direct_seconds += m_last.seconds;
        }
        return seconds;
    }

    Films references() {
        FrameSettings settings = m_options.frame;
        settings.spp = m_settings.reference_spp;
        FrameRenderer renderer(m_scene, m_rays, settings);
        Films films;
        for (int frame = 1; frame <= m_settings.positions; ++frame) {
            if (is_kept(frame)) {
                films.emplace(frame, clipped(render_frame(renderer, m_direct, frame, nullptr)));
            }
        }
        return films;
    }

    Quality quality(const Films& films, const Films& references) {
        std::vector<ImageError> errors;
        std::vector<Flicker> flickers;
        for (const int t : measured_frames(m_settings)) {
            errors.push_back(compare_films(films.at(t), references.at(t)));
            const std::vector<glm::vec2> moved =
                motion(m_scene, m_rays, 0, (t - 1) / fps, t / fps, m_options.frame.width,
                       m_options.frame.height);
            flickers.push_back(flicker(films.at(t - 1), films.at(t), references.at(t - 1),
                                       references.at(t), moved));
        }
        return {pooled(errors), pooled(flickers)};
    }

    ImageError difference(const Films& a, const Films& b) const {
        std::vector<ImageError> errors;
        for (const int t : measured_frames(m_settings)) {
            errors.push_back(compare_films(a.at(t), b.at(t)));
        }
        return pooled(errors);
    }

    const ReuseCounts& reused() const { return m_reused; }  ///< of all frames of the last render

private:
    bool is_kept(int frame) const {
        for (const int t : measured_frames(m_settings)) {
            if (frame == t || frame == t - 1) return true;
        }
        return false;
    }

    Film render_frame(FrameRenderer& renderer, const std::vector<ObjectShading>& shading, int frame,
                      ReuseCache* cache) {
        Film film(m_options.frame.width, m_options.frame.height, {});
        m_last = renderer.render(shading, 0, frame / fps, film, {}, cache);
        if (cache != nullptr) {
            if (cache->frame() == 0) m_reused = {};
            const std::uint64_t peak = std::max(m_reused.bytes, m_last.reuse.bytes);
            m_reused += m_last.reuse;
            m_reused.bytes = peak;
        }
        return film;
    }

    const Settings& m_settings;
    Scene m_scene;
    RayScene m_rays;
    Options m_options;
    std::vector<ObjectShading> m_direct, m_cached;
    std::unique_ptr<ReuseCache> m_cache;
    std::unique_ptr<FrameRenderer> m_renderer;
    FrameStatistics m_last;
    ReuseCounts m_reused;
};

Json table_3_of(const Settings& settings, const std::string& name, const char* title, double paper,
                std::string& markdown) {
    Animated scene(settings, name);
    Films direct, cached, gridded;
    scene.render(false, &direct);
    scene.render(true, &cached);
    const ReuseCounts reused = scene.reused();
    const auto costs = rounds(settings.runs, {[&] { scene.render(false, nullptr); },
                                              [&] { scene.render(true, nullptr); }});
    double direct_seconds = 0.0;
    const double grid_seconds = scene.render_grids(1e6, gridded, direct_seconds);
    const Films references = scene.references();
    const Quality of_direct = scene.quality(direct, references),
                  of_cache = scene.quality(cached, references),
                  of_grid = scene.quality(gridded, references);

    const Spread speedup = ratio(costs[0], costs[1], &Cost::wall);
    const auto wall = [](const Cost& c) { return c.wall; };
    const Spread noreuse = spread_of(costs[0], wall), reuse = spread_of(costs[1], wall);
    const double share = double(reused.hits) / double(reused.hits + reused.refilled);
    const auto line = [&](const char* strategy, const std::string& time, const std::string& ratio,
                          const Quality& q) {
        markdown += fmt::format(
            "| {} | {} | {} | {} | {} | {:.5f} | {:.4f} | {:.5f} | {:.4f} |\n", title, strategy,
            time, ratio,
            ratio == "1" || ratio.find("of") != ratio.npos ? "" : fmt::format("{:.2f}", paper),
            q.against_reference.rmse, q.against_reference.p999, q.flicker.rms, q.flicker.p99);
    };
    line("direct", fmt::format("{:.1f} s", noreuse.median), "1", of_direct);
    line("cache", fmt::format("{:.1f} s", reuse.median),
         fmt::format("**{:.2f}** ({:.2f} to {:.2f})", speedup.median, speedup.min, speedup.max),
         of_cache);
    line("grid", "", fmt::format("{:.2f} of the measured frames", direct_seconds / grid_seconds),
         of_grid);
    return {{"speedup", speedup.median},
            {"speedup_spread", spread_json(speedup)},
            {"paper", paper},
            {"noreuse_s", noreuse.median},
            {"reuse_s", reuse.median},
            {"rmse", of_cache.against_reference.rmse},
            {"rmse_direct", of_direct.against_reference.rmse},
            {"rmse_grid", of_grid.against_reference.rmse},
            {"p99.9", of_cache.against_reference.p999},
            {"p99.9_direct", of_direct.against_reference.p999},
            {"rmse_cache_to_direct", scene.difference(cached, direct).rmse},
            {"rmse_grid_to_direct", scene.difference(gridded, direct).rmse},
            {"speedup_grid", direct_seconds / grid_seconds},
            {"flicker_cache", of_cache.flicker.rms},
            {"flicker_direct", of_direct.flicker.rms},
            {"flicker_grid", of_grid.flicker.rms},
            {"flicker_p99_cache", of_cache.flicker.p99},
            {"flicker_p99_direct", of_direct.flicker.p99},
            {"recalled_share", share},
            {"occluded", reused.occluded},
            {"evicted", reused.evicted},
            {"cache_bytes", reused.bytes}};
}

Json table_3(const Settings& settings, std::string& markdown) {
    markdown += fmt::format(
        "### Table 3: whole frames, with visibility\n\n"
        "{} camera positions, {}, {} samples a pixel, lights with shadows; wall time of {} paired "
        "runs. Colours clipped to [0, 1] as a display does; RMSE and p99.9 against {} samples a "
        "pixel in {} frames; flicker: RMS and p99 of "
        "what "
        "changes between two frames along the motion and does not in the reference.\n\n"
        "| scene | strategy | time | speedup | paper | RMSE | p99.9 | flicker RMS | p99 |\n"
        "|---|---|---|---|---|---|---|---|---|\n",
        settings.positions, settings.resolution, settings.spp, settings.runs,
        settings.reference_spp, measured_frames(settings).size());
    Json table;
    table["Interior"] = table_3_of(settings, "interior", "Interior", 2.62, markdown);
    table["Face"] = table_3_of(settings, "face", "Face", 1.22, markdown);
    markdown += "\n";
    return table;
}

void run(const Settings& settings) {
    std::filesystem::create_directories(settings.folder + "/paper");
    std::string markdown = fmt::format("{} threads, g++ {}, {:%Y-%m-%d %H:%M}.\n\n",
                                       tbb::this_task_arena::max_concurrency(), __VERSION__,
                                       fmt::localtime(std::time(nullptr)));
    Json result;
    if (settings.has("table2")) result["table2"] = table_2(settings, markdown);
    if (settings.has("table3")) result["table3"] = table_3(settings, markdown);
    write_text(settings.folder + "/paper.json", result.dump(2) + "\n");
    write_text(settings.folder + "/paper.md", markdown);
    fmt::print("{}", markdown);
}

int main_of(int argc, char** argv) {
    Settings settings;
    CLI::App app{"The paper's tables: writes paper.json and paper.md."};
    app.add_option("TABLE", settings.tables, "table2, table3; none: both")
        ->check(CLI::IsMember({"table2", "table3"}));
    app.add_option("--folder", settings.folder, "where to write")->capture_default_str();
    app.add_option("--runs", settings.runs, "paired runs")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    app.add_option("--resolution", settings.resolution, "of table 3")->capture_default_str();
    app.add_option("--spp", settings.spp, "of table 3")->capture_default_str();
    app.add_option("--positions", settings.positions, "of table 3")
        ->check(CLI::Range(10, 100))
        ->capture_default_str();
    app.add_option("--reference-spp", settings.reference_spp, "of table 3")->capture_default_str();
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& problem) {
        return app.exit(problem) == 0 ? 0 : int(ExitStatus::bad_input);
    }
    return run_program("estara-paper", [&] { run(settings); });
}

}  // namespace
}  // namespace estara::bench

int main(int argc, char** argv) { return estara::bench::main_of(argc, argv); }
