// Reads a scene by the ending of its name, and makes it ready to use.
#include "estara/scenes/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>

#include "loaders.h"

namespace estara {
namespace {

/// Ending of a name without the dot, in small letters.
std::string ending(const std::string& path) {
    std::string text = std::filesystem::path(path).extension().string();
    if (!text.empty()) text.erase(0, 1);
    for (char& c : text) {
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    }
    return text;
}

/// Objects where their coordinates put them, seen from an orbit.
Scene scene_of(std::vector<Object> objects, const std::string& path,
               std::vector<std::string> warnings) {
    Scene scene;
    scene.path = path;
    scene.warnings = std::move(warnings);
    for (Object& object : objects) {
        scene.instances.push_back({int(scene.objects.size()), int(scene.nodes.size())});
        Node node;
        node.name = object.name;
        scene.nodes.push_back(std::move(node));
        scene.objects.push_back(std::move(object));
    }
    add_orbit_camera(scene);
    add_studio_lights(scene);
    scene.ambient = glm::vec3(studio_ambient);
    return scene;
}

/// A name that every file system and OpenVDB program can take.
std::string plain_name(const std::string& name) {
    std::string plain;
    for (const char c : name) {
        const bool kept = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
        plain += kept ? c : '_';
    }
    return plain.empty() ? "mesh" : plain;
}

void make_names_unique(std::vector<Object>& objects) {
    std::set<std::string> taken;
    for (Object& object : objects) {
        const std::string base = plain_name(object.name);
        object.name = base;
        for (int n = 2; !taken.insert(object.name).second; ++n) {
            object.name = fmt::format("{}_{}", base, n);
        }
    }
}

BoundShaderPtr shader_of(const Object& object) {
    if (object.wears_shader()) return bind_choice(object.choice, object.mesh.has_uv());
    const glm::vec3& c = object.base_color;
    const ShaderChoice plain{"plastic", {Setting{"Cs", {c.r, c.g, c.b}}}, ""};
    return bind_choice(plain, object.mesh.has_uv());
}

/// The farthest coordinate that rays can be traced to: Embree 3 gives up at 1.844e18.
constexpr float farthest = 1e18f;

/// Error for a vertex that no ray can be traced to.
void check_extent(const Scene& scene) {
    for (const Object& object : scene.objects) {
        const auto check = [&](const std::vector<glm::vec3>& vertices, const char* what) {
            for (const glm::vec3& P : vertices) {
                for (int c = 0; c < 3; ++c) {
                    if (std::abs(P[c]) <= farthest) continue;
                    throw Error(fmt::format(
                        "{}: mesh \"{}\": a {} of {:.3g}; coordinates up to {:.0e} can be traced",
                        scene.path, one_line(object.mesh_name), what, P[c], farthest));
                }
            }
        };
        check(object.mesh.P, "coordinate");
        for (const MorphTarget& target : object.bends.targets) check(target.P, "displacement");
    }
}

/// Binds every object's shader; what is wrong with any of them becomes one Error.
void bind_shaders(Scene& scene) {
    std::set<std::string> told;  // objects may share a material
    std::string problems;
    for (Object& object : scene.objects) {
        try {
            object.shader = shader_of(object);
        } catch (const Error& error) {
            if (!told.insert(error.what()).second) continue;
            problems += (problems.empty() ? "" : "\n") + std::string(error.what());
        }
    }
    if (!problems.empty()) throw Error(problems);
}

void refuse_folder(const std::string& path) {
    std::error_code unreadable;  // which reading it will tell
    if (std::filesystem::is_directory(path, unreadable)) {
        throw Error(fmt::format("{}: is a folder; a scene is a file", path));
    }
}

Scene read(const std::string& path, bool allow_outside) {
    refuse_folder(path);
    const std::string format = ending(path);
    if (format == "gltf" || format == "glb") return read_gltf(path, allow_outside);
    std::vector<std::string> warnings;
    if (format == "obj") {
        std::vector<Object> objects = read_obj(path, warnings);
        return scene_of(std::move(objects), path, std::move(warnings));
    }
    if (format == "ply") {
        Object object;
        object.name = object.mesh_name = std::filesystem::path(path).stem().string();
        object.mesh = read_ply(path, warnings);
        std::vector<Object> objects;
        objects.push_back(std::move(object));
        return scene_of(std::move(objects), path, std::move(warnings));
    }
    throw Error(
        fmt::format("{}: unknown kind of file; a scene ends in .gltf, .glb, .obj or .ply", path));
}

}  // namespace

std::string read_file(const std::string& path) {
    std::error_code code;
    refuse_folder(path);
    std::ifstream file(path, std::ios::binary);
    if (!file) throw Error(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
    const std::uintmax_t size = std::filesystem::file_size(path, code);
    if (code) throw Error(fmt::format("{}: cannot be read: {}", path, code.message()));
    std::string bytes(size, '\0');
    if (!file.read(bytes.data(), std::streamsize(size))) {
        throw Error(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
    }
    return bytes;
}

std::string one_line(const std::string& text, std::size_t longest) {
    constexpr unsigned char del = 0x7f, first_of_c1 = 0xc2, end_of_c1 = 0xa0;
    std::string line;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        // U+0080 to U+009F, in UTF-8 two bytes, are control characters too.
        const bool c1 = byte == first_of_c1 && i + 1 < text.size() &&
                        static_cast<unsigned char>(text[i + 1]) < end_of_c1;
        const bool blank = byte <= ' ' || byte == del || c1;
        i += c1 ? 1 : 0;
        if (!blank) line += text[i];
        if (blank && !line.empty() && line.back() != ' ') line += ' ';
    }
    while (!line.empty() && line.back() == ' ') line.pop_back();
    if (line.size() <= longest) return line;
    constexpr std::string_view more = "...";
    std::size_t end = longest - more.size();
    while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xc0) == 0x80) --end;  // in a letter
    return line.substr(0, end) + std::string(more);
}

Scene load_scene(const std::string& path, bool allow_outside) {
    Scene scene = read(path, allow_outside);
    check_extent(scene);
    make_names_unique(scene.objects);
    bind_shaders(scene);
    return scene;
}

}  // namespace estara
