#include "estara/render/textures.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "estara/grids/irradiance.h"
#include "estara/scenes/error.h"
#include "estara/scenes/static_light.h"

namespace estara {
namespace {

std::string object_names(const Scene& scene) {
    std::vector<std::string> names;
    for (const Object& object : scene.objects) names.push_back(object.name);
    return fmt::format("{}", fmt::join(names, ", "));
}

/// Objects a grid is meant for, and whether on the mesh it was baked on.
struct Candidates {
    std::vector<int> objects;
    bool same_mesh = true;
};

Candidates candidates(const Scene& scene, const std::vector<std::string>& digests,
                      const TextureGrid& grid) {
    std::vector<int> same, named;
    for (int i = 0; i < int(scene.objects.size()); ++i) {
        const bool has_name =
            !grid.object.empty() && scene.objects[std::size_t(i)].name == grid.object;
        if (has_name) named.push_back(i);
        if (digests[std::size_t(i)] != grid.mesh_digest) continue;
        if (has_name) return {{i}, true};
        same.push_back(i);
    }
    if (!same.empty()) return {same, true};
    if (named.empty() && scene.objects.size() == 1) named.push_back(0);
    return {named, false};
}

std::string value_text(const std::vector<float>& value) {
    std::vector<std::string> numbers;
    for (const float v : value) numbers.push_back(to_string(v));
    return fmt::format("{}", fmt::join(numbers, ","));
}

/// "baked with ringscale=10, but it wears ringscale=12", or "" if all that is baked is the same.
std::string different_params(const TextureGrid& grid, const BoundShader& shader) {
    const std::vector<glm::vec3> values = shader.values();
    std::vector<std::string> baked, worn;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const ParamInfo& param = shader.info().params[i];
        if (param.part != Part::bake) continue;
        std::vector<float> value{values[i].x, values[i].y, values[i].z};
        value.resize(std::size_t(param.components()));
        const auto found = std::find_if(grid.params.begin(), grid.params.end(),
                                        [&](const auto& p) { return p.first == param.name; });
        if (found != grid.params.end() && found->second == value) continue;
        baked.push_back(found == grid.params.end()
                            ? fmt::format("no {}", param.name)
                            : fmt::format("{}={}", param.name, value_text(found->second)));
        worn.push_back(fmt::format("{}={}", param.name, value_text(value)));
    }
    if (baked.empty()) return "";
    return fmt::format("baked with {}, but it wears {}", fmt::join(baked, " "),
                       fmt::join(worn, " "));
}

bool has_channels_of(const TextureGrid& grid, const ShaderInfo& info) {
    return std::equal(grid.channels.begin(), grid.channels.end(), info.channels.begin(),
                      info.channels.end(), [](const GridChannel& a, const ChannelInfo& b) {
                          return a.name == b.name && a.components == b.components;
                      });
}

/// What has changed between the bake and the scene, or "" if nothing has.
std::string difference(const Object& object, const TextureGrid& grid, bool same_mesh) {
    const ShaderInfo& worn = object.shader->info();
    if (!same_mesh) return "its mesh is not the one that was baked";
    if (worn.name != grid.shader) {
        return fmt::format("baked with shader '{}', but it wears '{}'", grid.shader, worn.name);
    }
    if (shader_digest(*object.shader) != grid.shader_digest) {
        const std::string params = different_params(grid, *object.shader);
        if (!params.empty()) return params;
        return fmt::format("shader '{}' paints differently since (baked by estara-bake {})",
                           grid.shader, grid.tool_version);
    }
    if (!has_channels_of(grid, worn)) {
        return fmt::format("the file's channels are not those of shader '{}'", grid.shader);
    }
    return "";
}

std::string title(const LoadedGrid& loaded, const Object& object) {
    return fmt::format("{}: object \"{}\"", loaded.file, object.name);
}

/// The shader a grid was baked with, or the reason why it cannot be had.
BindResult bind_baked(const TextureGrid& grid, const Object& object) {
    std::vector<Setting> settings;
    for (const auto& [name, value] : grid.params) settings.push_back({name, value});
    return bind_shader(grid.shader, settings, object.mesh.has_uv());
}

class Matcher {
public:
    Matcher(Scene& scene, const std::vector<LoadedGrid>& grids) : m_scene(scene), m_grids(grids) {
        m_match.grid_of_object.assign(scene.objects.size(), -1);
        m_match.irradiance_of_object.assign(scene.objects.size(), -1);
        m_match.is_stale.assign(scene.objects.size(), false);
        for (const Object& object : scene.objects) {
            m_was_bare.push_back(!object.wears_shader());
            m_digests.push_back(grids.empty() ? "" : mesh_digest(object.mesh));
        }
    }

    GridMatch match() {
        for (int g = 0; g < int(m_grids.size()); ++g) {
            if (m_grids[std::size_t(g)].grid.shader == irradiance_shader) {
                match_irradiance(g);
                continue;
            }
            const Candidates found = candidates(m_scene, m_digests, m_grids[std::size_t(g)].grid);
            if (found.objects.empty()) warn_unused(m_grids[std::size_t(g)]);
            for (const int o : found.objects) try_on(o, g, found.same_mesh);
        }
        return std::move(m_match);
    }

private:
    void match_irradiance(int g) {
        const LoadedGrid& loaded = m_grids[std::size_t(g)];
        const Candidates found = candidates(m_scene, m_digests, loaded.grid);
        if (found.objects.empty()) return warn_unused(loaded);
        const int o = found.objects.front();
        const std::string why = light_difference(o, loaded.grid, found.same_mesh);
        if (why.empty()) {
            m_match.irradiance_of_object[std::size_t(o)] = g;
        } else {
            m_match.warnings.push_back(
                fmt::format("{}: baked light: {}; shadows are traced: bake it again to use it",
                            title(loaded, m_scene.objects[std::size_t(o)]), why));
        }
    }

    /// Why baked light is not that of the scene, or "".
    std::string light_difference(int o, const TextureGrid& grid, bool same_mesh) const {
        if (!same_mesh) return "its mesh is not the one that was baked";
        if (grid.channels.size() != 2 || grid.channels[0].name != irradiance_channel ||
            grid.channels[0].components != 3 || grid.channels[1].name != irradiance_mask_channel ||
            grid.channels[1].components != 1) {
            return "its channels are not irradiance and irradiance_mask";
        }
        const std::string why = why_no_static_light(m_scene, o);
        if (!why.empty()) return why;
        const std::string moving = moving_node(m_scene);
        if (!moving.empty()) return fmt::format("\"{}\" moves", moving);
        if (lights_digest(m_scene, instances_of(m_scene, o).front()) != grid.lights_digest) {
            return "a light or something that casts shadows has changed";
        }
        return "";
    }

    void warn_unused(const LoadedGrid& loaded) {
        const std::string whose =
            loaded.grid.object.empty() ? "" : fmt::format(" of object \"{}\"", loaded.grid.object);
        m_match.warnings.push_back(fmt::format(
            "{}: the grid{} (shader '{}') fits no object of {}; it has: {}", loaded.file, whose,
            loaded.grid.shader, m_scene.path, object_names(m_scene)));
    }

    void warn_stale(int o, const LoadedGrid& loaded, const std::string& why) {
        m_match.is_stale[std::size_t(o)] = true;
        m_match.warnings.push_back(
            fmt::format("{}: {}; evaluated directly: bake it again to use the grid",
                        title(loaded, m_scene.objects[std::size_t(o)]), why));
    }

    /// Lets a bare object wear the shader a grid was baked with. False if there is no such shader.
    bool put_on(int o, const LoadedGrid& loaded) {
        Object& object = m_scene.objects[std::size_t(o)];
        BindResult bound = bind_baked(loaded.grid, object);
        if (!bound.shader) {
            const Problem& problem = bound.problems.front();
            warn_stale(o, loaded, fmt::format("baked by another version: {}", problem.what));
            return false;
        }
        object.shader = bound.shader;
        object.choice.name = loaded.grid.shader;
        object.choice.where = title(loaded, object);
        return true;
    }

    void try_on(int o, int g, bool same_mesh) {
        const LoadedGrid& loaded = m_grids[std::size_t(g)];
        int& taken = m_match.grid_of_object[std::size_t(o)];
        // A stale grid does not take the shader away that a fitting one has brought.
        if (m_was_bare[std::size_t(o)] && (same_mesh || taken < 0) && !put_on(o, loaded)) return;
        const Object& object = m_scene.objects[std::size_t(o)];
        const std::string changed = difference(object, loaded.grid, same_mesh);
        if (!changed.empty()) return warn_stale(o, loaded, changed);
        if (taken >= 0) {
            m_match.warnings.push_back(
                fmt::format("object \"{}\": grids of {} and {} fit; the last one is used",
                            object.name, m_grids[std::size_t(taken)].file, loaded.file));
        }
        taken = g;
        m_match.is_stale[std::size_t(o)] = false;
    }

    Scene& m_scene;
    const std::vector<LoadedGrid>& m_grids;
    std::vector<bool> m_was_bare;
    std::vector<std::string> m_digests;
    GridMatch m_match;
};

}  // namespace

std::vector<LoadedGrid> load_grids(const std::vector<std::string>& names, const Say& say) {
    namespace fs = std::filesystem;
    std::vector<LoadedGrid> loaded;
    const auto load = [&](const std::string& file) {
        for (TextureGrid& grid : read_vdb(file)) loaded.push_back({file, std::move(grid)});
    };
    for (const std::string& name : names) {
        std::error_code code;
        if (!fs::is_directory(name, code)) {
            load(name);
            continue;
        }
        std::set<std::string> files;
        for (const fs::directory_entry& entry : fs::directory_iterator(name, code)) {
            const bool hidden = entry.path().filename().string().starts_with('.');
            if (!hidden && entry.path().extension() == ".vdb") files.insert(entry.path().string());
        }
        if (code) throw Error(fmt::format("{}: cannot be read: {}", name, code.message()));
        if (files.empty()) throw Error(fmt::format("{}: no .vdb file in this folder", name));
        for (const std::string& file : files) {
            try {
                load(file);
            } catch (const Error& error) {  // it may be another program's
                say(fmt::format("warning: {}; not used", error.what()));
            }
        }
    }
    return loaded;
}

GridMatch match_grids(Scene& scene, const std::vector<LoadedGrid>& grids) {
    return Matcher(scene, grids).match();
}

}  // namespace estara
