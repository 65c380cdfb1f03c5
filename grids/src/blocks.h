// What the files of this folder share about blocks of voxels. No OpenVDB.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "estara/grids/texture_grid.h"

namespace estara {

/// The order of blocks in a level: by x, then y, then z.
inline bool comes_before(const glm::ivec3& a, const glm::ivec3& b) noexcept {
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    return a.z < b.z;
}

/// Index of the block with that origin, or -1.
inline std::ptrdiff_t find_block(const std::vector<Block>& blocks,
                                 const glm::ivec3& origin) noexcept {
    const auto it = std::lower_bound(
        blocks.begin(), blocks.end(), origin,
        [](const Block& b, const glm::ivec3& o) { return comes_before(b.origin, o); });
    return it != blocks.end() && it->origin == origin ? it - blocks.begin() : -1;
}

/// Mean of every plane over the finest level's voxels: the background of the channel's grids and
/// what a lookup away from the surface returns. The same for any thread count. 0 for a grid without
/// voxels. Planes have a value for each voxel. Error if a value on any level is infinite or not a
/// number, naming `where`, channel and level.
std::vector<float> finite_means(const TextureGrid& grid, const std::string& where);

/// The nearest half float, as a float; beyond the largest half (65504) that one, not infinity.
float nearest_half(float value) noexcept;

}  // namespace estara
