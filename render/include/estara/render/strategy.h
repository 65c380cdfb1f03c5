// Choosing, object by object, where the view-independent part comes from.
#pragma once

#include <string>
#include <vector>

#include "estara/render/dress.h"
#include "estara/render/reuse_model.h"

namespace estara {

/// Measures on some tiles of two neighbouring frames in the middle of `frames`, at the scene's own
/// hit points, what a sample of each object costs evaluated, looked up and recalled, and chooses
/// the cheapest by the paper's equations 3 and 4. Reuse must promise at least a thirtieth: what
/// gains less stays direct. Rays to the eye are left out: a recalled sample needs one as a new one
/// does.
///
/// The number of frames a point serves is 1 / (1 - share of samples that were recalled), at most
/// the window. With fewer than two frames the cache is not considered.
/// @param direct, gridded  by object: without and with their grids
/// @return by object, default for one that no tile sees; empty where there is nothing to choose:
///         no grid, and a single frame
std::vector<StrategyChoice> choose_strategies(const Scene& scene, RayScene& rays,
                                              const Options& options, int camera,
                                              const std::vector<int>& frames,
                                              const std::vector<ObjectShading>& direct,
                                              const std::vector<ObjectShading>& gridded);

/// For the user, a line for each shader and strategy: what was chosen, and why.
std::vector<std::string> describe_choices(const Scene& scene,
                                          const std::vector<StrategyChoice>& choices);

}  // namespace estara
