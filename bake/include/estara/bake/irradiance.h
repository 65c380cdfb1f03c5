// Diffuse light on a surface, baked: it depends on the camera as little as colour does.
#pragma once

#include <cstdint>
#include <optional>

#include "estara/grids/texture_grid.h"
#include "estara/scenes/ray_scene.h"
#include "estara/scenes/scene.h"

namespace estara {

struct IrradianceSettings {
    double max_error = 0.01;             ///< of a lookup, absolute; cells with more are masked
    std::optional<double> voxel_size{};  ///< object space; none: found, see bake_irradiance()
    double finest = 0.0;                 ///< a found size is not below this, > 0 if none is given
    std::uint64_t max_bytes = 0;         ///< of memory, for a found size
    bool half = false;
    std::uint64_t seed = 0;  ///< of the points where errors are looked for and measured
};

/// Bakes the light of the scene's lights on an object (StaticLight) into grids "irradiance" and
/// "irradiance_mask" with levels of their own.
///
/// A shadow's edge is no wider than a voxel anywhere: cells in which a lookup is off by more than
/// max_error are masked, and left to rays. They are found by comparing with rays at about three
/// surface points a voxel; the errors told in the grid are those of other points, outside the mask.
/// Without a voxel size the object is baked with a 64th of its diagonal and then with voxels half
/// as large, until at most a twentieth of the surface is masked or the next would be below
/// `finest` or above `max_bytes`.
///
/// Params of the grid are max_error and masked, the masked share of the surface. Parallel; the same
/// result for any number of threads.
/// @param scene   nothing but cameras moves (moving_node())
/// @param object  index into Scene::objects. Error if it stands in the scene other than once
/// @param rays    posed at time 0
TextureGrid bake_irradiance(const Scene& scene, const RayScene& rays, int object,
                            const IrradianceSettings& settings);

/// The share of the surface that a grid of bake_irradiance() leaves to rays, estimated at 65536
/// points.
double masked_share(const TextureGrid& grid);

}  // namespace estara
