// The voxels around a surface that a lookup on it can touch, and how far each is from it.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

#include "estara/grids/texture_grid.h"
#include "estara/scenes/mesh.h"

namespace estara {

/// Voxels and cells as in GridLevel, and for each voxel the nearest of the triangles that cross one
/// of the eight cells around it.
struct SurfaceBand {
    double voxel_size = 1.0;  ///< object space
    glm::dvec3 origin{0.0};   ///< object position of voxel (0, 0, 0)
    std::vector<Block> blocks;
    std::vector<BlockMask> cells;  ///< by block
    /// By row: signed, object space, negative behind the surface. The distance to the mesh itself
    /// where that is up to a voxel; beyond, it may be larger: what does not cross a cell around is
    /// not seen. Off by at most 5e-6 voxels and what object space rounds (triangles thinner than a
    /// millionth of their length: by more).
    std::vector<float> distance;
    std::vector<std::uint32_t> triangle;  ///< by row: of the mesh; empty if not asked for

    std::uint64_t voxels() const noexcept {
        return blocks.empty() ? 0
                              : blocks.back().first + std::uint64_t(blocks.back().active.count());
    }
    glm::vec3 position(const glm::ivec3& voxel) const noexcept {
        return glm::vec3(origin + voxel_size * glm::dvec3(voxel));
    }
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
/// @param with_triangles  they are kept: what nearest_points() needs
SurfaceBand surface_band(const Mesh& mesh, double voxel_size, bool with_triangles = true);

/// How many voxels surface_band() has, in less time and without its memory. Error: likewise.
std::uint64_t count_voxels(const Mesh& mesh, double voxel_size);

/// The points of band.triangle, which must be there, that are nearest to a block's voxels.
/// @param points  becomes one for each active voxel, in bit order
void nearest_points(const Mesh& mesh, const SurfaceBand& band, std::size_t block,
                    std::vector<MeshPoint>& points);

/// Whether the mesh bounds a solid: each edge has one triangle on either side, wound alike.
/// Vertices at the same position count as one.
bool is_closed(const Mesh& mesh);

}  // namespace estara
