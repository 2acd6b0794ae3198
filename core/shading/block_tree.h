/// Trees over blocks of shapes: boxes, a binary tree over them, the wide tree of it, and a block for each leaf. Called
/// by what fills the tables of shapes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/geometry/bvh.h"
#include "core/geometry/shape_tables.h"

namespace raypool::detail {

/// Shapes that are worth more than one thread.
inline constexpr std::size_t kFewestShapes = 16384;

using Ids = std::vector<std::uint32_t>;

template <class BoxOf>
std::vector<Box> boxes_by_id(const Ids& ids, BoxOf box_of) {
    std::vector<Box> boxes(ids.size());
#pragma omp parallel for schedule(static) if (ids.size() > kFewestShapes)
    for (std::size_t i = 0; i < ids.size(); ++i) boxes[i] = box_of(ids[i]);
    return boxes;
}

/// Over shapes of `ids`; the binary tree is over their places there. make_block(ids of a leaf) throws nothing.
template <class Block, class Scalar, int width, class MakeBlock>
BlockTree<Block, Scalar, width> block_tree(const BinaryBvh& binary, const Ids& ids, MakeBlock make_block) {
    WideBvh<Scalar, width> bvh = collapse<Scalar, width>(binary);
    BlockTree<Block, Scalar, width> tree;
    tree.blocks.resize(bvh.leaves.size());
#pragma omp parallel for schedule(static) if (ids.size() > kFewestShapes)
    for (std::size_t i = 0; i < bvh.leaves.size(); ++i) {
        const auto& leaf = bvh.leaves[i];
        std::array<std::uint32_t, width> in_leaf;
        for (std::uint32_t k = 0; k < leaf.count; ++k) in_leaf[k] = ids[bvh.order[leaf.first + k]];
        tree.blocks[i] = make_block(std::span(in_leaf).first(leaf.count));
    }
    tree.nodes = std::move(bvh.nodes);
    tree.depth = bvh.depth;
    return tree;
}

}  // namespace raypool::detail
