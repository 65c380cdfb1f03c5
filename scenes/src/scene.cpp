// Finding things in a scene by the names a user gives, and binding shaders.
#include "estara/scenes/scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "estara/scenes/error.h"

namespace estara {
namespace {

/// Whether a name matches a pattern of letters, '*' (any run) and '?' (any one).
bool matches(std::string_view pattern, std::string_view name) {
    std::size_t p = 0, n = 0;
    std::size_t star = std::string_view::npos, resume = 0;  // last '*', and where its run ends
    while (n < name.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            resume = n;
        } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
            ++p;
            ++n;
        } else if (star != std::string_view::npos) {
            p = star + 1;
            n = ++resume;
        } else {
            return false;
        }
    }
    while (p < pattern.size() && pattern[p] == '*') ++p;
    return p == pattern.size();
}

/// "a, b, c", cut after twenty.
std::string list(const std::vector<std::string>& names) {
    constexpr std::size_t shown = 20;
    const std::vector<std::string> head(names.begin(),
                                        names.begin() + long(std::min(shown, names.size())));
    std::string text = fmt::format("{}", fmt::join(head, ", "));
    if (names.size() > shown) text += fmt::format(" and {} more", names.size() - shown);
    return text;
}

std::vector<std::string> object_names(const Scene& scene) {
    std::vector<std::string> names;
    for (const Object& object : scene.objects) names.push_back(object.name);
    return names;
}

bool is_named(const Scene& scene, int object, std::string_view pattern) {
    const Object& o = scene.objects[std::size_t(object)];
    if (matches(pattern, o.name) || matches(pattern, o.mesh_name)) return true;
    return std::any_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& i) {
        return i.object == object && matches(pattern, scene.nodes[std::size_t(i.node)].name);
    });
}

std::vector<int> objects_matching(const Scene& scene, const std::vector<std::string>& globs) {
    std::vector<bool> chosen(scene.objects.size(), false);
    for (const std::string& glob : globs) {
        bool found = false;
        for (std::size_t i = 0; i < chosen.size(); ++i) {
            if (!is_named(scene, int(i), glob)) continue;
            chosen[i] = found = true;
        }
        if (!found) {
            throw Error(fmt::format("{}: --object '{}' matches nothing; the scene has: {}",
                                    scene.path, glob, list(object_names(scene))));
        }
    }
    std::vector<int> objects;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        if (chosen[i]) objects.push_back(int(i));
    }
    return objects;
}

std::vector<int> objects_wearing(const Scene& scene, const std::string& shader) {
    std::vector<int> wearing, all;
    std::vector<std::string> others;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const Object& object = scene.objects[i];
        all.push_back(int(i));
        if (!object.wears_shader()) continue;
        if (object.choice.name == shader) {
            wearing.push_back(int(i));
        } else {
            others.push_back(fmt::format("{} ({})", object.name, object.choice.name));
        }
    }
    if (!wearing.empty()) return wearing;
    if (others.empty() && !all.empty()) return all;
    if (all.empty()) throw Error(fmt::format("{}: the scene has no objects", scene.path));
    throw Error(
        fmt::format("{}: no object wears shader '{}'; with a shader there are: {}; "
                    "choose one with --object",
                    scene.path, shader, list(others)));
}

}  // namespace

int find_camera(const Scene& scene, const std::string& name) {
    if (scene.cameras.empty()) throw Error(fmt::format("{}: the scene has no camera", scene.path));
    if (name.empty()) return 0;
    // Blender shows the name of the node, and often gives all cameras' data one name.
    const auto node_name = [&](const SceneCamera& camera) {
        return scene.nodes[std::size_t(camera.node)].name;
    };
    std::vector<int> by_node, by_data;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        const SceneCamera& camera = scene.cameras[i];
        const std::string node = node_name(camera);
        if (node == name) by_node.push_back(int(i));
        if (camera.name == name) by_data.push_back(int(i));
        names.push_back(node == camera.name || node.empty()
                            ? camera.name
                            : fmt::format("{} ({})", node, camera.name));
    }
    const std::vector<int>& found = by_node.empty() ? by_data : by_node;
    if (found.size() == 1) return found.front();
    throw Error(fmt::format("{}: {} '{}'; the scene has: {}", scene.path,
                            found.empty() ? "no camera" : fmt::format("{} cameras", found.size()),
                            name, list(names)));
}

std::vector<int> instances_of(const Scene& scene, int object) {
    std::vector<int> found;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        if (scene.instances[i].object == object) found.push_back(int(i));
    }
    return found;
}

std::vector<int> select_objects(const Scene& scene, const std::string& shader,
                                const std::vector<std::string>& globs) {
    return globs.empty() ? objects_wearing(scene, shader) : objects_matching(scene, globs);
}

void set_parameters(Scene& scene, const std::vector<Setting>& settings) {
    std::set<std::string> worn;
    for (const Object& object : scene.objects) {
        if (object.wears_shader()) worn.insert(object.choice.name);
    }
    for (const Setting& setting : settings) {
        const std::size_t dot = setting.name.find('.');
        const std::string shader = setting.name.substr(0, dot), name = setting.name.substr(dot + 1);
        if (find_shader(shader) == nullptr) {
            const BindResult wrong = bind_shader(shader, {}, false);
            throw Error(fmt::format("--param {}: {}; {}", setting.name, wrong.problems.front().what,
                                    wrong.problems.front().hint));
        }
        if (!worn.contains(shader)) {
            throw Error(
                fmt::format("--param {}: no object wears '{}'; worn are: {}", setting.name, shader,
                            worn.empty() ? "none" : fmt::format("{}", fmt::join(worn, ", "))));
        }
        for (Object& object : scene.objects) {
            if (object.choice.name != shader) continue;
            std::erase_if(object.choice.settings, [&](const Setting& s) { return s.name == name; });
            object.choice.settings.push_back({name, setting.value});
            ShaderChoice choice = object.choice;
            choice.where = "--param";
            object.shader = bind_choice(choice, object.mesh.has_uv());
        }
    }
}

BoundShaderPtr bind_choice(const ShaderChoice& choice, bool has_uv) {
    BindResult result = bind_shader(choice.name, choice.settings, has_uv);
    if (result.problems.empty()) return result.shader;
    std::string text;
    for (const Problem& problem : result.problems) {
        if (!text.empty()) text += '\n';
        if (!choice.where.empty()) text += choice.where + ": ";
        text += problem.what;
        if (!problem.hint.empty()) text += "; " + problem.hint;
    }
    throw Error(text);
}

}  // namespace estara
