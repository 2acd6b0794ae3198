/// The shapes of a scene as traversal reads them: blocks of spheres, quads, planes and triangles, and trees over
/// blocks, and a tree over instances of objects.
///
/// Tables own their memory; a view points into them, and is all that kernels read. A view is a plain value: it may be
/// copied to where pointers mean something else. Tables are immutable once they are made, so threads share them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/bvh.h"
#include "core/geometry/instances.h"
#include "core/math/processor.h"
#include "core/math/vec.h"

namespace raypool {

/// Up to `lanes` spheres, a lane each. An unused lane has a NaN radius, which no ray hits, and no id.
template <class Scalar, int lanes>
struct alignas(64) SphereBlock {
    static constexpr int kLanes = lanes;
    Scalar center[3][lanes];
    Scalar motion[3][lanes];
    Scalar radius[lanes];
    Scalar padded_radius[lanes];  ///< half the edge of the sphere's own box: every rounding error stays inside
    std::int32_t id[lanes];
};

/// Up to `lanes` quads (or, without a box, planes). An unused lane has a NaN normal and no id.
template <class Scalar, int lanes>
struct alignas(64) PlanarBlock {
    static constexpr int kLanes = lanes;
    Scalar point[3][lanes];  ///< of the plane; coincident shapes have the same one
    Scalar normal[3][lanes];
    Scalar corner[3][lanes];  ///< what coordinates are measured from; unused by planes
    Scalar dual_u[3][lanes];  ///< unused by planes
    Scalar dual_v[3][lanes];
    Scalar low[3][lanes];  ///< the padded box; unused by planes
    Scalar high[3][lanes];
    std::int32_t id[lanes];
    std::int32_t group[lanes];  ///< what a ray leaves that leaves the shape: the id of the shapes in its plane
};

/// Up to `lanes` triangles. An unused lane has NaN vertices and no id.
template <class Scalar, int lanes>
struct alignas(64) TriangleBlock {
    static constexpr int kLanes = lanes;
    Scalar vertex[3][3][lanes];  ///< by vertex, then by axis
    std::int32_t id[lanes];      ///< of an object's triangles: their numbers in it
};

/// A tree whose leaf i is block i.
template <class Block, class Scalar, int width>
struct BlockTree {
    std::vector<WideNode<Scalar, width>> nodes;  ///< their bounds hold over all times
    /// By axis, then by node; empty where no shape moves along the axis.
    std::vector<NodeMotion<Scalar, width>> motion[3];
    std::vector<Block> blocks;
    int depth = 0;
};

/// Children of a node, and primitives of a leaf: as many as fill a register, eight where there is a choice. Single rays
/// test them all at once, streams and packets one by one against a register of rays.
template <class Scalar>
inline constexpr int kTreeWidth = std::min(8, kRegisterBytes / static_cast<int>(sizeof(Scalar)));

/// A BlockTree, seen.
template <class BlockType, class Scalar, int width>
struct TreeView {
    using Block = BlockType;
    std::span<const WideNode<Scalar, width>> nodes;
    std::span<const NodeMotion<Scalar, width>> motion[3];
    std::span<const Block> blocks;
    int depth = 0;

    TreeView() = default;
    explicit TreeView(const BlockTree<Block, Scalar, width>& tree)
        : nodes(tree.nodes),
          motion{tree.motion[0], tree.motion[1], tree.motion[2]},
          blocks(tree.blocks),
          depth(tree.depth) {}
};

/// Instances in the order of their ids, a leaf each; and the trees of all objects in one, whose roots instances name.
template <class Scalar>
struct InstanceTreeView : TreeView<InstanceRow<Scalar>, Scalar, kTreeWidth<Scalar>> {
    using Tree = TreeView<InstanceRow<Scalar>, Scalar, kTreeWidth<Scalar>>;
    using Objects = TreeView<TriangleBlock<Scalar, kTreeWidth<Scalar>>, Scalar, kTreeWidth<Scalar>>;
    Objects objects;

    InstanceTreeView() = default;
    InstanceTreeView(const Tree& tree, const Objects& of_objects) : Tree(tree), objects(of_objects) {}
};

template <class Scalar>
struct ShapeTables {
    static constexpr int kWidth = kTreeWidth<Scalar>;

    /// Spheres that span the scene, and planes: every ray tests them, before the trees.
    std::vector<SphereBlock<Scalar, kWidth>> large_spheres;
    std::vector<PlanarBlock<Scalar, kWidth>> planes;
    BlockTree<SphereBlock<Scalar, kWidth>, Scalar, kWidth> sphere_tree;
    BlockTree<PlanarBlock<Scalar, kWidth>, Scalar, kWidth> quad_tree;
    BlockTree<TriangleBlock<Scalar, kWidth>, Scalar, kWidth> triangle_tree;
    BlockTree<InstanceRow<Scalar>, Scalar, kWidth> instance_tree;
    BlockTree<TriangleBlock<Scalar, kWidth>, Scalar, kWidth> object_trees;  ///< of all objects, with their roots

    /// Calls visit(std::vector&) for every table.
    template <class Self, class Visit>
    static void for_each_table(Self& self, Visit visit) {
        visit(self.large_spheres);
        visit(self.planes);
        const auto visit_tree = [&](auto& tree) {
            visit(tree.nodes);
            for (auto& along_axis : tree.motion) visit(along_axis);
            visit(tree.blocks);
        };
        visit_tree(self.sphere_tree);
        visit_tree(self.quad_tree);
        visit_tree(self.triangle_tree);
        visit_tree(self.instance_tree);
        visit_tree(self.object_trees);
    }
};

/// ShapeTables, seen.
template <class Scalar>
struct ShapeView {
    static constexpr int kWidth = kTreeWidth<Scalar>;

    std::span<const SphereBlock<Scalar, kWidth>> large_spheres;
    std::span<const PlanarBlock<Scalar, kWidth>> planes;
    TreeView<SphereBlock<Scalar, kWidth>, Scalar, kWidth> sphere_tree;
    TreeView<PlanarBlock<Scalar, kWidth>, Scalar, kWidth> quad_tree;
    TreeView<TriangleBlock<Scalar, kWidth>, Scalar, kWidth> triangle_tree;
    InstanceTreeView<Scalar> instance_tree;

    ShapeView() = default;
    explicit ShapeView(const ShapeTables<Scalar>& tables)
        : large_spheres(tables.large_spheres),
          planes(tables.planes),
          sphere_tree(tables.sphere_tree),
          quad_tree(tables.quad_tree),
          triangle_tree(tables.triangle_tree),
          instance_tree(typename InstanceTreeView<Scalar>::Tree(tables.instance_tree),
                        typename InstanceTreeView<Scalar>::Objects(tables.object_trees)) {}

    /// Calls visit(std::span&) for every table that is seen, in the order of ShapeTables::for_each_table().
    template <class Self, class Visit>
    static void for_each_span(Self& self, Visit visit) {
        visit(self.large_spheres);
        visit(self.planes);
        const auto visit_tree = [&](auto& tree) {
            visit(tree.nodes);
            for (auto& along_axis : tree.motion) visit(along_axis);
            visit(tree.blocks);
        };
        visit_tree(self.sphere_tree);
        visit_tree(self.quad_tree);
        visit_tree(self.triangle_tree);
        visit_tree(self.instance_tree);
        visit_tree(self.instance_tree.objects);
    }
};

}  // namespace raypool
