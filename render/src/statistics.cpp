#include "estara/render/statistics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "estara/scenes/program.h"

namespace estara {
namespace {

// Keys in the order they are written here.
using Json = nlohmann::ordered_json;

template <class Value>
std::vector<double> column(const RunRecord& run, Value value) {
    std::vector<double> values;
    for (const FrameRecord& frame : run.frames) values.push_back(value(frame));
    return values;
}

Json json_of(const glm::vec3& color) { return {color.x, color.y, color.z}; }

Json json_of(const Spread& s) { return {{"median", s.median}, {"min", s.min}, {"max", s.max}}; }

Json json_of(const ImageError& e) {
    return {{"rmse", e.rmse}, {"p99.9", e.p999}, {"max", e.max}, {"psnr", e.psnr}};
}

Json json_of(const ReuseCounts& r) {
    return {{"projection_seconds", r.projection_seconds},
            {"listing_seconds", r.listing_seconds},
            {"keeping_seconds", r.keeping_seconds},
            {"insertion_seconds", r.insertion_seconds},
            {"rays", r.rays},
            {"hits", r.hits},
            {"untested", r.untested},
            {"misses", r.misses},
            {"occluded", r.occluded},
            {"turned", r.turned},
            {"beside", r.beside},
            {"refilled", r.refilled},
            {"kept", r.kept},
            {"refused", r.refused},
            {"evicted", r.evicted},
            {"records", r.records},
            {"bytes", r.bytes},
            {"table_bytes", r.table_bytes}};
}

Json json_of(const FrameStatistics& s) {
    Json json{{"seconds", s.seconds},
              {"evaluation_seconds", s.evaluation_seconds},
              {"light_seconds", s.light_seconds},
              {"view_seconds", s.view_seconds},
              {"ray_seconds", s.ray_seconds},
              {"primary_rays", s.primary_rays},
              {"shadow_rays", s.shadow_rays},
              {"samples", s.samples},
              {"lookups", s.lookups},
              {"irradiance_lookups", s.irradiance_lookups},
              {"misses", s.misses},
              {"bad_pixels", s.bad_pixels},
              {"geometry_seconds", s.geometry_seconds},
              {"refits", s.refits},
              {"rebuilds", s.rebuilds}};
    if (s.reuse.table_bytes > 0) json["cache"] = json_of(s.reuse);
    return json;
}

Json json_of(const ObjectRecord& o) {
    Json json{{"object", o.object},
              {"shader", o.shader},
              {"params", o.params},
              {"strategy", to_string(o.strategy)},
              {"filter_width", o.filter_width}};
    if (o.strategy == Strategy::grid) {
        json["grid"] = o.grid_file;
        json["voxel_size"] = o.voxel_size;
        json["levels"] = o.levels;
        json["grid_bytes"] = o.grid_bytes;
    }
    if (o.choice && o.choice->samples > 0) {
        const StrategyChoice& c = *o.choice;
        json["measured"] = {{"vi_seconds", c.times.vi},
                            {"vd_seconds", c.times.vd},
                            {"cost_seconds", c.cost},
                            {"lookup_seconds", c.lookup},
                            {"save_seconds", c.times.save},
                            {"extract_seconds", c.times.extract},
                            {"frames_a_point_serves", c.frames},
                            {"predicted_speedup", c.speedup},
                            {"samples", c.samples}};
    }
    return json;
}

Json json_of(const FrameRecord& f) {
    Json json{{"frame", f.frame}, {"files", f.files}, {"cost", json_of(f.cost)}};
    if (f.direct) json["direct"] = json_of(*f.direct);
    if (f.error) json["error"] = json_of(*f.error);
    return json;
}

Json json_of(const Summary& s) {
    Json json{{"frame_seconds", json_of(s.frame)},
              {"evaluation_seconds", json_of(s.evaluation)},
              {"shading_seconds", json_of(s.shading)},
              {"lookups", s.lookups},
              {"misses", s.misses},
              {"bad_pixels", s.bad_pixels}};
    if (s.error) {
        json["direct_frame_seconds"] = json_of(*s.direct_frame);
        json["direct_evaluation_seconds"] = json_of(*s.direct_evaluation);
        json["direct_shading_seconds"] = json_of(*s.direct_shading);
        json["error"] = json_of(*s.error);
    }
    return json;
}

Json settings_json(const RunRecord& run) {
    const Options& o = run.options;
    Json outputs = Json::array();
    for (const FilePattern& output : o.outputs) outputs.push_back(output.text());
    Json json{{"scene", o.scene},
              {"outputs", outputs},
              {"grids", o.grids},
              {"strategy", to_string(o.strategy)},
              {"cache_memory", o.cache_memory},
              {"window", o.window},
              {"cache_light", o.cache_light ? Json(*o.cache_light) : Json("auto")},
              {"cache_test_all", o.frame.test_all_points},
              {"frames",
               {{"first", run.range.first}, {"last", run.range.last}, {"step", run.range.step}}},
              {"fps", *o.fps},
              {"width", o.frame.width},
              {"height", o.frame.height},
              {"spp", o.frame.spp},
              {"exposure", o.frame.exposure},
              {"shadows", o.frame.shadows},
              {"seed", o.frame.seed},
              {"camera", o.camera},
              {"threads", o.threads}};
    if (o.ambient) json["ambient"] = json_of(*o.ambient);
    return json;
}

/// How `ours` compares to `theirs`, both seconds, in words: a ratio below 1 is easily misread.
std::string pace(double theirs, double ours) {
    if (!(theirs > 0.0 && ours > 0.0)) return "not measured";
    if (ours > theirs) return fmt::format("slower: {:.2f} times the time", ours / theirs);
    return fmt::format("{:.2f} times as fast", theirs / ours);
}

std::string seconds(const Spread& s) {
    return fmt::format("{:.4g} s ({:.4g} to {:.4g})", s.median, s.min, s.max);
}

std::string error_text(const ImageError& e) {
    return fmt::format("RMSE {:.3g}, p99.9 {:.3g}, max {:.3g}, PSNR {:.1f} dB", e.rmse, e.p999,
                       e.max, e.psnr);
}

std::string output_names(const Options& options) {
    std::vector<std::string> names;
    for (const FilePattern& output : options.outputs) names.push_back(output.text());
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string counted(std::size_t n) { return fmt::format("{} frame{}", n, n == 1 ? "" : "s"); }

}  // namespace

Spread spread(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return {(values[(n - 1) / 2] + values[n / 2]) / 2.0, values.front(), values.back()};
}

namespace {

/// All but rays to the eye.
double shading_seconds(const FrameStatistics& s) {
    return s.evaluation_seconds + s.light_seconds + s.view_seconds + s.shadow_seconds +
           s.reuse.seconds();
}

/// What auto has promised for all objects together, or 0.
double predicted_speedup_of(const RunRecord& run) {
    double direct = 0.0, chosen = 0.0;
    for (const ObjectRecord& object : run.objects) {
        if (!object.choice) continue;
        const auto samples = double(object.choice->samples);
        direct += samples * object.choice->times.without_reuse();
        chosen += samples * object.choice->cost;
    }
    return chosen > 0.0 ? direct / chosen : 0.0;
}

}  // namespace

Summary summary(const RunRecord& run) {
    Summary s;
    s.shading = spread(column(run, [](const FrameRecord& f) { return shading_seconds(f.cost); }));
    s.frame = spread(column(run, [](const FrameRecord& f) { return f.cost.seconds; }));
    s.evaluation =
        spread(column(run, [](const FrameRecord& f) { return f.cost.evaluation_seconds; }));
    std::vector<ImageError> errors;
    for (const FrameRecord& f : run.frames) {
        s.misses += f.cost.misses;
        s.lookups += f.cost.lookups;
        s.bad_pixels += f.cost.bad_pixels;
        if (f.error) errors.push_back(*f.error);
    }
    if (errors.empty()) return s;
    s.error = pooled(errors);
    s.direct_frame = spread(column(run, [](const FrameRecord& f) { return f.direct->seconds; }));
    s.direct_shading =
        spread(column(run, [](const FrameRecord& f) { return shading_seconds(*f.direct); }));
    s.direct_evaluation =
        spread(column(run, [](const FrameRecord& f) { return f.direct->evaluation_seconds; }));
    return s;
}

std::string json_text(const RunRecord& run) {
    Json json{{"program", "estara-render"}, {"version", version}, {"settings", settings_json(run)}};
    json["objects"] = Json::array();
    for (const ObjectRecord& object : run.objects) json["objects"].push_back(json_of(object));
    json["frames"] = Json::array();
    for (const FrameRecord& frame : run.frames) json["frames"].push_back(json_of(frame));
    if (!run.frames.empty()) json["summary"] = json_of(summary(run));
    json["skipped_frames"] = run.skipped;
    json["seconds"] = run.seconds;
    json["peak_memory_bytes"] = peak_memory();
    // A name in a file may hold bytes that are no UTF-8.
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string comparison_text(const RunRecord& run) {
    if (run.frames.empty() || !run.frames.front().error) return "";
    const Summary s = summary(run);
    const char* strategy = to_string(run.options.strategy);
    const double predicted = predicted_speedup_of(run);
    const std::string promise =
        predicted > 0.0 ? fmt::format(", equations 3 and 4 predict {:.2f}", predicted) : "";
    return fmt::format(
        "against direct, {}: {} (p99.9 of the worst frame)\n"
        "whole frame: {} {}, direct {}, {}; "
        "view-independent shading: {} {}, direct {}, {}; "
        "all but rays to the eye: {}{}\n",
        counted(run.frames.size()), error_text(*s.error), strategy, seconds(s.frame),
        seconds(*s.direct_frame), pace(s.direct_frame->median, s.frame.median), strategy,
        seconds(s.evaluation), seconds(*s.direct_evaluation),
        pace(s.direct_evaluation->median, s.evaluation.median),
        pace(s.direct_shading->median, s.shading.median), promise);
}

std::string result_line(const RunRecord& run) {
    const std::string skipped =
        run.skipped > 0 ? fmt::format(", {} already there", counted(std::size_t(run.skipped))) : "";
    const std::string what =
        fmt::format("{} -> {}{}", counted(run.frames.size()), output_names(run.options), skipped);
    if (run.frames.empty()) return what;
    const Summary s = summary(run);
    const std::string error =
        s.error ? fmt::format("; against direct: {}", error_text(*s.error)) : "";
    return fmt::format("{}: median {:.3g} s a frame{}", what, s.frame.median, error);
}

}  // namespace estara
