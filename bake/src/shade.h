// The finest level's values.
#pragma once

#include "estara/bake/bake.h"
#include "estara/bake/surface_band.h"

namespace estara {

/// Fills the planes of level 0. Parallel; the same result for any number of threads. Error if the
/// shader gives a value that is not finite.
/// @param band  its distances are not looked at, its triangles only for a shader on the surface
/// @param grid  with origin, voxel size and channels; gets its first level, without blocks
void shade(const Mesh& mesh, const BoundShader& shader, const SurfaceBand& band, TextureGrid& grid,
           const VoxelsDone& done);

}  // namespace estara
