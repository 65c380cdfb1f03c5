// What the user asks estara-bake for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "estara/grids/texture_grid.h"
#include "estara/scenes/program.h"

namespace estara::bake {

struct Options {
    std::string shader, scene, output;
    bool allow_outside = false;  ///< files that the scene names may lie outside of its folder
    bool list_shaders = false, markdown = false;
    std::string describe;              ///< a shader's name; "": none
    std::vector<Setting> params;       ///< over what the scene says
    std::vector<std::string> objects;  ///< globs; none: those that wear the shader
    std::optional<double> voxel_size;  ///< object space; none: from the camera path
    std::optional<double> max_error;   ///< bound on RMSE; none: no bound
    std::optional<FrameRange> frames;  ///< none: the scene's animation
    std::optional<double> fps;         ///< none: the scene's, or 24
    glm::ivec2 resolution{640, 360};   ///< of the images that the voxel size is chosen for
    std::string camera;                ///< "": the first one
    std::uint64_t max_memory = 0;      ///< bytes; 0: half of the machine's
    VdbWriteOptions file;
    bool irradiance = false;                      ///< bake the light too
    double irradiance_error = 0.01;               ///< bound on a lookup of it
    std::optional<double> irradiance_voxel_size;  ///< object space; none: found
    bool dry_run = false;
    std::string stats;   ///< file name; "": none
    int threads = 0;     ///< 0: one a core
    bool quiet = false;  ///< no warnings, no progress, no results of bakes
    ProgressStyle progress = ProgressStyle::automatic;
    std::uint64_t seed = 0;  ///< of the points where the error is measured
};

/// Reads the command line. Error, one line, for anything that is not as --help says.
/// @param help  becomes what --help or --version prints, if that was asked for
Options parse_options(int argc, const char* const* argv, std::string& help);

}  // namespace estara::bake
