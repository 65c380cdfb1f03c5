// Reads a scene by the ending of its name, and makes it ready to use.
#include "estara/scenes/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

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

Scene scene_of(Mesh mesh, const std::string& path) {
    Scene scene;
    scene.path = path;
    Object object;
    object.name = object.mesh_name = std::filesystem::path(path).stem().string();
    object.mesh = std::move(mesh);
    scene.objects.push_back(std::move(object));
    Node node;
    node.name = scene.objects.front().name;
    scene.nodes.push_back(std::move(node));
    scene.instances.push_back({0, 0});
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

Scene read(const std::string& path) {
    refuse_folder(path);
    const std::string format = ending(path);
    if (format == "gltf" || format == "glb") return read_gltf(path);
    if (format == "obj") return scene_of(read_obj(path), path);
    if (format == "ply") return scene_of(read_ply(path), path);
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

std::string one_line(const std::string& text) {
    constexpr std::size_t longest = 300;
    std::string line;
    for (const char c : text) {
        const bool blank = static_cast<unsigned char>(c) <= ' ';
        if (!blank) line += c;
        if (blank && !line.empty() && line.back() != ' ') line += ' ';
        if (line.size() >= longest) return line + "...";
    }
    while (!line.empty() && line.back() == ' ') line.pop_back();
    return line;
}

Scene load_scene(const std::string& path) {
    Scene scene = read(path);
    make_names_unique(scene.objects);
    bind_shaders(scene);
    return scene;
}

}  // namespace estara
