// OpenVDB trees without values: which voxels are active, and the tiles around them. Values go from
// TextureGrid to the file directly, so a tree of them is never in memory.
#pragma once

#include <openvdb/openvdb.h>

#include <functional>
#include <vector>

#include "estara/grids/texture_grid.h"

namespace estara {

/// A level's blocks in the order of OpenVDB's leaves.
std::vector<const Block*> in_tree_order(const GridLevel& level);

/// Grids with the level's voxels. Their leaves have no buffers: such a grid can say all of itself
/// but values, and writes its topology.
openvdb::FloatGrid::Ptr number_shell(const std::vector<const Block*>& blocks, float background);
openvdb::Vec3SGrid::Ptr color_shell(const std::vector<const Block*>& blocks,
                                    const openvdb::Vec3s& background);

/// Of an inactive voxel within the surface, a level set has the value -background. Turns the tiles
/// of `shell` that are within into such, and says which voxels of its leaves are.
/// @param value  value(row) of an active voxel
/// @return       inactive voxels within, by block
std::vector<BlockMask> fill_inside(const std::vector<const Block*>& blocks,
                                   const std::function<float(std::uint64_t)>& value,
                                   openvdb::FloatGrid& shell);

}  // namespace estara
