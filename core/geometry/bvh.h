/// Bounding volume hierarchies: built once as a binary tree, then collapsed to the width that a traversal wants.
///
/// The binary tree is a binned surface-area-heuristic build (Wald, "On fast Construction of SAH-based Bounding Volume
/// Hierarchies", 2007) whose leaves are priced by the SIMD blocks they fill, not by their primitives. A moving
/// primitive is bounded over the whole shutter while the tree is built (node_motion.h then bounds it at each time). The
/// tree's shape never shows in an image (shapes.h says why).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace raypool {

/// Axis-aligned, closed; empty when low > high.
struct Box {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d high = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());

    void extend(const Box& other) {
        low = low.cwiseMin(other.low);
        high = high.cwiseMax(other.high);
    }
    [[nodiscard]] double area() const {
        const Eigen::Vector3d d = (high - low).cwiseMax(0);
        return 2 * (d.x() * d.y() + d.y() * d.z() + d.z() * d.x());
    }
};

/// Node 0 is the root. A leaf holds order[first .. first + count); an inner node has count 0 and two children.
struct BinaryBvh {
    struct Node {
        Box box;
        std::uint32_t left = 0;  ///< the right child is left + 1
        std::uint32_t first = 0;
        std::uint32_t count = 0;
    };
    std::vector<Node> nodes;           ///< empty when there are no boxes
    std::vector<std::uint32_t> order;  ///< a permutation of the boxes' indices
};

/// What bounds the depth of a tree: a node is split by the heuristic on the first so many levels, and below in halves.
inline constexpr int kMostSahLevels = 40;
/// The most boxes of a tree.
inline constexpr std::size_t kMostBoxes = std::size_t{1} << 24U;
/// The most inner nodes on a way from the root to a leaf. The heuristic may split off a box a level. Halves of n boxes,
/// the larger of them taken each time, are single boxes after ceil(log2(n)) levels.
inline constexpr int kMostTreeLevels = kMostSahLevels + std::bit_width(kMostBoxes - 1);

/// Leaves hold at most `block` boxes. At most kMostBoxes boxes.
BinaryBvh build_binary_bvh(const std::vector<Box>& boxes, std::uint32_t block);

/// One node of a tree `width` wide, as a single ray reads it: bounds[axis][0] low, [1] high, a lane a child.
template <class Scalar, int width>
struct alignas(64) WideNode {
    Scalar bounds[3][2][width];
    std::int32_t child[width];  ///< a node's index; ~index of a leaf; unused lanes have an empty box
};

/// The bounds of a node's children along one axis at a time within [0, 1]: start + time change. [0] low, [1] high.
/// Unused lanes have an empty box that stays.
template <class Scalar, int width>
struct alignas(64) NodeMotion {
    Scalar start[2][width];
    Scalar change[2][width];
};

template <class Scalar, int width>
struct WideBvh {
    /// A range of `order`.
    struct Leaf {
        std::uint32_t first;
        std::uint32_t count;
    };
    std::vector<WideNode<Scalar, width>> nodes;  ///< node 0 is the root; empty when there is nothing to hit
    std::vector<Leaf> leaves;
    std::vector<std::uint32_t> order;
    int depth = 0;  ///< levels of nodes; at most kMostTreeLevels, or 1 where the root has nothing but a leaf
};

/// Opens the largest child again and again until a node has `width` children. The boxes must be exact in Scalar.
template <class Scalar, int width>
WideBvh<Scalar, width> collapse(const BinaryBvh& tree);

}  // namespace raypool
