#include "bench/studies/tree_quality.h"

#include <algorithm>

namespace raypool::studies {

namespace {

template <class Node>
Box child_box(const Node& node, int lane) {
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = node.bounds[axis][0][lane];
        box.high[axis] = node.bounds[axis][1][lane];
    }
    return box;
}

}  // namespace

TreeQuality tree_quality(const TriangleTree<float>& tree) {
    constexpr int kWidth = kTreeWidth<float>;
    TreeQuality quality;
    if (tree.nodes.empty()) return quality;
    Box root;
    for (int lane = 0; lane < kWidth; ++lane) root.extend(child_box(tree.nodes[0], lane));
    quality.nodes = 1;
    for (const auto& node : tree.nodes) {
        for (int lane = 0; lane < kWidth; ++lane) {  // an unused lane's box has no area
            const double chance = child_box(node, lane).area() / root.area();
            (node.child[lane] < 0 ? quality.leaves : quality.nodes) += chance;
        }
    }
    std::ptrdiff_t shapes = 0;
    for (const auto& block : tree.blocks)
        shapes += std::count_if(block.id, block.id + kWidth, [](std::int32_t id) { return id != kNoPrimitive; });
    quality.leaf_fill = static_cast<double>(shapes) / static_cast<double>(tree.blocks.size() * kWidth);
    return quality;
}

}  // namespace raypool::studies
