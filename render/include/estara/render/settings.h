// What a picture was rendered with: kept in its files, so that --resume can tell.
#pragma once

#include <string>

#include "estara/render/options.h"

namespace estara {

/// All that changes a frame's picture, as "key value; key value; ...": the scene and the grids by
/// their digests. Error for a grid that cannot be read.
/// @param camera  index into Scene::cameras
std::string settings_text(const Options& options, const Scene& scene, int camera);

/// The first setting that differs between two such texts: "spp was 4, is 16"; "" if none does.
std::string first_difference(const std::string& was, const std::string& is);

}  // namespace estara
