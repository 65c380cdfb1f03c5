#include "estara/render/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "estara/render/reuse_cache.h"
#include "estara/scenes/command_line.h"

namespace estara {
namespace {

constexpr const char* examples = R"(Examples:
  estara-render bunny.obj --grids bunny.vdb -o 'frames/####.png'
  estara-render room.glb --grids wood.vdb --grids stone.vdb --frames 1-100x5 --spp 16
      -o 'frames/####.exr' --aov N --compare direct --report comparison.html)";

/// The words of the command line that need more than a conversion.
struct Words {
    std::vector<std::string> outputs, params, aovs;
    std::string frames, resolution, ambient, compare;
    std::string cache_memory, cache_light = "auto";
    std::string strategy = to_string(Options{}.strategy);
    std::string progress = "auto";
};

Strategy parse_strategy(const std::string& word) {
    for (const Strategy strategy :
         {Strategy::automatic, Strategy::grid, Strategy::cache, Strategy::direct}) {
        if (word == to_string(strategy)) return strategy;
    }
    throw Error(fmt::format("--strategy: no '{}'; there are: auto, grid, cache, direct", word));
}

std::optional<bool> parse_cache_light(const std::string& word) {
    if (word == "auto") return std::nullopt;
    if (word == "on") return true;
    if (word == "off") return false;
    throw Error(fmt::format("--cache-light: no '{}'; there are: auto, on, off", word));
}

void check_ranges(const Options& options) {
    if (options.frame.spp < 1 || options.frame.spp > 65536) {
        throw Error(fmt::format("--spp {}: must be from 1 to 65536", options.frame.spp));
    }
    if (options.fps && !(*options.fps > 0.0 && std::isfinite(*options.fps))) {
        throw Error(fmt::format("--fps {}: must be above 0", *options.fps));
    }
    if (!(std::abs(options.frame.exposure) <= 100.0f)) {
        throw Error(fmt::format("--exposure {}: must be from -100 to 100", options.frame.exposure));
    }
    if (options.window < 1 || options.window > ReuseCache::longest_window) {
        throw Error(fmt::format("--window {}: must be from 1 to {}", options.window,
                                ReuseCache::longest_window));
    }
    if (options.threads < 0 || options.threads > 4096) {
        throw Error(fmt::format("--threads {}: must be from 0 to 4096", options.threads));
    }
    if (!options.params.empty() && options.shader.empty()) {
        throw Error(
            "--param NAME=VALUE needs --shader; of the shaders in the scene it is --param "
            "SHADER.NAME=VALUE");
    }
}

void check_names(const Options& options) {
    if (!options.sheet.empty() && !options.sheet.ends_with(".png")) {
        throw Error(fmt::format("--sheet {}: is written as .png; give the name that ending",
                                options.sheet));
    }
    std::set<std::string> names;
    for (const FilePattern& output : options.outputs) {
        if (!names.insert(output.text()).second) {
            throw Error(fmt::format("-o {}: given twice", output.text()));
        }
    }
    std::vector<std::pair<std::string, std::string>> files{{"SCENE", options.scene},
                                                           {"--stats", options.stats},
                                                           {"--report", options.report},
                                                           {"--sheet", options.sheet}};
    for (const std::string& grid : options.grids) files.emplace_back("--grids", grid);
    const int frame = options.frames ? options.frames->first : 1;
    for (const FilePattern& output : options.outputs) files.emplace_back("-o", output.path(frame));
    refuse_same_file(files);
    const bool has_exr =
        std::any_of(options.outputs.begin(), options.outputs.end(),
                    [](const FilePattern& o) { return o.format() == ImageFormat::exr; });
    if (options.frame.aovs.any() && !has_exr) {
        throw Error("--aov needs an .exr output: PNG holds the colour only");
    }
}

/// A shell's g/*.vdb are many words, and the scene may come behind them.
void take_scene_from_grids(Options& options) {
    const auto is_scene = [](const std::string& word) {
        return word.ends_with(".glb") || word.ends_with(".gltf") || word.ends_with(".obj") ||
               word.ends_with(".ply");
    };
    const auto found = std::find_if(options.grids.begin(), options.grids.end(), is_scene);
    if (options.scene.empty() && found != options.grids.end()) {
        options.scene = *found;
        options.grids.erase(found);
    }
    if (options.scene.empty()) throw Error("SCENE is required; --help lists the options");
}

void interpret(const Words& words, Options& options) {
    take_scene_from_grids(options);
    for (const std::string& text : words.outputs) options.outputs.emplace_back(text);
    for (const std::string& text : words.params) {
        Setting setting = parse_setting(text);
        const bool of_shader = setting.name.find('.') != std::string::npos;
        (of_shader ? options.scene_params : options.params).push_back(std::move(setting));
    }
    for (const std::string& name : words.aovs) add_aov(options.frame.aovs, name);
    options.strategy = parse_strategy(words.strategy);
    if (!words.frames.empty()) options.frames = parse_frames(words.frames);
    const glm::ivec2 resolution = parse_resolution(words.resolution);
    options.frame.width = resolution.x;
    options.frame.height = resolution.y;
    if (!words.ambient.empty()) {
        options.ambient = naming("--ambient", [&] { return parse_color(words.ambient); });
        if (glm::any(glm::lessThan(*options.ambient, glm::vec3(0.0f)))) {
            throw Error(fmt::format("--ambient {}: must not be negative", words.ambient));
        }
    }
    if (!words.compare.empty() && words.compare != "direct") {
        throw Error(fmt::format("--compare: no '{}'; there is: direct", words.compare));
    }
    options.compare_direct = !words.compare.empty();
    if (options.compare_direct && options.strategy == Strategy::direct) {
        throw Error("--compare direct needs another strategy than direct to compare it with");
    }
    if (!words.cache_memory.empty()) {
        options.cache_memory =
            naming("--cache-memory", [&] { return parse_size(words.cache_memory); });
    }
    options.cache_light = parse_cache_light(words.cache_light);
    options.progress = options.quiet ? ProgressStyle::none : parse_progress(words.progress);
    check_ranges(options);
    check_names(options);
}

void add_input(CLI::App& app, Options& options, Words& words) {
    app.add_option("SCENE", options.scene, "glTF, OBJ or PLY file");
    app.add_option("--grids", options.grids,
                   "what estara-bake wrote: files, or a folder of them; may be repeated")
        ->type_name("FILE.vdb|FOLDER...")
        ->group("Input");
    app.add_option("--camera", options.camera, "camera by name (default: the scene's first)")
        ->type_name("NAME")
        ->group("Input");
    app.add_option("--frames", words.frames, "frames to render (default: the scene's animation)")
        ->type_name("A-B[xSTEP],...")
        ->group("Input");
    app.add_option("--fps", options.fps,
                   "frames a second of the animation (default: the scene's, else 24)")
        ->type_name("N")
        ->group("Input");
    app.add_option("--shader", options.shader,
                   "what objects wear that wear no shader in the scene (default: what their grid "
                   "was baked with, else plastic)")
        ->type_name("NAME")
        ->group("Input");
    app.add_flag("--allow-outside", options.allow_outside,
                 "read files that the scene names outside of its folder")
        ->group("Input");
    app.add_option("--param", words.params,
                   "parameter of --shader, or of all objects that wear SHADER; may be repeated")
        ->type_name("[SHADER.]NAME=VALUE")
        ->allow_extra_args(false)
        ->group("Input");
}

void add_output(CLI::App& app, Options& options, Words& words) {
    app.add_option("-o,--output", words.outputs,
                   "images, .exr or .png; #### or %04d is the frame's number; may be repeated")
        ->type_name("FILE")
        ->required()
        ->allow_extra_args(false)
        ->group("Output");
    app.add_option(
           "--aov", words.aovs,
           "beside the colour in .exr files: albedo, N, P, depth, or of the cache hit, age, "
           "occluded; may be repeated")
        ->type_name("NAME")
        ->allow_extra_args(false)
        ->group("Output");
    app.add_flag("--resume", options.resume,
                 "skip frames whose images are all there and were rendered with these settings")
        ->group("Output");
    app.add_option("--sheet", options.sheet, "write all frames small on one page")
        ->type_name("FILE.png")
        ->group("Output");
    app.add_option("--report", options.report, "write a page of times and errors")
        ->type_name("FILE.html")
        ->group("Output");
    app.add_option("--stats", options.stats, "write the same and more for programs")
        ->type_name("FILE.json")
        ->group("Output");
}

void add_picture(CLI::App& app, Options& options, Words& words) {
    app.add_option("--resolution", words.resolution, "image size in pixels")
        ->type_name("WxH")
        ->capture_default_str()
        ->group("Picture");
    app.add_option("--spp", options.frame.spp, "samples a pixel; 1 is the pixel's centre")
        ->type_name("N")
        ->capture_default_str()
        ->group("Picture");
    app.add_option("--exposure", options.frame.exposure, "colours times 2^EV")
        ->type_name("EV")
        ->capture_default_str()
        ->group("Picture");
    app.add_option("--ambient", words.ambient, "ambient light (default: the scene's)")
        ->type_name("R,G,B")
        ->group("Picture");
    app.add_flag_callback(
           "--no-shadows", [&] { options.frame.shadows = false; }, "nothing casts a shadow")
        ->group("Picture");
    app.add_option("--seed", options.frame.seed, "shifts the samples inside the pixels")
        ->type_name("N")
        ->capture_default_str()
        ->group("Picture");
}

void add_work(CLI::App& app, Options& options, Words& words) {
    app.add_option(
           "--strategy", words.strategy,
           "auto: whichever is fastest, by measurement, object by object; grid: baked where "
           "there is a grid, else direct; cache: hit points serve several frames; direct: "
           "evaluate everything in every frame")
        ->type_name("NAME")
        ->capture_default_str()
        ->group("Work");
    app.add_option("--compare", words.compare,
                   "render each frame directly too; print error and times")
        ->type_name("direct")
        ->group("Work");
    app.add_option("--cache-memory", words.cache_memory,
                   fmt::format("memory for hit points, as 2G or 512M (default: {})",
                               format_bytes(options.cache_memory)))
        ->type_name("SIZE")
        ->group("Work");
    app.add_option(
           "--window", options.window,
           "frames that a hit point may serve; windows begin at frames 1, 1 + N, 1 + 2N, ...")
        ->type_name("N")
        ->capture_default_str()
        ->group("Work");
    app.add_option("--cache-light", words.cache_light,
                   "whether the cache keeps diffuse light and shadows too: on, off, or auto: if "
                   "only cameras move")
        ->type_name("WHEN")
        ->capture_default_str()
        ->group("Work");
    app.add_flag_callback(
           "--cache-test-all", [&] { options.frame.test_all_points = true; },
           "test every recalled hit point for occlusion, not a share of each "
           "pixel's and those beside a hidden one")
        ->group("Work");
    app.add_option("--threads", options.threads, "0: one for each core")
        ->type_name("N")
        ->capture_default_str()
        ->group("Work");
    app.add_flag("--quiet", options.quiet, "print errors alone")->group("Work");
    app.add_option("--progress", words.progress,
                   "auto: a bar on a terminal, lines elsewhere; plain: lines; none")
        ->type_name("STYLE")
        ->capture_default_str()
        ->group("Work");
}

}  // namespace

const char* to_string(Strategy strategy) noexcept {
    switch (strategy) {
        case Strategy::automatic:
            return "auto";
        case Strategy::grid:
            return "grid";
        case Strategy::cache:
            return "cache";
        case Strategy::direct:
            break;
    }
    return "direct";
}

Options parse_options(int argc, const char* const* argv, std::string& help) {
    Options options;
    Words words;
    words.resolution = fmt::format("{}x{}", options.frame.width, options.frame.height);
    CLI::App app("Renders an animation with baked or directly evaluated shaders.", "estara-render");
    app.set_version_flag("--version", fmt::format("estara-render {}", version));
    app.footer(examples);
    add_input(app, options, words);
    add_output(app, options, words);
    add_picture(app, options, words);
    add_work(app, options, words);
    help = parse_command_line(app, argc, argv);
    if (help.empty()) interpret(words, options);
    return options;
}

FrameRange frames_of(const Options& options, const Scene& scene) {
    return options.frames ? *options.frames : animated_frames(scene, *options.fps);
}

int window_of(const Options& options, int frame) noexcept {
    const int from_first = frame - 1;
    return (from_first >= 0 ? from_first : from_first - options.window + 1) / options.window;
}

void check_outputs(const Options& options, const FrameRange& frames) {
    for (const FilePattern& output : options.outputs) {
        if (frames.count() > 1 && !output.is_numbered()) {
            throw Error(
                fmt::format("-o {}: {} frames need a number in the name, as in "
                            "frames/####.exr or frames/%04d.exr",
                            output.text(), frames.count()));
        }
    }
}

}  // namespace estara
