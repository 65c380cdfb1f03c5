// The whole of estara-render but its command line and its words on stdout.
#pragma once

#include "estara/render/options.h"
#include "estara/render/statistics.h"

namespace estara {

/// Loads the scene and the grids, renders and writes the frames, the statistics and the report.
/// Errors as everything it uses. `say` hears warnings and what is evaluated directly.
RunRecord run(const Options& options, const Say& say);

/// The same for a scene that is loaded already.
RunRecord run(const Options& options, Scene scene, const Say& say);

}  // namespace estara
