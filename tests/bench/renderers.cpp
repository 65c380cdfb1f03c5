// The still life beside other renderers, Blender's Cycles and POV-Ray: the same geometry, camera,
// lights and number of samples, in one colour and in procedural patterns of as many noises.
// tests/README.md, "Benchmarks", tells what differs.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <sstream>

#include "../text_of.h"
#include "estara/render/compare.h"
#include "estara/scenes/program.h"
#include "rounds.h"
#include "rows.h"
#include "run_command.h"
#include "still_life.h"

namespace estara::bench {
namespace {

using Json = nlohmann::json;

constexpr int width = 1280, height = 720, spp = 16;
constexpr int round_count = 5;
constexpr float albedo = 0.8f;
/// RMSE of another renderer's picture over its mean: Cycles' noise of one light a sample is most.
constexpr double allowed_rmse_of_mean = 0.2;

/// What all renderers are given: everything in world space, at time 0.
struct Described {
    PinholePose camera;
    std::vector<PosedLight> lights;
    Mesh mesh;  ///< all instances
};

Described describe(const Scene& scene) {
    const Pose pose = pose_at(scene, 0.0);
    Described all{pinhole_pose(scene, scene.cameras.front(), pose), posed_lights(scene, pose), {}};
    for (const Instance& instance : scene.instances) {
        const glm::mat4& to_world = pose.world_from_node[std::size_t(instance.node)];
        const glm::mat3 turned = glm::transpose(glm::inverse(glm::mat3(to_world)));
        const Mesh& mesh = scene.objects[std::size_t(instance.object)].mesh;
        if (mesh.N.empty()) throw Error("renderers: " + scene.path + ": a mesh without normals");
        const auto first = glm::uint(all.mesh.P.size());
        for (const glm::vec3& P : mesh.P) all.mesh.P.emplace_back(to_world * glm::vec4(P, 1.0f));
        for (const glm::vec3& N : mesh.N) all.mesh.N.push_back(glm::normalize(turned * N));
        for (const glm::uvec3& t : mesh.triangles) all.mesh.triangles.push_back(t + first);
    }
    return all;
}

Json numbers(const glm::vec3& v) { return {v.x, v.y, v.z}; }

std::string obj(const Mesh& mesh) {
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    for (const glm::vec3& P : mesh.P) fmt::format_to(out, "v {} {} {}\n", P.x, P.y, P.z);
    for (const glm::vec3& N : mesh.N) fmt::format_to(out, "vn {} {} {}\n", N.x, N.y, N.z);
    for (const glm::uvec3& t : mesh.triangles) {
        fmt::format_to(out, "f {0}//{0} {1}//{1} {2}//{2}\n", t.x + 1, t.y + 1, t.z + 1);
    }
    return fmt::to_string(text);
}

std::string cycles_description(const Described& all, const std::string& obj_path, int threads) {
    Json lights = Json::array();
    for (const PosedLight& light : all.lights) {
        lights.push_back({{"spot", light.type == LightType::spot},
                          {"position", numbers(light.position)},
                          {"direction", numbers(light.direction)},
                          {"color", numbers(light.color)},
                          {"inner", std::acos(light.cos_inner)},
                          {"outer", std::acos(light.cos_outer)}});
    }
    const PinholePose& camera = all.camera;
    return Json{{"obj", obj_path},
                {"width", width},
                {"height", height},
                {"spp", spp},
                {"threads", threads},
                {"camera",
                 {{"eye", numbers(camera.eye)},
                  {"right", numbers(camera.right)},
                  {"up", numbers(camera.up)},
                  {"forward", numbers(camera.forward)},
                  {"yfov", 2.0f * std::atan(camera.tan_half_yfov)}}},
                {"lights", lights}}
        .dump();
}

std::string pov(const glm::vec3& v) { return fmt::format("<{}, {}, {}>", v.x, v.y, v.z); }

/// The scene language of POV-Ray 3.7.
/// @param pigment  what the surface is painted with
std::string pov_scene(const Described& all, const std::string& pigment) {
    constexpr float pi = std::numbers::pi_v<float>, degrees = 180.0f / pi;
    // Light falls as 2 / (1 + (distance / fade_distance)^2): near enough to the inverse square.
    constexpr float fade = 0.01f;
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    const PinholePose& camera = all.camera;
    const glm::vec3 up = 2.0f * camera.tan_half_yfov * camera.up,
                    right =
                        2.0f * camera.tan_half_yfov * float(width) / float(height) * camera.right;
    fmt::format_to(out,
                   "#version 3.7;\nglobal_settings {{ assumed_gamma 1 }}\n"
                   "camera {{ location {} right {} up {} direction {} }}\n",
                   pov(camera.eye), pov(right), pov(up), pov(camera.forward));
    for (const PosedLight& light : all.lights) {
        const std::string cone =
            light.type == LightType::spot
                ? fmt::format("spotlight radius {} falloff {} tightness 0 point_at {}",
                              degrees * std::acos(light.cos_inner),
                              degrees * std::acos(light.cos_outer),
                              pov(light.position + light.direction))
                : "";
        fmt::format_to(out, "light_source {{ {} rgb {} {} fade_distance {} fade_power 2 }}\n",
                       pov(light.position), pov(light.color / (2.0f * fade * fade * pi)), cone,
                       fade);
    }
    const auto list = [&](const char* name, std::size_t count, const auto& item) {
        fmt::format_to(out, "{} {{ {}", name, count);
        for (std::size_t i = 0; i < count; ++i) fmt::format_to(out, ",\n{}", item(i));
        fmt::format_to(out, " }}\n");
    };
    const Mesh& mesh = all.mesh;
    fmt::format_to(out, "mesh2 {{\n");
    list("vertex_vectors", mesh.P.size(), [&](std::size_t i) { return pov(mesh.P[i]); });
    list("normal_vectors", mesh.N.size(), [&](std::size_t i) { return pov(mesh.N[i]); });
    list("face_indices", mesh.triangles.size(),
         [&](std::size_t i) { return pov(mesh.triangles[i]); });
    fmt::format_to(out, "pigment {{ {} }}\nfinish {{ ambient 0 diffuse 1 }}\n}}\n", pigment);
    return fmt::to_string(text);
}

/// R, G and B of a picture, and the attribute of its header that names its time of rendering.
Film picture(const std::string& path, std::string* time = nullptr) {
    const auto input = OIIO::ImageInput::open(path);
    if (!input || input->spec().width != width || input->spec().height != height ||
        input->spec().nchannels < 3) {
        throw Error(fmt::format("{}: no picture of {}x{}", path, width, height),
                    ExitStatus::failed);
    }
    if (time) *time = input->spec().get_string_attribute("cycles.ViewLayer.render_time");
    Film film(width, height, {});
    if (!input->read_image(0, 0, 0, 3, OIIO::TypeFloat, film.color.data(), sizeof(glm::vec4))) {
        throw Error(path + ": " + input->geterror(), ExitStatus::failed);
    }
    return film;
}

/// "00:20.80" or "01:00:20.80" in seconds.
double seconds_of(const std::string& clock) {
    double seconds = 0.0, part = 0.0;
    std::istringstream text(clock);
    for (char colon; text >> part; text >> colon) seconds = 60.0 * seconds + part;
    if (!(seconds > 0.0)) throw Error("Cycles says no time: \"" + clock + "\"", ExitStatus::failed);
    return seconds;
}

/// RMSE over the mean of the reference.
double rmse_of_mean(const Film& film, const Film& reference) {
    double sum = 0.0;
    for (const glm::vec4& color : reference.color) sum += (color.r + color.g + color.b) / 3.0;
    return compare_films(film, reference).rmse * double(reference.color.size()) / sum;
}

enum Pattern { constant, procedural };

/// A renderer that is a program of its own: its seconds, and its last picture in a constant colour.
struct Peer {
    const char* name;
    std::array<const char*, 2> patterns;  ///< in words
    std::array<std::vector<Cost>, 2> costs{};
    Film film{width, height, {}};
};

/// What the program says goes into the log.
void run_and_log(const std::string& program, const std::string& arguments, const std::string& log) {
    if (!command_succeeds(fmt::format("{} {} > '{}' 2>&1", program, arguments, log))) {
        throw Error(fmt::format("{} failed; what it said is in {}", program, log),
                    ExitStatus::failed);
    }
}

class Cycles {
public:
    Cycles(const Described& all, std::filesystem::path folder, int threads)
        : m_folder(std::move(folder)) {
        const std::string path = m_folder / "still-life.obj";
        write_text(path, obj(all.mesh));
        write_text(m_folder / "cycles.json", cycles_description(all, path, threads));
    }

    void run(Peer& peer) const {
        const std::array<std::string, 2> names{"constant", "noise"};
        const auto path = [&](int i) {
            return (m_folder / ("cycles-" + names[i] + ".exr")).string();
        };
        run_and_log("blender",
                    fmt::format("--background --factory-startup --python-exit-code 1 --python '{}' "
                                "-- '{}' {} '{}' {} '{}'",
                                ESTARA_CYCLES, (m_folder / "cycles.json").string(), names[0],
                                path(0), names[1], path(1)),
                    m_folder / "cycles.txt");
        for (const Pattern pattern : {constant, procedural}) {
            std::string time;
            Film film = picture(path(pattern), &time);
            peer.costs[pattern].push_back({seconds_of(time), 0.0});
            if (pattern == constant) peer.film = std::move(film);
        }
    }

private:
    std::filesystem::path m_folder;
};

class PovRay {
public:
    PovRay(const Described& all, std::filesystem::path folder, int threads)
        : m_folder(std::move(folder)), m_threads(threads) {
        write_text(scene(constant), pov_scene(all, fmt::format("rgb {}", albedo)));
        // 6 octaves of a vector, 10 of a number: 28 noises.
        write_text(scene(procedural),
                   pov_scene(all,
                             "average pigment_map { [1 marble turbulence 0.5 octaves 6 scale 0.2]"
                             " [1 wrinkles scale 0.2] }"));
    }

    void run(Peer& peer) const {
        for (const Pattern pattern : {constant, procedural}) {
            const std::string says = m_folder / "povray.txt", out = m_folder / "povray.exr";
            run_and_log("povray",
                        fmt::format("'+I{}' '+O{}' +FE -D +W{} +H{} +WT{} +A0.0 +AM1 +R4 -J",
                                    scene(pattern), out, width, height, m_threads),
                        says);
            const std::string text = test::text_of(says);
            std::smatch time, samples;
            if (!std::regex_search(text, time,
                                   std::regex("Trace Time:.*\\(([0-9.]+) seconds\\)")) ||
                !std::regex_search(text, samples, std::regex("Samples: +([0-9]+)"))) {
                throw Error(says + ": no time, or no number of samples", ExitStatus::failed);
            }
            // It takes one sample more than were asked for.
            const double wanted = double(spp) * width * height;
            peer.costs[pattern].push_back(
                {std::stod(time[1]) * wanted / std::stod(samples[1]), 0.0});
            if (pattern == constant) peer.film = picture(out);
        }
    }

private:
    std::string scene(Pattern pattern) const {
        return m_folder / (pattern == constant ? "constant.pov" : "procedural.pov");
    }

    std::filesystem::path m_folder;
    int m_threads;
};

/// The still life in one shader.
struct Dressed {
    Dressed(const ShaderChoice& choice, const std::filesystem::path& folder)
        : scene(without_ambient(still_life_in(choice, folder))),
          rays(scene),
          renderer(scene, rays, settings()) {}

    /// The other renderers have nothing like it.
    static Scene without_ambient(Scene scene) {
        scene.ambient = glm::vec3(0.0f);
        return scene;
    }
    static FrameSettings settings() {
        FrameSettings settings;
        settings.width = width;
        settings.height = height;
        settings.spp = spp;
        return settings;
    }

    const Scene scene;
    RayScene rays;
    FrameRenderer renderer;
};

/// A way in which we render it, and its last picture.
struct Ours {
    const char* name;
    std::string what;
    Dressed& dressed;
    std::vector<ObjectShading> shading;
    std::vector<Cost> costs{};
    Film film{width, height, {}};

    double run() { return dressed.renderer.render(shading, 0, 0.0, film, {}).seconds; }
};

/// Another renderer's picture in one colour, beside ours.
std::string error_of(const Peer& peer, const Film& ours, Rows& rows) {
    const double rmse = rmse_of_mean(peer.film, ours);
    if (!(rmse <= allowed_rmse_of_mean)) {
        rows.disagree(
            fmt::format("renderers: RMSE from {}'s picture to ours is {} of its mean, above {}",
                        peer.name, rmse, allowed_rmse_of_mean));
    }
    return fmt::format("rmse {:.2g} of the mean", rmse);
}

/// One of our pictures beside the one that is evaluated.
std::string error_of(const Ours& way, const Ours& evaluated, Rows& rows) {
    if (&way == &evaluated) return "exact";
    const double rmse = compare_films(way.film, evaluated.film).rmse;
    if (!(rmse <= allowed_rmse)) {
        rows.disagree(fmt::format("renderers: RMSE {} from {} to direct, above {}", rmse, way.what,
                                  allowed_rmse));
    }
    return fmt::format("rmse {:.2g} to direct", rmse);
}

}  // namespace

void renderers(Bench& bench) {
    for (const char* program : {"blender", "povray"}) {
        if (!command_succeeds(fmt::format("command -v {} >/dev/null 2>&1", program))) {
            return bench.rows.missing(
                fmt::format("renderers: there is no {0}: install Debian's package {0}, or ./run "
                            "bench renderers",
                            program));
        }
    }
    const int threads = tbb::this_task_arena::max_concurrency();
    Dressed plain({"plastic",
                   {{"Cs", {albedo, albedo, albedo}}, {"Kd", {1.0f}}, {"Ks", {0.0f}}},
                   "benchmark"},
                  bench.folder);
    Dressed marble({"greenmarble", {}, "benchmark"}, bench.folder);
    const std::vector<ObjectShading> grids = baked(marble.scene, marble.rays, width, height),
                                     lit = with_light(grids, marble.scene, marble.rays);
    std::vector<ObjectShading> plain_lit = direct(lit);
    for (std::size_t i = 0; i < plain_lit.size(); ++i) {
        plain_lit[i].shader = plain.scene.objects[i].shader;
    }
    std::vector<ObjectShading> plain_direct = plain_lit;
    for (ObjectShading& object : plain_direct) object.irradiance = nullptr;

    // By pattern, evaluated ones first.
    std::array<std::vector<Ours>, 2> ours;
    ours[constant].push_back({"direct", "one colour", plain, plain_direct});
    ours[constant].push_back({"light", "one colour, its light from grids", plain, plain_lit});
    ours[procedural].push_back({"direct", "greenmarble evaluated", marble, direct(grids)});
    ours[procedural].push_back({"grid", "greenmarble from grids", marble, grids});
    ours[procedural].push_back({"light", "greenmarble and its light from grids", marble, lit});

    const Described all = describe(plain.scene);
    const Cycles cycles(all, bench.folder, threads);
    const PovRay povray(all, bench.folder, threads);
    Peer peers[]{{"cycles", {"one colour", "two noise textures of 15 and 14 octaves"}, {}},
                 {"povray", {"one colour", "marble with turbulence, and wrinkles, 28 noises"}, {}}};
    Rows& rows = bench.rows;
    try {
        for (int round = -1; round < round_count; ++round) {  // the first is not counted
            for (std::vector<Ours>& pattern : ours) {
                for (Ours& way : pattern) {
                    const double seconds = way.run();
                    if (round >= 0) way.costs.push_back({seconds, 0.0});
                }
            }
            if (round < 0) continue;
            cycles.run(peers[0]);
            povray.run(peers[1]);
        }
    } catch (const Error& problem) {
        return rows.missing(std::string("renderers: ") + problem.what());
    }

    const std::string frame =
        fmt::format("still life, {}x{}, {} spp, direct light with shadows, {} threads", width,
                    height, spp, threads);
    const char* const patterns[]{"constant", "procedural"};
    const auto seconds = [](const Cost& cost) { return cost.wall; };
    std::array<std::vector<std::string>, 2> errors;
    for (const Pattern pattern : {constant, procedural}) {
        for (const Ours& way : ours[pattern]) {
            errors[pattern].push_back(error_of(way, ours[pattern].front(), rows));
            rows.add({fmt::format("renderers/estara/{}/{}", patterns[pattern], way.name),
                      spread_of(way.costs, seconds), "s", errors[pattern].back(),
                      frame + ": " + way.what});
        }
    }
    for (const Peer& peer : peers) {
        const std::string error = error_of(peer, ours[constant].front().film, rows);
        for (const Pattern pattern : {constant, procedural}) {
            const std::string name = fmt::format("renderers/{}/{}", peer.name, patterns[pattern]);
            for (std::size_t i = 0; i < ours[pattern].size(); ++i) {
                const Ours& way = ours[pattern][i];
                rows.add({fmt::format("{}/{}_ratio", name, way.name),
                          ratio(way.costs, peer.costs[pattern], &Cost::wall), "ratio",
                          errors[pattern][i],
                          fmt::format("{}: {} over {}", frame, way.what, peer.patterns[pattern])});
            }
            rows.add({name, spread_of(peer.costs[pattern], seconds), "s",
                      pattern == constant ? error + ", to ours" : "another pattern",
                      frame + ": " + peer.patterns[pattern]});
        }
    }
}

}  // namespace estara::bench
