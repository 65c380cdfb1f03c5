// The still life beside other renderers, Blender's Cycles and POV-Ray: the same geometry, camera,
// lights and samples, one constant colour, then procedural patterns of as many noises.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <sstream>

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

std::string text_of(const std::string& path) {
    std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
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

/// RMSE over the mean of the reference, after the one exposure that brings the film nearest to it.
double relative_rmse(Film film, const Film& reference) {
    double both = 0.0, own = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < film.color.size(); ++i) {
        const glm::dvec3 a(film.color[i]), b(reference.color[i]);
        both += glm::dot(a, b);
        own += glm::dot(a, a);
        mean += (b.x + b.y + b.z) / (3.0 * double(film.color.size()));
    }
    for (glm::vec4& color : film.color) color *= float(both / own);
    return compare_films(film, reference).rmse / mean;
}

enum Pattern { constant, procedural };

/// A renderer that is a program of its own: its seconds, and its last picture in a constant colour.
struct Peer {
    const char* name;
    std::array<const char*, 2> patterns;  ///< in words
    std::array<std::vector<double>, 2> seconds{};
    Film film{width, height, {}};
};

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
        run_command(
            fmt::format("blender --background --factory-startup --python-exit-code 1 "
                        "--python '" ESTARA_CYCLES "' -- '{}' {} '{}' {} '{}' > '{}' 2>&1",
                        (m_folder / "cycles.json").string(), names[0], path(0), names[1], path(1),
                        (m_folder / "cycles.txt").string()));
        for (const Pattern pattern : {constant, procedural}) {
            std::string time;
            Film film = picture(path(pattern), &time);
            peer.seconds[pattern].push_back(seconds_of(time));
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
            run_command(
                fmt::format("povray '+I{}' '+O{}' +FE -D +W{} +H{} +WT{} +A0.0 +AM1 +R4 -J "
                            "> '{}' 2>&1",
                            scene(pattern), out, width, height, m_threads, says));
            const std::string text = text_of(says);
            std::smatch time, samples;
            if (!std::regex_search(text, time,
                                   std::regex("Trace Time:.*\\(([0-9.]+) seconds\\)")) ||
                !std::regex_search(text, samples, std::regex("Samples: +([0-9]+)"))) {
                throw Error(says + ": no time, or no number of samples", ExitStatus::failed);
            }
            // It takes one sample more than were asked for.
            const double wanted = double(spp) * width * height;
            peer.seconds[pattern].push_back(std::stod(time[1]) * wanted / std::stod(samples[1]));
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
        : scene(still_life_in(choice, folder)), rays(scene), renderer(scene, rays, settings()) {}

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

/// A way in which we render it: its seconds, and its last picture.
struct Ours {
    const char* name;
    std::string what;
    Dressed& dressed;
    std::vector<ObjectShading> shading;
    std::vector<double> seconds{};
    Film film{width, height, {}};

    /// Beside the pictures that are evaluated.
    std::string error(const Ours& evaluated) const {
        if (this == &evaluated) return "exact";
        return fmt::format("rmse {:.2g}", compare_films(film, evaluated.film).rmse);
    }

    void run() { seconds.push_back(dressed.renderer.render(shading, 0, 0.0, film, {}).seconds); }
};

Spread over(const std::vector<double>& ours, const std::vector<double>& theirs) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < ours.size(); ++i) ratios.push_back(ours[i] / theirs[i]);
    return spread(std::move(ratios));
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

    // By pattern: evaluated, from grids, and with light from grids.
    std::array<std::vector<Ours>, 2> ours;
    ours[constant].push_back({"", "one colour", plain, plain_direct});
    ours[constant].push_back({"/light", "one colour, its light from grids", plain, plain_lit});
    ours[procedural].push_back({"/direct", "greenmarble evaluated", marble, direct(grids)});
    ours[procedural].push_back({"", "greenmarble from grids", marble, grids});
    ours[procedural].push_back({"/light", "greenmarble and its light from grids", marble, lit});

    const Described all = describe(plain.scene);
    const Cycles cycles(all, bench.folder, threads);
    const PovRay povray(all, bench.folder, threads);
    Peer peers[]{{"cycles", {"one colour", "two noise textures of 15 and 14 octaves"}, {}},
                 {"povray", {"one colour", "marble with turbulence, and wrinkles, 28 noises"}, {}}};
    for (int round = 0; round < round_count; ++round) {
        for (std::vector<Ours>& pattern : ours) {
            for (Ours& way : pattern) way.run();
        }
        cycles.run(peers[0]);
        povray.run(peers[1]);
    }

    Rows& rows = bench.rows;
    const std::string frame =
        fmt::format("still life, {}x{}, {} spp, direct light with shadows, {} threads", width,
                    height, spp, threads);
    const char* const patterns[]{"constant", "procedural"};
    for (const Peer& peer : peers) {
        const std::string picture_error = fmt::format(
            "rmse {:.2g} of the mean", relative_rmse(peer.film, ours[constant].front().film));
        for (const Pattern pattern : {constant, procedural}) {
            const std::string name = fmt::format("renderers/{}/{}", peer.name, patterns[pattern]);
            for (const Ours& way : ours[pattern]) {
                rows.add({name + "_ratio" + way.name, over(way.seconds, peer.seconds[pattern]),
                          "ratio", way.error(ours[pattern].front()),
                          fmt::format("{}: {} over {}", frame, way.what, peer.patterns[pattern])});
            }
            rows.add({name, spread(peer.seconds[pattern]), "s",
                      pattern == constant ? picture_error : "",
                      frame + ": " + peer.patterns[pattern]});
        }
    }
    for (const Pattern pattern : {constant, procedural}) {
        for (const Ours& way : ours[pattern]) {
            rows.add({fmt::format("renderers/estara/{}{}", patterns[pattern], way.name),
                      spread(way.seconds), "s", way.error(ours[pattern].front()),
                      frame + ": " + way.what});
        }
    }
}

}  // namespace estara::bench
