// Trees by Embree's builder are binary trees as ours: each box in one leaf, within every box above it.
#include "bench/peers/embree_bvh.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

std::vector<Box> random_boxes(int count) {
    RandomInputs random(1);
    std::vector<Box> boxes;
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d center = random.point<double>(10);
        const double half_edge = std::exp(random.uniform(-8, 0));
        Box box;  // exact in float
        box.low = (center.array() - half_edge).cast<float>().cast<double>();
        box.high = (center.array() + half_edge).cast<float>().cast<double>();
        boxes.push_back(box);
    }
    return boxes;
}

bool holds(const Box& outer, const Box& inner) {
    return (outer.low.array() <= inner.low.array()).all() && (outer.high.array() >= inner.high.array()).all();
}

void check_subtree(const BinaryBvh& tree, const std::vector<Box>& boxes, std::uint32_t index, std::uint32_t block,
                   std::vector<int>& uses) {
    const BinaryBvh::Node& node = tree.nodes.at(index);
    EXPECT_LE(node.count, block);
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const std::uint32_t box = tree.order.at(i);
        ++uses.at(box);
        EXPECT_TRUE(holds(node.box, boxes.at(box)));
    }
    if (node.count > 0) return;
    for (const std::uint32_t child : {node.left, node.left + 1}) {
        EXPECT_TRUE(holds(node.box, tree.nodes.at(child).box));
        check_subtree(tree, boxes, child, block, uses);
    }
}

TEST(EmbreeBvh, HoldsEveryBoxInOneLeafWithinTheBoxesAbove) {
    for (const int count : {1, 2, 8, 9, 100, 20'000}) {
        for (const std::uint32_t block : {1U, 8U}) {
            for (const int threads : {1, 2}) {
                const std::vector<Box> boxes = random_boxes(count);
                const BinaryBvh tree = peers::embree_bvh(boxes, block, threads).tree;
                std::vector<int> uses(boxes.size());
                check_subtree(tree, boxes, 0, block, uses);
                EXPECT_EQ(uses, std::vector<int>(boxes.size(), 1)) << count << " boxes, " << block << " in a leaf";
            }
        }
    }
}

TEST(EmbreeBvh, IsEmptyOverNothing) {
    EXPECT_TRUE(peers::embree_bvh({}, 8, 1).tree.nodes.empty());
}

}  // namespace
}  // namespace raypool::test
