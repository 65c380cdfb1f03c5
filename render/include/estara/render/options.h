// What the user asks estara-render for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "estara/render/file_pattern.h"
#include "estara/render/frame.h"
#include "estara/scenes/program.h"

namespace estara {

/// Where the view-independent part comes from: chosen by measurement, baked grids, hit points of
/// earlier frames, or evaluated anew in each frame.
enum class Strategy { automatic, grid, cache, direct };
const char* to_string(Strategy strategy) noexcept;

struct Options {
    std::string scene;
    bool allow_outside = false;  ///< files that it names may lie outside of its folder
    std::vector<FilePattern> outputs;
    std::vector<std::string> grids;
    Strategy strategy = Strategy::automatic;
    std::uint64_t cache_memory = std::uint64_t{2} << 30;  ///< bytes, of the cache's pages
    /// Frames that a hit point may serve. Windows begin at frames 1, 1 + window, 1 + 2 window, ...,
    /// whatever --frames says: a job of whole windows gives the same pictures.
    int window = 100;
    /// Whether the cache keeps diffuse light and shadows; none: if only cameras move.
    std::optional<bool> cache_light;
    std::optional<FrameRange> frames;  ///< none: the scene's animation
    std::optional<double> fps;         ///< none: the scene's, or 24
    FrameSettings frame;
    std::string camera;                ///< "": the first one
    std::optional<glm::vec3> ambient;  ///< none: the scene's
    std::string shader;           ///< what objects wear that wear nothing in the scene; "": plastic
    std::vector<Setting> params;  ///< of that shader
    std::vector<Setting> scene_params;  ///< "SHADER.NAME", of all objects that wear it
    bool resume = false;
    bool compare_direct = false;
    std::string report, stats, sheet;  ///< file names; "": none
    bool quiet = false;                ///< no warnings, no progress, no result
    int threads = 0;                   ///< 0: one a core
    ProgressStyle progress = ProgressStyle::automatic;
};

/// Reads the command line. Error, one line, for anything that is not as --help says.
/// @param help  becomes what --help or --version prints, if that was asked for; the options are of
///              no use then
Options parse_options(int argc, const char* const* argv, std::string& help);

/// The frames to render: --frames or the whole animation.
FrameRange frames_of(const Options& options, const Scene& scene);

/// The number of the window that a frame is in (Options::window).
int window_of(const Options& options, int frame) noexcept;

/// Errors that show only with the scene at hand: several frames under one name.
void check_outputs(const Options& options, const FrameRange& frames);

}  // namespace estara
