// From a mesh and a shader to a TextureGrid, with its error.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "estara/grids/texture_grid.h"
#include "estara/scenes/mesh.h"
#include "estara/shaders/registry.h"

namespace estara {

/// Told how many voxels more have been shaded; called from several threads.
using VoxelsDone = std::function<void(std::uint64_t)>;

/// What estara-bake takes before it bakes anything.
inline constexpr std::uint64_t program_bytes = std::uint64_t{48} << 20;

/// What a bake of a mesh will take, estimated without doing it.
struct BakeEstimate {
    std::uint64_t voxels = 0;  ///< active voxels of level 0
    std::uint64_t bytes = 0;   ///< peak memory of the bake
};

/// Voxelises the mesh more coarsely, at no more than 128 voxels along its diagonal, and scales the
/// count by the area of a voxel: within some per cent, unless the coarse voxels merge what the fine
/// ones tell apart.
BakeEstimate estimate_bake(const Mesh& mesh, const ShaderInfo& shader, double voxel_size);

/// Evaluates the shader on the voxels around the surface: a Domain::point shader at the voxel
/// centres (exact there, so thin sheets and creases are no special case), a Domain::surface one at
/// the nearest surface point. Filter width is the voxel size. Adds the coarser levels; rounds to
/// half floats if asked. Parallel; the same result for any number of threads.
///
/// Fills everything of TextureGrid but object and errors. Error: see surface_band(), and if the
/// shader gives a value that is not finite.
TextureGrid bake_mesh(const Mesh& mesh, const BoundShader& shader, double voxel_size, bool half,
                      const VoxelsDone& done = {});

/// |lookup(p) - shader(p)| at surface points that the bake never saw, through the lookup that
/// rendering uses, on level 0; linear colour. The points are random, uniform by area; the filter
/// width is the voxel size, as in the bake. Parallel; the same figures for any number of threads.
/// @return  by channel; mean and RMSE over points and components
std::vector<ErrorFigures> measure_error(const Mesh& mesh, const BoundShader& shader,
                                        const TextureGrid& grid, std::uint64_t samples,
                                        std::uint64_t seed);

/// How many surface points an error is measured at: p99.9 then rests on 262 of them.
inline constexpr std::uint64_t error_samples = std::uint64_t{1} << 18;

/// Bakes with the largest voxel that keeps every channel's RMSE within a bound: a voxel a tenth
/// larger was tried and broke it, or the voxel is a sixteenth of the object's diagonal.
struct BoundedBake {
    TextureGrid grid;  ///< errors filled in
    int attempts = 0;
    std::uint64_t bytes = 0;  ///< that the bake took, by its estimate
};

/// Told of each attempt's voxel size and number of voxels; gives what to tell of its progress.
using AttemptBegins = std::function<VoxelsDone(double voxel_size, std::uint64_t voxels)>;

/// @param max_error  bound on RMSE, > 0
/// @param max_bytes  memory for all of it. Error (failed), with what was reached, if the bound
/// needs
///                   more or a voxel below finest_voxel_size()
BoundedBake bake_to_error(const Mesh& mesh, const BoundShader& shader, double max_error, bool half,
                          std::uint64_t max_bytes, std::uint64_t seed,
                          const AttemptBegins& begin = {});

}  // namespace estara
