// The still life as frames are timed: one shader on every object.
#pragma once

#include <filesystem>
#include <vector>

#include "estara/render/frame.h"
#include "estara/scenes/scene.h"

namespace estara::bench {

/// RMSE of grids against direct evaluation; tests/README.md, "Image error".
constexpr double allowed_rmse = 0.01;

/// Every object of the still life in this shader.
/// @param folder  for the scene's file
Scene still_life_in(const ShaderChoice& choice, const std::filesystem::path& folder);

/// Every object baked with the voxels that estara-bake would choose, or with larger ones where that
/// would be more than 4 million: the backdrop alone would be 330 million.
/// @param width, height  pixels of the pictures
std::vector<ObjectShading> baked(const Scene& scene, RayScene& rays, int width, int height);

/// The same with the diffuse light of all lights baked as well, as estara-bake --irradiance does.
std::vector<ObjectShading> with_light(std::vector<ObjectShading> shading, const Scene& scene,
                                      const RayScene& rays);

/// The same objects evaluated directly.
std::vector<ObjectShading> direct(std::vector<ObjectShading> shading);

}  // namespace estara::bench
