// The two loops over a block's triangles, where a bake spends its time besides the shader.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>

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
struct CellRows {
    static constexpr int side = 9;
    /// Bit z + 1 of rows[x + 1][y + 1] is cell (x, y, z).
    std::array<std::array<std::uint16_t, 16>, side> rows{};

    /// Bit z is voxel (x, y, z): whether it is a corner of a cell here.
    unsigned corners(std::size_t x, std::size_t y) const noexcept {
        const unsigned cells = rows[x][y] | rows[x][y + 1] | rows[x + 1][y] | rows[x + 1][y + 1];
        return (cells | (cells >> 1)) & 0xffu;
    }
};

/// The nearest triangle of each of 512 voxels, in bit order. In double, all of it: a loop with one
/// width of numbers is what compilers make wide.
struct alignas(64) NearestTriangles {
    std::array<double, 512> distance2;  ///< voxels squared; infinite: none
    std::array<double, 512> height;  ///< above its plane, voxels; below is behind. 0 if it has none
    std::array<double, 512> triangle;  ///< a whole number

    void clear() noexcept {
        distance2.fill(std::numeric_limits<double>::infinity());
        height.fill(0.0);
        triangle.fill(0.0);
    }
};

/// Adds the cells that the triangles meet.
void mark_cells(const BlockInput& in, CellRows& cells,
                InstructionSet limit = InstructionSet::avx512) noexcept;

/// For each voxel the nearest of the triangles that meet a cell around it. Of triangles equally
/// near (they share the nearest edge or vertex) the one that faces the voxel most: the others may
/// see it from behind although it is in front of the surface.
///
/// Both run the widest instruction set of the machine, but none wider than `limit`; the bits are
/// the same on all of them.
void find_nearest(const BlockInput& in, NearestTriangles& nearest,
                  InstructionSet limit = InstructionSet::avx512) noexcept;

}  // namespace estara
