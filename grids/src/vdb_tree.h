// The nodes of a tree in a .vdb file, after OpenVDB 10's RootNode, InternalNode and LeafNode:
//
//   buffers i32 | background | tiles u32 | children u32 | tiles | children
//   tile of the root   origin 3 i32 | value | is active u8
//   child of the root  origin 3 i32 | node of 32^3 entries
//   node               child mask | value mask | values | children
//   leaf               value mask
//   and then, at the grid's position of buffers, for each leaf: value mask | values
//
// OpenVDB allocates and believes; here every size is checked, and leaves can be read by any number
// of threads.
#pragma once

#include <glm/glm.hpp>

#include <string>
#include <vector>

#include "estara/grids/texture_grid.h"
#include "vdb_bytes.h"
#include "vdb_values.h"

namespace estara {

/// Tells whether a comes before b in the order in which OpenVDB keeps leaves: by node of 4096
/// voxels, then of 128, then of 8.
/// @param a, b  origins of leaves
bool comes_before_in_tree(const glm::ivec3& a, const glm::ivec3& b) noexcept;

/// 8^3 voxels in a file.
struct StoredLeaf {
    glm::ivec3 origin{0};
    BlockMask active;
    StoredValues values;
};

/// What is wrong with a tree's bytes, in words that go after "grid X ".
struct BadTree {
    std::string what;
};

/// Reads where the leaves of a tree are, in file order. Throws Cut and BadTree; a tree with active
/// tiles, or indices outside [0, 2^30), is bad.
/// @param topology  at the tree's first byte; its bytes end where those of the buffers begin
/// @param buffers   at the first leaf's; its bytes end where the grid does
std::vector<StoredLeaf> read_leaves(ByteCursor topology, ByteCursor buffers,
                                    const ValueFormat& format);

}  // namespace estara
