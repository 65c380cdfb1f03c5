// Which brick holds a voxel: the tables between a level's bounding box and its bricks.
#pragma once

#include <glm/glm.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "estara/grids/texture_grid.h"

namespace estara {

/// Root table over the bounding box -> middle tables -> bottom tables of 8^3 blocks, of 8^3 voxels
/// each, that have up to 8 bricks of 4^3 cells. The width of the middle tables grows with the
/// extent, so that neither they nor the root table are large. Middle table 0 and bottom table 0 are
/// full of zeros, so that the way down needs no test but the last.
///
/// A block's bricks follow each other, and so do a bottom table's blocks: an entry of 32 bits holds
/// which of the eight there are and how many the table has before them.
///
/// While bricks are being made, an entry is the number of its block plus 1; set_bricks() turns it
/// into what a lookup wants.
class BrickIndex {
public:
    static constexpr std::uint32_t none = ~std::uint32_t{0};
    static constexpr std::uint32_t max_extent = 1 << 18;  // voxels, along an axis
    static constexpr std::uint32_t bottom_bits = 3;       // log2 of blocks along an axis
    /// Blocks of a bottom table, at most.
    static constexpr std::size_t bottom_size = std::size_t{1} << (3 * bottom_bits);

    /// Error naming `where` if an extent is beyond max_extent.
    BrickIndex(const std::vector<Block>& blocks, const std::string& where);

    /// Number of the block that holds a voxel, or none. Before set_bricks().
    std::uint32_t block_of(const glm::uvec3& voxel) const noexcept {
        const Way way = m_box.way(voxel.x, voxel.y, voxel.z);
        if (way.bit == 0) return none;
        return m_bottom[m_middle[m_root[way.root] + way.middle].table + way.bottom] - 1;
    }

    /// Bottom tables are numbered [1, tables()).
    std::size_t tables() const noexcept { return m_bottom.size() / bottom_size; }

    /// Calls f(block) for the blocks of a bottom table, in the order of their bricks. Before
    /// set_bricks().
    template <class F>
    void for_each_block(std::size_t table, F&& f) const {
        for (std::size_t i = table * bottom_size; i < (table + 1) * bottom_size; ++i) {
            if (m_bottom[i] != 0) f(m_bottom[i] - 1);
        }
    }

    /// @param masks  by block, which of its eight bricks there are: bit x*4 + y*2 + z
    /// @param first  by bottom table, number of its first brick
    void set_bricks(const std::vector<std::uint8_t>& masks,
                    const std::vector<std::uint32_t>& first);

    /// What is read on the way to a cell's brick, as far as the coordinates alone tell it.
    struct Way {
        std::uint32_t root;    ///< in the root table
        std::uint32_t middle;  ///< in the middle table found there
        std::uint32_t bottom;  ///< in the bottom table found there
        std::uint32_t bit;     ///< of the brick in the entry found there; 0 outside of the box
    };

    /// The box and how it is divided: all that a loop needs to find the ways of many cells side by
    /// side. It copies this first, and there is no branch in way(), so that the compiler makes it
    /// wide.
    struct Box {
        glm::uvec3 low{0};              ///< its corner, a multiple of 8
        glm::uvec3 extent{0};           ///< voxels
        glm::uvec3 roots{1};            ///< entries of the root table along each axis
        std::uint32_t middle_bits = 0;  ///< a middle table has 2^middle_bits entries along an axis

        [[gnu::always_inline]] Way way(std::uint32_t vx, std::uint32_t vy,
                                       std::uint32_t vz) const noexcept {
            const std::uint32_t x = vx - low.x, y = vy - low.y, z = vz - low.z;
            const std::uint32_t inside =
                (x < extent.x ? ~0u : 0u) & (y < extent.y ? ~0u : 0u) & (z < extent.z ? ~0u : 0u);
            const std::uint32_t root_bits = bottom_width_bits + middle_bits;
            const auto digits = [](std::uint32_t a, std::uint32_t b, std::uint32_t c,
                                   std::uint32_t shift, std::uint32_t bits) {
                const std::uint32_t mask = (1u << bits) - 1;
                return (((a >> shift) & mask) << (2 * bits)) | (((b >> shift) & mask) << bits) |
                       ((c >> shift) & mask);
            };
            const std::uint32_t root =
                ((x >> root_bits) * roots.y + (y >> root_bits)) * roots.z + (z >> root_bits);
            return {root & inside, digits(x, y, z, bottom_width_bits, middle_bits) & inside,
                    digits(x, y, z, block_bits, bottom_bits) & inside,
                    (1u << digits(x, y, z, brick_bits, 1)) & inside};
        }
    };
    const Box& box() const noexcept { return m_box; }

    /// Number of the brick at the end of the way, or none. After set_bricks().
    std::uint32_t brick_at(const Way& way) const noexcept {
        const Middle middle = m_middle[m_root[way.root] + way.middle];
        const std::uint32_t entry = m_bottom[middle.table + way.bottom];
        if (!(entry & way.bit)) return none;
        const auto before = std::uint32_t(std::popcount(entry & (way.bit - 1)));
        return middle.first_brick + (entry >> 8) + before;
    }

    std::uint64_t bytes() const noexcept {
        return m_root.size() * sizeof(std::uint32_t) + m_middle.size() * sizeof(Middle) +
               m_bottom.size() * sizeof(std::uint32_t);
    }

private:
    static constexpr std::uint32_t brick_bits = 2, block_bits = 3;
    static constexpr std::uint32_t bottom_width_bits = block_bits + bottom_bits;  // 64 voxels

    struct Middle {
        std::uint32_t table = 0;        ///< first entry of a bottom table
        std::uint32_t first_brick = 0;  ///< of the bottom table
    };

    Box m_box;
    std::vector<std::uint32_t> m_root;  // first entry of a middle table
    std::vector<Middle> m_middle;
    std::vector<std::uint32_t> m_bottom;  // bricks of the table before, << 8, and which there are
};

}  // namespace estara
