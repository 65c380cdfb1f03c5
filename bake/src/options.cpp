#include "estara/bake/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "estara/scenes/command_line.h"

namespace estara::bake {
namespace {

constexpr const char* examples = R"(Examples:
  estara-bake still-life.glb -o grids
  estara-bake wood still-life.glb -o wood.vdb
  estara-bake greenmarble bunny.obj -o bunny.vdb --param veinfreq=20 --max-error 0.005)";

/// The words of the command line that need more than a conversion.
struct Words {
    std::vector<std::string> params;
    std::string frames, resolution, max_memory;
    std::string compression = "zip", progress = "auto";
    double voxel_size = 0.0, max_error = 0.0, irradiance_voxel_size = 0.0;
    std::int64_t seed = 0;  // signed: "-1" would become a large number
};

Compression parse_compression(const std::string& word) {
    if (word == "zip") return Compression::zip;
    if (word == "blosc") return Compression::blosc;
    if (word == "none") return Compression::none;
    throw Error(fmt::format("--compression: no '{}'; there are: zip, blosc, none", word));
}

void check(const Options& options) {
    if (options.list_shaders || !options.describe.empty()) return;
    if (options.scene.empty()) {
        throw Error(
            "give a shader and a scene: estara-bake SHADER SCENE -o FILE.vdb, or a scene alone: "
            "estara-bake SCENE -o FOLDER; --help explains");
    }
    if (options.output.empty() && !options.dry_run) {
        throw Error(
            options.shader.empty()
                ? "where to? give -o FOLDER (or --dry-run to see what a bake would cost)"
                : "where to? give -o FILE.vdb (or --dry-run to see what a bake would cost)");
    }
    if (options.shader.empty() && options.output.ends_with(".vdb")) {
        throw Error(fmt::format(
            "-o {}: a scene is baked into a folder, a file for each shader; one shader alone: "
            "estara-bake SHADER {} -o {}",
            options.output, options.scene, options.output));
    }
    if (!options.shader.empty() && !options.output.empty() && !options.output.ends_with(".vdb")) {
        throw Error(fmt::format("{}: grids are written as .vdb; give the name that ending",
                                options.output));
    }
    if (options.voxel_size && options.max_error) {
        throw Error(
            "--voxel-size and --max-error exclude each other: one sets the voxel, the other finds "
            "it");
    }
    if (options.voxel_size && !(*options.voxel_size > 0.0 && std::isfinite(*options.voxel_size))) {
        throw Error(fmt::format("--voxel-size {}: must be above 0", *options.voxel_size));
    }
    if (options.max_error && !(*options.max_error > 0.0 && std::isfinite(*options.max_error))) {
        throw Error(fmt::format("--max-error {}: must be above 0", *options.max_error));
    }
    if (!(options.irradiance_error > 0.0) || !std::isfinite(options.irradiance_error)) {
        throw Error(
            fmt::format("--irradiance-error {}: must be above 0", options.irradiance_error));
    }
    const std::optional<double>& light = options.irradiance_voxel_size;
    if (light && !(*light > 0.0 && std::isfinite(*light))) {
        throw Error(fmt::format("--irradiance-voxel-size {}: must be above 0", *light));
    }
    if (light && !options.irradiance) {
        throw Error("--irradiance-voxel-size is of --irradiance, which is not given");
    }
    refuse_same_file(
        {{"SCENE", options.scene}, {"-o", options.output}, {"--stats", options.stats}});
    if (options.fps && !(*options.fps > 0.0 && std::isfinite(*options.fps))) {
        throw Error(fmt::format("--fps {}: must be above 0", *options.fps));
    }
    if (options.threads < 0 || options.threads > 4096) {
        throw Error(fmt::format("--threads {}: must be from 0 to 4096", options.threads));
    }
}

/// One word alone is the scene, and all that it needs is baked.
void take_scene(Options& options) {
    if (options.shader.empty() || !options.scene.empty()) return;
    if (find_shader(options.shader) != nullptr && !std::filesystem::exists(options.shader)) return;
    options.scene = std::exchange(options.shader, "");
}

/// --param wood.ringscale=4 is for all objects of a scene that wear wood; of the shader that is
/// baked it is --param ringscale=4.
void take_params(const Words& words, Options& options) {
    for (const std::string& text : words.params) {
        Setting setting = parse_setting(text);
        const std::size_t dot = setting.name.find('.');
        if (options.shader.empty()) {
            if (dot == std::string::npos) {
                throw Error(fmt::format("--param {}: of which shader? Write --param SHADER.{}",
                                        setting.name, text));
            }
        } else if (dot != std::string::npos) {
            const std::string shader = setting.name.substr(0, dot);
            if (shader != options.shader) {
                throw Error(fmt::format("--param {}: {} is baked, not {}", setting.name,
                                        options.shader, shader));
            }
            setting.name.erase(0, dot + 1);
        }
        options.params.push_back(std::move(setting));
    }
}

void interpret(const CLI::App& app, const Words& words, Options& options) {
    take_scene(options);
    take_params(words, options);
    if (app.count("--voxel-size") > 0) options.voxel_size = words.voxel_size;
    if (app.count("--max-error") > 0) options.max_error = words.max_error;
    if (!words.frames.empty()) options.frames = parse_frames(words.frames);
    options.resolution = parse_resolution(words.resolution);
    options.max_memory = physical_memory() / 2;
    if (!words.max_memory.empty()) {
        options.max_memory = naming("--max-memory", [&] { return parse_size(words.max_memory); });
    }
    options.file.compression = parse_compression(words.compression);
    options.progress = options.quiet ? ProgressStyle::none : parse_progress(words.progress);
    if (words.seed < 0) throw Error(fmt::format("--seed {}: must be 0 or above", words.seed));
    options.seed = std::uint64_t(words.seed);
    if (app.count("--irradiance-voxel-size") > 0) {
        options.irradiance_voxel_size = words.irradiance_voxel_size;
    }
    check(options);
}

void add_what(CLI::App& app, Options& options, Words& words) {
    app.add_option("SHADER", options.shader,
                   "one of --list-shaders; left out: all that the scene's objects wear");
    app.add_option("SCENE", options.scene, "glTF, OBJ or PLY file");
    app.add_flag("--allow-outside", options.allow_outside,
                 "read files that the scene names outside of its folder")
        ->group("Objects");
    app.add_flag("--list-shaders", options.list_shaders, "all shaders with their parameters")
        ->group("Shaders");
    app.add_flag("--markdown", options.markdown, "--list-shaders as a table for a README")
        ->group("Shaders");
    app.add_option("--describe", options.describe, "one shader with its parameters")
        ->type_name("SHADER")
        ->group("Shaders");
    app.add_option("--param", words.params, "parameter, over what the scene says; may be repeated")
        ->type_name("[SHADER.]NAME=VALUE")
        ->allow_extra_args(false)
        ->group("Shaders");
    app.add_option(
           "--object", options.objects,
           "objects to bake, with * and ?; may be repeated (default: those that wear the shader, "
           "or all if none wears any)")
        ->type_name("GLOB")
        ->allow_extra_args(false)
        ->group("Objects");
}

void add_resolution(CLI::App& app, Options& options, Words& words) {
    app.add_option("--voxel-size", words.voxel_size,
                   "edge of a voxel, object space (default: half the smallest pixel footprint over "
                   "the frames)")
        ->type_name("H")
        ->group("Resolution");
    app.add_option("--max-error", words.max_error,
                   "find the largest voxel with an RMSE of at most E")
        ->type_name("E")
        ->group("Resolution");
    app.add_option("--frames", words.frames,
                   "frames of the camera path (default: the scene's animation)")
        ->type_name("A-B[xSTEP],...")
        ->group("Resolution");
    app.add_option("--fps", options.fps,
                   "frames a second of the animation (default: the scene's, else 24)")
        ->type_name("N")
        ->group("Resolution");
    app.add_option("--resolution", words.resolution, "image size that will be rendered")
        ->type_name("WxH")
        ->capture_default_str()
        ->group("Resolution");
    app.add_option("--camera", options.camera, "camera by name (default: the scene's first)")
        ->type_name("NAME")
        ->group("Resolution");
}

void add_light(CLI::App& app, Options& options, Words& words) {
    app.add_flag("--irradiance", options.irradiance,
                 "bake the light of lights that stand still too, shadows included")
        ->group("Light");
    app.add_option("--irradiance-error", options.irradiance_error,
                   "where a lookup of the light is off by more, rays are traced instead")
        ->type_name("E")
        ->capture_default_str()
        ->group("Light");
    app.add_option("--irradiance-voxel-size", words.irradiance_voxel_size,
                   "edge of its voxels, object space (default: halved until a twentieth of the "
                   "surface is left to rays)")
        ->type_name("H")
        ->group("Light");
}

void add_file(CLI::App& app, Options& options, Words& words) {
    app.add_option("-o,--output", options.output,
                   "file to write; without SHADER a folder, with a file for each shader")
        ->type_name("FILE.vdb|FOLDER")
        ->group("File");
    app.add_option("--compression", words.compression, "zip, blosc or none")
        ->type_name("NAME")
        ->capture_default_str()
        ->group("File");
    app.add_flag("--half", options.file.half,
                 "values as half floats: half the size, error up to 2^-12 more")
        ->group("File");
    app.add_option("--stats", options.stats, "write what was done and measured for programs")
        ->type_name("FILE.json")
        ->group("File");
}

void add_work(CLI::App& app, Options& options, Words& words) {
    app.add_flag("--dry-run", options.dry_run, "only say what the bake would cost")->group("Work");
    app.add_option("--max-memory", words.max_memory,
                   "limit, as 2G or 512M (default: half of the machine's)")
        ->type_name("SIZE")
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
    app.add_option("--seed", words.seed, "of the points where the error is measured")
        ->type_name("N")
        ->capture_default_str()
        ->group("Work");
}

}  // namespace

Options parse_options(int argc, const char* const* argv, std::string& help) {
    Options options;
    Words words;
    words.resolution = fmt::format("{}x{}", options.resolution.x, options.resolution.y);
    CLI::App app("Bakes a procedural shader into sparse OpenVDB grids around object surfaces.",
                 "estara-bake");
    app.set_version_flag("--version", fmt::format("estara-bake {}", version));
    app.footer(examples);
    add_what(app, options, words);
    add_resolution(app, options, words);
    add_light(app, options, words);
    add_file(app, options, words);
    add_work(app, options, words);
    help = parse_command_line(app, argc, argv);
    if (help.empty()) interpret(app, words, options);
    return options;
}

}  // namespace estara::bake
