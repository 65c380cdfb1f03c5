// Names in a baked .vdb file: of grids, and of the metadata they carry. README.md explains them.
#pragma once

#include <set>
#include <string>

namespace estara {

/// "color", "color_level_1", "color_vase", "color_vase_level_1".
/// @param what    a channel's name, "surface" or "density"
/// @param object  what object_suffix() says
inline std::string grid_name(const std::string& what, const std::string& object, int level) {
    std::string name = what;
    if (!object.empty()) name += '_' + object;
    if (level > 0) name += "_level_" + std::to_string(level);
    return name;
}

/// What stands for an object in the names of its grids: nothing in a file of one object, whatever
/// its name and however many shaders it has.
/// @param objects  all those of the file
inline std::string object_suffix(const std::set<std::string>& objects, const std::string& object) {
    return objects.size() == 1 ? "" : object;
}

/// Keys of metadata.
namespace key {
inline constexpr const char* version = "estara_version";
inline constexpr const char* shader = "estara_shader";
inline constexpr const char* shader_digest = "estara_shader_digest";
inline constexpr const char* mesh_digest = "estara_mesh_digest";
inline constexpr const char* lights_digest = "estara_lights_digest";
inline constexpr const char* request = "estara_request";
inline constexpr const char* object = "estara_object";
inline constexpr const char* closed = "estara_closed";
inline constexpr const char* voxel_size = "estara_voxel_size";
inline constexpr const char* level = "estara_level";
inline constexpr const char* levels = "estara_levels";
inline constexpr const char* channel = "estara_channel";
inline constexpr const char* channels = "estara_channels";
inline constexpr const char* params = "estara_params";
inline constexpr const char* param_prefix = "estara_param_";
inline constexpr const char* error_mean = "estara_error_mean";
inline constexpr const char* error_rmse = "estara_error_rmse";
inline constexpr const char* error_p99 = "estara_error_p99";
inline constexpr const char* error_p999 = "estara_error_p999";
inline constexpr const char* error_max = "estara_error_max";
inline constexpr const char* error_samples = "estara_error_samples";
}  // namespace key

}  // namespace estara
