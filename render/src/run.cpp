#include "estara/render/run.h"
#include "estara/render/image_file.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <thread>

#include "estara/render/image_queue.h"
#include "estara/render/report.h"
#include "estara/render/settings.h"
#include "estara/render/sheet.h"
#include "estara/scenes/load.h"
#include "estara/scenes/program.h"

namespace estara {
namespace {

std::string counted(std::uint64_t n, const char* one, const char* many) {
    return fmt::format("{} {}", n, n == 1 ? one : many);
}

/// Why the images of a frame cannot stay, or "" if all are there with the settings that are asked
/// for.
std::string why_not_finished(const Options& options, const std::string& settings, int frame) {
    for (const FilePattern& output : options.outputs) {
        std::error_code code;
        const std::string file = output.path(frame);
        if (!std::filesystem::exists(file, code)) return "missing";
        const std::optional<std::string> was = image_settings(file);
        if (!was) return "another program's, or damaged";
        const std::string difference = first_difference(*was, settings);
        if (!difference.empty()) return difference;
    }
    return "";
}

/// With --resume, those that are not finished; of a strategy that may use the cache whole windows,
/// because a frame's hit points are those of the frames before it.
std::vector<int> frames_to_render(const Options& options, const FrameRange& range,
                                  const std::string& settings, const Say& say) {
    const bool may_cache =
        options.strategy == Strategy::cache || options.strategy == Strategy::automatic;
    std::vector<int> missing;
    std::map<std::string, int> again;  // frames by the reason why they are rendered again
    for (int i = 0; i < range.count(); ++i) {
        const std::string why =
            options.resume ? why_not_finished(options, settings, range.at(i)) : "missing";
        if (why.empty()) continue;
        missing.push_back(range.at(i));
        if (why != "missing") ++again[why];
    }
    for (const auto& [why, count] : again) {
        say(fmt::format("--resume: {} rendered again: {}", counted(count, "frame is", "frames are"),
                        why));
    }
    if (!options.resume || !may_cache) return missing;
    std::vector<int> frames;
    for (int i = 0; i < range.count(); ++i) {
        const int window = window_of(options, range.at(i));
        if (std::any_of(missing.begin(), missing.end(),
                        [&](int m) { return window_of(options, m) == window; })) {
            frames.push_back(range.at(i));
        }
    }
    return frames;
}

/// Fails before the work instead of after it if nothing can be written where it is wanted.
void check_folders(const Options& options, int frame) {
    for (const FilePattern& output : options.outputs) const PendingFile probe(output.path(frame));
    if (!options.stats.empty()) const PendingFile probe(options.stats);
    if (!options.report.empty()) const PendingFile probe(options.report);
    if (!options.sheet.empty()) const PendingFile probe(options.sheet);
}

void warn_of_frames(const RunRecord& record, const Say& say) {
    if (record.frames.empty()) return;
    const Summary all = summary(record);
    if (all.bad_pixels > 0) {
        say(fmt::format("warning: {} not a finite number, written as 0",
                        counted(all.bad_pixels, "pixel is", "pixels are")));
    }
    if (all.misses > 0) {
        say(fmt::format("warning: {} of {} found nothing in their grid and were evaluated directly",
                        counted(all.misses, "sample", "samples"), all.lookups));
    }
}

/// Renders the frames one after the other while finished ones are written.
class Animation {
public:
    Animation(const Options& options, const Scene& scene, RayScene& rays, const Wardrobe& wardrobe,
              int camera, std::string settings)
        : m_options(options),
          m_settings(std::move(settings)),
          m_wardrobe(wardrobe),
          m_camera(camera),
          m_renderer(scene, rays, options.frame),
          m_cache(make_cache(scene, options, wardrobe.chosen)) {}

    std::vector<FrameRecord> render(const std::vector<int>& frames) {
        std::vector<FrameRecord> records;
        if (frames.empty()) return records;
        const std::uint64_t passes = m_options.compare_direct ? 2 : 1;
        Progress progress(m_options.progress, "rendering",
                          frames.size() * passes * std::uint64_t(m_renderer.tile_count()));
        ImageQueue queue;
        for (const int frame : frames) {
            if (m_options.compare_direct) queue.finish();  // times are compared: nothing else runs
            Film film =
                queue.film(m_options.frame.width, m_options.frame.height, m_options.frame.aovs);
            records.push_back(render_frame(frame, film, [&] { progress.advance(1); }));
            film.settings = m_settings;
            queue.push(std::move(film), frame, m_options.outputs);
        }
        queue.finish();
        return records;
    }

private:
    FrameRecord render_frame(int frame, Film& film, const std::function<void()>& tile_done) {
        const double time = frame / *m_options.fps;
        FrameRecord record{frame, {}, {}, {}, {}};
        for (const FilePattern& output : m_options.outputs) {
            record.files.push_back(output.path(frame));
        }
        if (m_cache && (!m_window || *m_window != window_of(m_options, frame))) m_cache->clear();
        m_window = window_of(m_options, frame);
        record.cost =
            m_renderer.render(m_wardrobe.chosen, m_camera, time, film, tile_done, m_cache.get());
        if (m_options.compare_direct) {
            Film reference(m_options.frame.width, m_options.frame.height, m_options.frame.aovs);
            record.direct =
                m_renderer.render(m_wardrobe.direct, m_camera, time, reference, tile_done);
            record.error = compare_films(film, reference);
        }
        return record;
    }

    const Options& m_options;
    std::string m_settings;
    const Wardrobe& m_wardrobe;
    int m_camera;
    FrameRenderer m_renderer;
    std::unique_ptr<ReuseCache> m_cache;  ///< null: nothing is cached
    std::optional<int> m_window;          ///< of the last frame
};

}  // namespace

RunRecord run(const Options& options, const Say& say) {
    const Stopwatch whole;
    Scene scene = load_scene(options.scene, options.allow_outside);
    const double loading = whole.seconds();
    RunRecord record = run(options, std::move(scene), say);
    record.seconds += loading;
    return record;
}

RunRecord run(const Options& given, Scene scene, const Say& say) {
    const Stopwatch whole;
    Options options = given;
    options.fps = frame_rate(scene, given.fps);
    set_parameters(scene, options.scene_params);
    const std::size_t threads = options.threads > 0
                                    ? std::size_t(options.threads)
                                    : std::max<std::size_t>(1, std::thread::hardware_concurrency());
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);

    for (const std::string& warning : scene.warnings) say("warning: " + warning);
    if (options.ambient) scene.ambient = *options.ambient;
    RunRecord record;
    record.options = options;
    record.range = frames_of(options, scene);
    check_outputs(options, record.range);
    const int camera = find_camera(scene, options.camera);
    check_folders(options, record.range.first);
    const std::string settings = settings_text(options, scene, camera);
    const std::vector<int> frames = frames_to_render(options, record.range, settings, say);
    record.skipped = record.range.count() - int(frames.size());

    if (!frames.empty()) {
        RayScene rays(scene);
        const Wardrobe wardrobe = dress(scene, rays, options, camera, record.range, say);
        record.objects = wardrobe.records;
        record.frames = Animation(options, scene, rays, wardrobe, camera, settings).render(frames);
    }
    record.seconds = whole.seconds();
    warn_of_frames(record, say);
    if (!options.stats.empty()) write_text(options.stats, json_text(record));
    if (!options.sheet.empty()) {
        ContactSheet sheet(record.range.count(), options.frame.width, options.frame.height);
        for (int i = 0; i < record.range.count(); ++i) {
            sheet.add(record.range.at(i), options.outputs.front().path(record.range.at(i)));
        }
        sheet.write(options.sheet);
    }
    if (!options.report.empty()) write_text(options.report, html_text(record, options.report));
    return record;
}

}  // namespace estara
