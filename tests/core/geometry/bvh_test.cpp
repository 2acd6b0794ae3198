/// Trees of boxes: everything in exactly one leaf, within every box above it, at bounded depth; and a closest hit that
/// does not depend on the tree's shape.
#include "core/geometry/bvh.h"

#include <bit>

#include <gtest/gtest.h>

#include "core/geometry/shapes.h"
#include "core/geometry/traverse.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

using Boxes = std::vector<Box>;

Box box_around(const Eigen::Vector3d& center, double half_edge) {
    return {center.array() - half_edge, center.array() + half_edge};
}
Boxes random_boxes(int count, std::uint64_t seed) {
    RandomInputs random(seed);
    Boxes boxes;
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d center = random.point<double>(10);
        boxes.push_back(box_around(center, std::exp(random.uniform(-8, 0))));
    }
    return boxes;
}
Boxes coincident_boxes(int count) {
    return Boxes(static_cast<std::size_t>(count), box_around({1, 2, 3}, 0.5));
}
/// Each twice as far as the one before, along all axes, over the whole range of double.
Boxes exponentially_spaced_boxes() {
    Boxes boxes;
    for (int exponent = -1000; exponent < 900; ++exponent) {
        for (int axis = 0; axis < 3; ++axis) {
            Eigen::Vector3d center = Eigen::Vector3d::Zero();
            center[axis] = std::ldexp(1.0, exponent);
            boxes.push_back(box_around(center, std::ldexp(0.1, exponent)));
        }
    }
    return boxes;
}

bool holds(const Box& outer, const Box& inner) {
    return (outer.low.array() <= inner.low.array()).all() && (outer.high.array() >= inner.high.array()).all();
}

/// Checks the subtree and returns its depth.
int check_subtree(const BinaryBvh& tree, const Boxes& boxes, std::uint32_t index, std::uint32_t block,
                  std::vector<int>& uses) {
    const BinaryBvh::Node& node = tree.nodes.at(index);
    if (node.count == 0) {
        int depth = 0;
        for (const std::uint32_t child : {node.left, node.left + 1}) {
            EXPECT_TRUE(holds(node.box, tree.nodes.at(child).box));
            depth = std::max(depth, check_subtree(tree, boxes, child, block, uses));
        }
        return depth + 1;
    }
    EXPECT_LE(node.count, block);
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const std::uint32_t box = tree.order.at(i);
        ++uses.at(box);
        EXPECT_TRUE(holds(node.box, boxes.at(box)));
    }
    return 1;
}
int check_tree(const Boxes& boxes, std::uint32_t block) {
    const BinaryBvh tree = build_binary_bvh(boxes, block);
    std::vector<int> uses(boxes.size());
    const int depth = check_subtree(tree, boxes, 0, block, uses);
    EXPECT_EQ(uses, std::vector<int>(boxes.size(), 1));
    return depth;
}

TEST(BinaryBvh, HoldsEveryBoxInOneLeafWithinTheBoxesAbove) {
    for (const int count : {1, 2, 7, 8, 9, 100, 3000})
        for (const std::uint32_t block : {1U, 4U, 8U}) check_tree(random_boxes(count, 1), block);
}

TEST(BinaryBvh, IsEmptyOverNothing) {
    EXPECT_TRUE(build_binary_bvh({}, 8).nodes.empty());
    EXPECT_TRUE((collapse<float, 8>(build_binary_bvh({}, 8)).nodes.empty()));
}

TEST(BinaryBvh, HalvesWhatCannotBeSplitByPlace) {
    EXPECT_LE(check_tree(coincident_boxes(4096), 1), 14);
}

/// The heuristic splits off one box a level as long as it is asked, and what is left then has no place to be split by.
Boxes boxes_that_make_a_deep_tree(int coincident) {
    Boxes boxes(static_cast<std::size_t>(coincident), box_around(Eigen::Vector3d::Zero(), 0.5));
    for (int i = 1; i <= 2 * kMostSahLevels; ++i) boxes.push_back(box_around({std::ldexp(1.0, 8 * i), 0, 0}, 0.5));
    return boxes;
}

/// Entries that a traversal's stack needs where a ray meets every box and the worst child is always the nearest.
template <int width>
int stack_needed(const WideBvh<double, width>& tree, std::int32_t child) {
    if (child < 0) return 1;
    const auto& node = tree.nodes.at(static_cast<std::size_t>(child));
    int children = 0;
    int most = 0;
    for (int lane = 0; lane < width; ++lane) {
        if (node.bounds[0][0][lane] > node.bounds[0][1][lane]) continue;
        ++children;
        most = std::max(most, stack_needed(tree, node.child[lane]));
    }
    return children - 1 + most;
}

TEST(BinaryBvh, IsNoDeeperThanItsBuilderCanMakeItWhateverTheBoxes) {
    for (const Boxes& boxes :
         {exponentially_spaced_boxes(), boxes_that_make_a_deep_tree(1), boxes_that_make_a_deep_tree(1000)}) {
        const int halves = std::bit_width(boxes.size() - 1);
        for (const std::uint32_t block : {1U, 4U}) {
            const int levels = check_tree(boxes, block);  // with that of the leaves
            EXPECT_LE(levels, kMostSahLevels + halves + 1);
            EXPECT_GT(levels, kMostSahLevels) << "these boxes would not need the limit";
            const auto wide = collapse<double, 4>(build_binary_bvh(boxes, block));
            EXPECT_LE(wide.depth, levels - 1);
            EXPECT_LE(stack_needed(wide, 0), kTraversalStack<4>);
            EXPECT_LE(stack_needed(wide, 0), (kMostSahLevels + halves) * 3 + 1);
        }
    }
    const int ten = check_tree(boxes_that_make_a_deep_tree(1024), 1);
    EXPECT_GE(ten, kMostSahLevels + 10) << "the halves come on top of the heuristic's levels";
}

/// What the stack relies on: the most boxes that the builder takes, halved to one.
static_assert((kMostBoxes >> static_cast<unsigned>(kMostTreeLevels - kMostSahLevels)) <= 1);
static_assert(kTraversalStack<8> == kMostTreeLevels * 7 + 1);

template <int width>
void check_wide(const Boxes& boxes, std::uint32_t block) {
    const WideBvh<float, width> tree = collapse<float, width>(build_binary_bvh(boxes, block));
    std::vector<int> node_uses(tree.nodes.size());
    std::vector<int> leaf_uses(tree.leaves.size());
    std::vector<int> box_uses(boxes.size());
    ++node_uses.at(0);
    for (const WideNode<float, width>& node : tree.nodes) {
        for (int lane = 0; lane < width; ++lane) {
            Box bounds;
            for (int axis = 0; axis < 3; ++axis) {
                bounds.low[axis] = node.bounds[axis][0][lane];
                bounds.high[axis] = node.bounds[axis][1][lane];
            }
            if (bounds.low[0] > bounds.high[0]) continue;  // unused
            const std::int32_t child = node.child[lane];
            if (child >= 0) {
                ++node_uses.at(static_cast<std::size_t>(child));
                continue;
            }
            ++leaf_uses.at(static_cast<std::size_t>(~child));
            const auto& leaf = tree.leaves.at(static_cast<std::size_t>(~child));
            for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
                ++box_uses.at(tree.order.at(i));
                EXPECT_TRUE(holds(bounds, boxes.at(tree.order.at(i))));
            }
        }
    }
    EXPECT_EQ(node_uses, std::vector<int>(node_uses.size(), 1));
    EXPECT_EQ(leaf_uses, std::vector<int>(leaf_uses.size(), 1));
    EXPECT_EQ(box_uses, std::vector<int>(box_uses.size(), 1));
}

/// Boxes that float holds exactly, as compile() makes them. (Not by a cast to float and back: gcc 12 takes both away.)
Boxes in_float(Boxes boxes) {
    for (Box& box : boxes) {
        for (int axis = 0; axis < 3; ++axis) {
            box.low[axis] = std::nextafter(static_cast<float>(box.low[axis]), -kInfinity<float>);
            box.high[axis] = std::nextafter(static_cast<float>(box.high[axis]), kInfinity<float>);
        }
    }
    return boxes;
}

TEST(WideBvh, ReachesEveryLeafOnce) {
    for (const int count : {1, 2, 8, 9, 64, 65, 3000}) {
        for (const std::uint32_t block : {1U, 8U}) {
            check_wide<4>(in_float(random_boxes(count, 2)), block);
            check_wide<8>(in_float(random_boxes(count, 3)), block);
        }
    }
    check_wide<8>(coincident_boxes(1000), 8);
}

/// Spheres, their own boxes, and a walk in no good order through any tree.
struct Spheres {
    std::vector<Vec3<float>> center;
    std::vector<float> radius;

    [[nodiscard]] float padded(int i) const {
        return radius[i] * (1 + 0x1p-20F) + 0x1p-20F * center[i].cwiseAbs().maxCoeff();
    }
    [[nodiscard]] Vec3<float> low(int i) const { return (center[i].array() - padded(i)).matrix(); }
    [[nodiscard]] Vec3<float> high(int i) const { return (center[i].array() + padded(i)).matrix(); }

    void keep_closest(int i, const Ray<float>& ray, const RayInverse<float>& inverse, Hit<float>& hit) const {
        const float t = sphere_distance<float>(ray.origin, ray.direction, center[i], radius[i], false);
        if (t == kInfinity<float> || !is_inside_box<float>(low(i), high(i), ray.origin, inverse, t)) return;
        if (t < hit.t || (t == hit.t && i < hit.primitive_id)) hit = {t, i};
    }
};

template <int width>
Hit<float> walk(const WideBvh<float, width>& tree, const Spheres& spheres, const Ray<float>& ray) {
    const RayInverse<float> inverse = ray_inverse<float>(ray.direction);
    Hit<float> hit;
    std::vector<std::int32_t> open{0};
    while (!open.empty()) {
        const std::int32_t child = open.back();
        open.pop_back();
        if (child < 0) {
            const auto& leaf = tree.leaves[static_cast<std::size_t>(~child)];
            for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i)
                spheres.keep_closest(static_cast<int>(tree.order[i]), ray, inverse, hit);
            continue;
        }
        const auto& node = tree.nodes[static_cast<std::size_t>(child)];
        for (int lane = 0; lane < width; ++lane) {
            Vec3<float> near;
            Vec3<float> far;
            for (int axis = 0; axis < 3; ++axis) {
                near[axis] = node.bounds[axis][inverse.is_negative[axis] ? 1 : 0][lane];
                far[axis] = node.bounds[axis][inverse.is_negative[axis] ? 0 : 1][lane];
            }
            const Interval<float> inside = box_interval<float>(near, far, ray.origin, inverse, hit.t);
            if (inside.enter <= inside.exit) open.push_back(node.child[lane]);
        }
    }
    return hit;
}

TEST(ClosestHit, IsTheSameInTreesOfAnyShape) {
    RandomInputs random(4);
    Spheres spheres;
    Boxes tight;
    Boxes loose;
    constexpr int kCount = 400;
    for (int i = 0; i < kCount; ++i) {
        spheres.center.push_back((random.point<double>(4) + Eigen::Vector3d(2000, 0, -300)).cast<float>());
        spheres.radius.push_back(static_cast<float>(std::exp(random.uniform(-9, 0))));
        if (i % 5 == 4) spheres.center.back() = spheres.center[i / 2], spheres.radius.back() = spheres.radius[i / 2];
        tight.push_back({spheres.low(i).cast<double>(), spheres.high(i).cast<double>()});
        loose.push_back(
            {tight.back().low.array() - random.uniform(0, 3), tight.back().high.array() + random.uniform(0, 3)});
    }
    loose = in_float(loose);

    const auto tree8 = collapse<float, 8>(build_binary_bvh(tight, 8));
    const auto fine8 = collapse<float, 8>(build_binary_bvh(tight, 1));
    const auto tree4 = collapse<float, 4>(build_binary_bvh(tight, 4));
    const auto fine4 = collapse<float, 4>(build_binary_bvh(tight, 2));
    const auto loose8 = collapse<float, 8>(build_binary_bvh(loose, 3));
    int hits = 0;
    for (int i = 0; i < kInputs / 50; ++i) {
        const int target = random.below(kCount);
        const Vec3<float> origin = spheres.center[random.below(kCount)] + random.point<float>(2);
        const Vec3<float> rim = spheres.center[target] + spheres.radius[target] * random.direction<float>();
        const Ray<float> ray{origin, unit<float>(rim - origin), 0};
        const RayInverse<float> inverse = ray_inverse<float>(ray.direction);
        Hit<float> expected;
        for (int k = 0; k < kCount; ++k) spheres.keep_closest(k, ray, inverse, expected);
        hits += expected.primitive_id != kNoPrimitive ? 1 : 0;
        for (const Hit<float>& hit : {walk(tree8, spheres, ray), walk(fine8, spheres, ray), walk(tree4, spheres, ray),
                                      walk(fine4, spheres, ray), walk(loose8, spheres, ray)}) {
            ASSERT_EQ(hit.t, expected.t);
            ASSERT_EQ(hit.primitive_id, expected.primitive_id);
        }
    }
    EXPECT_GT(hits, kInputs / 200);
}

}  // namespace
}  // namespace raypool::test
