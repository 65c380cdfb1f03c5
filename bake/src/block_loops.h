// The loop over a block's triangles, where a bake spends its time besides the shader.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>

#include "estara/shaders/kernel.h"
#include "estara/shaders/registry.h"
#include "lattice.h"

namespace estara {

/// A block of 8^3 voxels and the triangles that may cross a cell around one of them.
struct BlockInput {
    const Mesh& mesh;
    const Lattice& lattice;
    glm::ivec3 origin;  ///< of its voxels
    std::span<const std::uint32_t> triangles;
};

/// The 9^3 cells around a block's voxels, -1 to 7 in each axis.
struct alignas(32) CellRows {
    static constexpr int side = 9;
    /// Bit z + 1 of rows[x + 1][y + 1] is cell (x, y, z).
    std::array<std::array<std::uint16_t, 16>, side> rows{};

    /// Bit z is voxel (x, y, z): whether it is a corner of a cell here.
    ESTARA_KERNEL unsigned corners(std::size_t x, std::size_t y) const noexcept {
        const unsigned cells = rows[x][y] | rows[x][y + 1] | rows[x + 1][y] | rows[x + 1][y + 1];
        return (cells | (cells >> 1)) & 0xffu;
    }
};

/// The nearest triangle of each of 512 voxels, in bit order.
struct alignas(64) NearestTriangles {
    std::array<float, 512> distance;  ///< voxels; infinite: none
    std::array<float, 512> height;  ///< above its plane, voxels; below is behind. 0 if it has none
    std::array<std::uint32_t, 512> triangle;

    void clear() noexcept {
        distance.fill(std::numeric_limits<float>::infinity());
        height.fill(0.0f);
        triangle.fill(0);
    }
};

/// Adds the cells that the triangles meet and, for each voxel, takes them into account that meet a
/// cell around it: the nearest is kept. Of triangles equally near (they share the nearest edge or
/// vertex) it is the one that faces the voxel most: the others may see it from behind although it
/// is in front of the surface.
///
/// Distances are the smallest that there are within 5e-6 voxels (float, from the block's middle),
/// of triangles that are wider than a millionth of their length; what differs by less than 1e-5 is
/// equally near. Runs the widest instruction set of the machine, but none wider than `limit`; the
/// bits are the same on all of them.
/// @param nearest  null: cells alone
void voxelize(const BlockInput& in, CellRows& cells, NearestTriangles* nearest,
              InstructionSet limit = InstructionSet::avx512) noexcept;

}  // namespace estara
