// Chances by areas, of a tree that can be reckoned by hand.
#include "bench/studies/tree_quality.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace raypool::studies {
namespace {

/// An empty node, of which children are set.
auto node_of(std::initializer_list<std::pair<Box, std::int32_t>> children) {
    constexpr int kWidth = kTreeWidth<float>;
    WideNode<float, kWidth> node{};
    for (int axis = 0; axis < 3; ++axis) {
        std::fill_n(node.bounds[axis][0], kWidth, std::numeric_limits<float>::infinity());
        std::fill_n(node.bounds[axis][1], kWidth, -std::numeric_limits<float>::infinity());
    }
    int lane = 0;
    for (const auto& [box, child] : children) {
        for (int axis = 0; axis < 3; ++axis) {
            node.bounds[axis][0][lane] = static_cast<float>(box.low[axis]);
            node.bounds[axis][1][lane] = static_cast<float>(box.high[axis]);
        }
        node.child[lane++] = child;
    }
    return node;
}

auto block_of(int shapes) {
    TriangleBlock<float, kTreeWidth<float>> block{};
    std::fill(std::begin(block.id), std::end(block.id), kNoPrimitive);
    std::fill_n(block.id, shapes, 7);
    return block;
}

TEST(TreeQuality, IsWhatARandomLineMeets) {
    const Box left{{0, 0, 0}, {1, 1, 1}};   // 6 of the root's 10
    const Box right{{1, 0, 0}, {2, 1, 1}};  // as large
    const Box part{{1, 0, 0}, {1, 1, 1}};   // a square, of area 2
    TriangleTree<float> tree;
    tree.nodes = {node_of({{left, ~0}, {right, 1}}), node_of({{right, ~1}, {part, ~2}})};
    constexpr int kWidth = kTreeWidth<float>;
    tree.blocks = {block_of(kWidth), block_of(2), block_of(2)};
    const TreeQuality quality = tree_quality(tree);
    EXPECT_DOUBLE_EQ(quality.nodes, 1 + 0.6);
    EXPECT_DOUBLE_EQ(quality.leaves, 0.6 + 0.6 + 0.2);
    EXPECT_DOUBLE_EQ(quality.leaf_fill, (kWidth + 4.0) / (3 * kWidth));
}

TEST(TreeQuality, OfNothingIsNothing) {
    const TreeQuality quality = tree_quality({});
    EXPECT_EQ(quality.nodes + quality.leaves + quality.leaf_fill, 0);
}

}  // namespace
}  // namespace raypool::studies
