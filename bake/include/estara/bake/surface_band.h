// The voxels around a surface that a lookup on it can touch, and for each the nearest surface
// point.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <vector>

#include "estara/grids/texture_grid.h"
#include "estara/scenes/mesh.h"

namespace estara {

/// Voxels and cells as in GridLevel, and what their nearest points are found from.
struct SurfaceBand {
    /// Part of `triangles`.
    struct Near {
        std::uint64_t first = 0;
        std::uint32_t count = 0;
    };

    double voxel_size = 1.0;  ///< object space
    glm::dvec3 origin{0.0};   ///< object position of voxel (0, 0, 0)
    double slack = 0.0;  ///< how much larger than a voxel cells are taken, on each side, in voxels
    std::vector<Block> blocks;
    std::vector<BlockMask> cells;          ///< by block
    std::vector<Near> near;                ///< by block: those that may cross a cell around a voxel
    std::vector<std::uint32_t> triangles;  ///< ascending within a block

    std::uint64_t voxels() const noexcept {
        return blocks.empty() ? 0
                              : blocks.back().first + std::uint64_t(blocks.back().active.count());
    }
    glm::vec3 position(const glm::ivec3& voxel) const noexcept {
        return glm::vec3(origin + voxel_size * glm::dvec3(voxel));
    }
};

/// The surface points nearest to the voxels of a block, in bit order.
struct NearestPoints {
    std::array<float, 512> distance;
    std::array<std::uint32_t, 512> triangle;
    std::array<glm::vec2, 512> barycentrics;  ///< b1, b2
};

/// Error if surface_band() cannot divide the mesh into such voxels; costs next to nothing.
void check_voxel_size(const Mesh& mesh, double voxel_size);

/// Voxelises a mesh conservatively: active are the eight corners of every cell (unit cube between
/// voxel centres) that a triangle touches, and no other voxel. Cells are taken larger by what a
/// hit point's float coordinates may be off, so that a lookup at any computed surface point finds
/// its eight voxels. Thin sheets and open meshes are no special case; a degenerate triangle counts
/// as the segment or point that it is. Overlap test: Schwarz & Seidel 2010, "Fast Parallel Surface
/// and Solid Voxelization on GPUs", section 3 (exact, by separating axes; here in double, whose
/// rounding is a millionth of what cells are taken larger).
///
/// Cost grows with area / voxel_size^2 plus the number of triangles. Parallel over blocks; the
/// result does not depend on the number of threads.
/// @param voxel_size  object space, > 0. Error if it is below what floats resolve at the mesh's
///                    coordinates, or the mesh spans more than 2^17 voxels
SurfaceBand surface_band(const Mesh& mesh, double voxel_size);

/// The signed distances of a block's voxels to the nearest of the triangles that cross one of the
/// eight cells around, object space; negative behind the surface. The distance to the mesh itself
/// where that is up to a voxel; beyond, it may be larger: what does not cross a cell around is not
/// seen.
/// @param distances  becomes one for each active voxel, in bit order
void nearest_distances(const Mesh& mesh, const SurfaceBand& band, std::size_t block,
                       float* distances) noexcept;

/// Likewise, with the points that these are the distances to.
void nearest_points(const Mesh& mesh, const SurfaceBand& band, std::size_t block,
                    NearestPoints& points) noexcept;

/// Whether the mesh bounds a solid: each edge has one triangle on either side, wound alike.
/// Vertices at the same position count as one.
bool is_closed(const Mesh& mesh);

}  // namespace estara
