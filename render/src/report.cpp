#include "estara/render/report.h"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>

namespace estara {
namespace {

constexpr const char* style =
    "body{font:15px/1.4 sans-serif;margin:2em;max-width:75em}"
    "table{border-collapse:collapse;margin:1em 0}"
    "td,th{padding:.2em .7em;border-bottom:1px solid #ccc;text-align:right}"
    "td:first-child,th:first-child{text-align:left}img{max-width:15em;vertical-align:middle}";

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

/// A path as a link: what has a meaning in a URL becomes %XX.
std::string link_text(const std::string& path) {
    std::string out;
    for (const char c : path) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                           (c >= '0' && c <= '9') ||
                           std::string_view("/._-~").find(c) != std::string_view::npos;
        out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return out;
}

std::string row(std::initializer_list<std::string> cells, const char* tag = "td") {
    std::string out = "<tr>";
    for (const std::string& cell : cells) out += fmt::format("<{0}>{1}</{0}>", tag, cell);
    return out + "</tr>\n";
}

std::string settings_table(const RunRecord& run) {
    const Options& o = run.options;
    return "<table>\n" + row({"scene", escaped(o.scene)}) +
           row({"strategy", to_string(o.strategy)}) +
           row({"resolution", fmt::format("{} x {}", o.frame.width, o.frame.height)}) +
           row({"samples a pixel", fmt::format("{}", o.frame.spp)}) +
           row({"exposure", fmt::format("{} EV", o.frame.exposure)}) +
           row({"frames", fmt::format("{}-{}x{}, {} a second", run.range.first, run.range.last,
                                      run.range.step, *o.fps)}) +
           row({"threads", o.threads > 0 ? fmt::format("{}", o.threads) : "one a core"}) +
           "</table>\n";
}

std::string objects_table(const RunRecord& run) {
    std::string out = "<h2>Objects</h2>\n<table>\n";
    out += row({"object", "shader", "strategy", "filter width", "voxel", "levels", "grid"}, "th");
    for (const ObjectRecord& o : run.objects) {
        const bool grid = o.strategy == Strategy::grid;
        out += row({escaped(o.object), o.shader, to_string(o.strategy),
                    fmt::format("{:.4g}", o.filter_width),
                    grid ? fmt::format("{:.4g}", o.voxel_size) : "",
                    grid ? fmt::format("{}", o.levels) : "", escaped(o.grid_file)});
    }
    return out + "</table>\n";
}

std::string thumbnail(const FrameRecord& frame, const std::filesystem::path& folder) {
    for (const std::string& file : frame.files) {
        if (FilePattern(file).format() != ImageFormat::png) continue;
        const std::filesystem::path relative =
            std::filesystem::absolute(file).lexically_proximate(folder);
        return fmt::format("<img src=\"{}\" alt=\"frame {}\">", link_text(relative.string()),
                           frame.frame);
    }
    return "";
}

std::string frames_table(const RunRecord& run, const std::filesystem::path& folder) {
    std::string out = "<h2>Frames</h2>\n<table>\n";
    out += row({"frame", "seconds", "direct", "shading s", "direct", "RMSE", "p99.9", "max",
                "PSNR dB", "misses", "bad pixels", "image"},
               "th");
    for (const FrameRecord& f : run.frames) {
        const auto of_direct = [&](double FrameStatistics::*time) {
            return f.direct ? fmt::format("{:.4g}", (*f.direct).*time) : "";
        };
        const auto of_error = [&](double ImageError::*figure) {
            return f.error ? fmt::format("{:.3g}", (*f.error).*figure) : "";
        };
        out += row({fmt::format("{}", f.frame), fmt::format("{:.4g}", f.cost.seconds),
                    of_direct(&FrameStatistics::seconds),
                    fmt::format("{:.4g}", f.cost.evaluation_seconds),
                    of_direct(&FrameStatistics::evaluation_seconds), of_error(&ImageError::rmse),
                    of_error(&ImageError::p999), of_error(&ImageError::max),
                    of_error(&ImageError::psnr), fmt::format("{}", f.cost.misses),
                    fmt::format("{}", f.cost.bad_pixels), thumbnail(f, folder)});
    }
    return out + "</table>\n";
}

}  // namespace

std::string html_text(const RunRecord& run, const std::string& path) {
    const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
    std::string out = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
        "<title>estara-render: {0}</title><style>{1}</style></head><body>\n<h1>{0}</h1>\n<p>{2}",
        escaped(run.options.scene), style, escaped(result_line(run)));
    out += "<br>" + escaped(comparison_text(run)) + "</p>\n";
    out += settings_table(run) + objects_table(run) + frames_table(run, folder);
    return out + "</body></html>\n";
}

}  // namespace estara
