// Which triangles concern which block of voxels.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "estara/scenes/mesh.h"
#include "lattice.h"

namespace estara {

/// Blocks of 8^3 voxels and the triangles that may cross a cell around one of their voxels.
struct BlockTriangles {
    std::vector<glm::ivec3> blocks;        ///< voxel origin / 8, ascending by (x, y, z)
    std::vector<std::uint64_t> first;      ///< of a block's triangles; one more at the end
    std::vector<std::uint32_t> triangles;  ///< ascending within a block
};

/// Sorts a mesh's triangles into blocks. Cost grows with the triangles and, for large ones, with
/// the blocks they cross. Parallel; the same result for any number of threads.
BlockTriangles triangles_by_block(const Mesh& mesh, const Lattice& lattice);

}  // namespace estara
