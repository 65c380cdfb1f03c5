#include "vdb_shell.h"

#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "vdb_tree.h"

namespace estara {
namespace {

using openvdb::Coord;

/// -1 and 1 in place of distances, a byte each.
using SignTree = openvdb::tree::Tree4<std::int8_t, 5, 4, 3>::Type;
/// The same with leaves of 2^3 values in place of 8^3, for the first and the last are all that
/// nodes above want to know. Its coordinates are a quarter.
using CornerTree = openvdb::tree::Tree4<std::int8_t, 5, 4, 1>::Type;
constexpr int corner_shift = 2;

Coord coord(const glm::ivec3& p) { return {p.x, p.y, p.z}; }

template <class Leaf>
void set_active(const BlockMask& active, Leaf& leaf) {
    typename Leaf::NodeMaskType mask;
    for (openvdb::Index w = 0; w < 8; ++w) {
        mask.template getWord<std::uint64_t>(w) = active.words[w];
    }
    leaf.setValueMask(mask);
}

/// Adds leaves to a tree in the order of blocks.
/// @param make  make(block index) returns a new leaf; called by many threads
template <class TreeT, class Make>
void add_leaves(std::size_t count, const Make& make, TreeT& to) {
    std::vector<std::unique_ptr<typename TreeT::LeafNodeType>> leaves(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t b) { leaves[b] = make(b); });
    for (auto& leaf : leaves) to.addLeaf(leaf.release());
}

template <class GridT>
typename GridT::Ptr shell(const std::vector<const Block*>& blocks,
                          const typename GridT::ValueType& background) {
    using Leaf = typename GridT::TreeType::LeafNodeType;
    auto grid = GridT::create(background);
    const auto make = [&](std::size_t b) {
        auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), coord(blocks[b]->origin));
        set_active(blocks[b]->active, *leaf);
        return leaf;
    };
    add_leaves(blocks.size(), make, grid->tree());
    return grid;
}

/// Signs of a block's voxels, flood-filled from the active ones.
std::unique_ptr<SignTree::LeafNodeType> signs(const Block& block,
                                              const std::function<float(std::uint64_t)>& value) {
    auto leaf = std::make_unique<SignTree::LeafNodeType>(coord(block.origin), std::int8_t{1});
    set_active(block.active, *leaf);
    std::uint64_t row = block.first;
    for_each_bit(block.active, [&](int x, int y, int z) {
        const auto sign = std::int8_t(value(row++) < 0.0f ? -1 : 1);
        leaf->buffer().setValue(openvdb::Index(BlockMask::bit(x, y, z)), sign);
    });
    openvdb::tools::SignedFloodFillOp<SignTree>(std::int8_t{1}, std::int8_t{-1})(*leaf);
    return leaf;
}

BlockMask negative_inactive(const SignTree::LeafNodeType& leaf) {
    BlockMask mask;
    for (auto voxel = leaf.cbeginValueOff(); voxel; ++voxel) {
        if (*voxel < 0) mask.set(int(voxel.pos()));
    }
    return mask;
}

}  // namespace

std::vector<const Block*> in_tree_order(const GridLevel& level) {
    std::vector<const Block*> blocks(level.blocks.size());
    std::transform(level.blocks.begin(), level.blocks.end(), blocks.begin(),
                   [](const Block& block) { return &block; });
    std::sort(blocks.begin(), blocks.end(), [](const Block* a, const Block* b) {
        return comes_before_in_tree(a->origin, b->origin);
    });
    return blocks;
}

openvdb::FloatGrid::Ptr number_shell(const std::vector<const Block*>& blocks, float background) {
    return shell<openvdb::FloatGrid>(blocks, background);
}

openvdb::Vec3SGrid::Ptr color_shell(const std::vector<const Block*>& blocks,
                                    const openvdb::Vec3s& background) {
    return shell<openvdb::Vec3SGrid>(blocks, background);
}

std::vector<BlockMask> fill_inside(const std::vector<const Block*>& blocks,
                                   const std::function<float(std::uint64_t)>& value,
                                   openvdb::FloatGrid& to) {
    std::vector<BlockMask> inside(blocks.size());
    CornerTree tree(1);
    const auto corners = [&](std::size_t b) {
        const auto filled = signs(*blocks[b], value);
        inside[b] = negative_inactive(*filled);
        using Leaf = CornerTree::LeafNodeType;
        const Coord origin = coord(blocks[b]->origin >> corner_shift);
        auto leaf = std::make_unique<Leaf>(origin, std::int8_t{1});
        leaf->setValueOn(0, filled->getFirstValue());
        leaf->setValueOn(Leaf::SIZE - 1, filled->getLastValue());
        return leaf;
    };
    add_leaves(blocks.size(), corners, tree);
    openvdb::tools::signedFloodFill(tree);
    auto tile = tree.cbeginValueAll();
    tile.setMaxDepth(CornerTree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        if (*tile >= 0) continue;
        const Coord at = tile.getCoord() << corner_shift;
        to.tree().addTile(openvdb::Index(tile.getLevel()), at, -to.background(), false);
    }
    return inside;
}

}  // namespace estara
