#include "core/shading/triangle_trees.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/geometry/triangles.h"
#include "core/shading/block_tree.h"

namespace raypool {

template <class Scalar>
TriangleTree<Scalar> triangle_tree(const SceneTables<Scalar>& tables, const TriangleRows& rows, std::int32_t first_id,
                                   const BuildBvh& build) {
    constexpr int kWidth = kTreeWidth<Scalar>;
    const auto vertices_of = [&](std::uint32_t triangle) {
        std::array<Vec3<Scalar>, 3> vertices;
        for (int i = 0; i < 3; ++i) {
            const auto vertex = static_cast<std::size_t>(bits_of<Scalar>(tables.triangles[triangle].value[i]));
            const Scalar* position = tables.vertices[vertex].value;
            vertices[i] = vec3<Scalar>(position[0], position[1], position[2]);
        }
        return vertices;
    };
    detail::Ids ids;
    for (std::uint32_t i = rows.first; i < rows.first + rows.count; ++i)
        if (triangle_normal<Scalar>(vertices_of(i)).allFinite()) ids.push_back(i);
    const auto box_of = [&](std::uint32_t triangle) {
        Vec3<Scalar> low;
        Vec3<Scalar> high;
        triangle_box<Scalar>(vertices_of(triangle), low, high);
        return Box{low.template cast<double>(), high.template cast<double>()};
    };
    return detail::block_tree<TriangleBlock<Scalar, kWidth>, Scalar, kWidth>(
        build(detail::boxes_by_id(ids, box_of), kWidth), ids, [&](std::span<const std::uint32_t> in_leaf) {
            TriangleBlock<Scalar, kWidth> block;
            for (auto& vertex : block.vertex)
                for (auto& axis : vertex) std::fill_n(axis, kWidth, std::numeric_limits<Scalar>::quiet_NaN());
            std::fill_n(block.id, kWidth, kNoPrimitive);
            for (std::size_t lane = 0; lane < in_leaf.size(); ++lane) {
                const std::array<Vec3<Scalar>, 3> vertices = vertices_of(in_leaf[lane]);
                for (int i = 0; i < 3; ++i)
                    for (int axis = 0; axis < 3; ++axis) block.vertex[i][axis][lane] = vertices[i][axis];
                block.id[lane] = first_id + static_cast<std::int32_t>(in_leaf[lane] - rows.first);
            }
            return block;
        });
}

namespace {

/// Puts the tree of an object behind those of others, and returns its root, or kNoPrimitive for none.
template <class Scalar>
std::int32_t append(TriangleTree<Scalar> tree, TriangleTree<Scalar>& all) {
    if (tree.nodes.empty()) return kNoPrimitive;
    const auto first_node = static_cast<std::int32_t>(all.nodes.size());
    const auto first_block = static_cast<std::int32_t>(all.blocks.size());
    for (WideNode<Scalar, kTreeWidth<Scalar>>& node : tree.nodes) {
        for (std::int32_t& child : node.child)
            if (child != 0) child += child > 0 ? first_node : -first_block;  // no node has the root as its child
        all.nodes.push_back(node);
    }
    all.blocks.insert(all.blocks.end(), tree.blocks.begin(), tree.blocks.end());
    all.depth = std::max(all.depth, tree.depth);
    return first_node;
}

/// Holds the boxes of all triangles where they stand: with room for theirs, and for the rounding of vertices.
template <class Scalar>
Box instance_box(const InstanceRow<Scalar>& instance, const Box& object) {
    using Row = InstanceRow<Scalar>;
    const Vector3d middle = 0.5 * (object.low + object.high);
    const Vector3d half = 0.5 * (object.high - object.low);
    const Vector3d reach = object.low.cwiseAbs().cwiseMax(object.high.cwiseAbs());
    Box box;
    for (int i = 0; i < 3; ++i) {
        Vector3d row;
        for (int k = 0; k < 3; ++k) row[k] = static_cast<double>(instance.value[Row::kTransform + 4 * i + k]);
        const auto offset = static_cast<double>(instance.value[Row::kTransform + 4 * i + 3]);
        const double room = 32 * static_cast<double>(std::numeric_limits<Scalar>::epsilon()) *
                            (row.cwiseAbs().dot(reach) + std::abs(offset));
        const double extent = row.cwiseAbs().dot(half) + room;
        box.low[i] = static_cast<double>(static_cast<Scalar>(row.dot(middle) + offset - extent));
        box.high[i] = static_cast<double>(static_cast<Scalar>(row.dot(middle) + offset + extent));
    }
    return box;
}

/// Instances of what has no triangle with an area are in no leaf.
template <class Scalar>
void add_instances(const std::map<std::int32_t, std::pair<std::int32_t, Box>>& object_of, SceneTables<Scalar>& tables) {
    constexpr int kWidth = kTreeWidth<Scalar>;
    using Row = InstanceRow<Scalar>;
    detail::Ids ids;
    std::vector<Box> boxes;
    std::vector<Row>& instances = tables.instance_tree.blocks;
    for (std::size_t i = 0; i < instances.size(); ++i) {
        const auto& [root, box] = object_of.at(instances[i].number(Row::kFirstTriangle));
        if (root == kNoPrimitive) continue;
        instances[i].value[Row::kRoot] = of_bits<Scalar>(static_cast<Int<Scalar>>(root));
        ids.push_back(static_cast<std::uint32_t>(i));
        boxes.push_back(instance_box(instances[i], box));
    }
    WideBvh<Scalar, kWidth> bvh = collapse<Scalar, kWidth>(build_binary_bvh(boxes, 1));
    for (WideNode<Scalar, kWidth>& node : bvh.nodes) {
        for (std::int32_t& child : node.child)
            if (child < 0)
                child = ~static_cast<std::int32_t>(ids[bvh.order[bvh.leaves[static_cast<std::size_t>(~child)].first]]);
    }
    tables.instance_tree.nodes = std::move(bvh.nodes);
    tables.instance_tree.depth = bvh.depth;
}

}  // namespace

template <class Scalar>
void add_triangle_trees(std::int32_t first_triangle, std::span<const ObjectRows> objects, SceneTables<Scalar>& tables) {
    const std::size_t alone = objects.empty() ? tables.triangles.size() : objects.front().first;
    tables.triangle_tree =
        triangle_tree(tables, {0, static_cast<std::uint32_t>(alone)}, first_triangle, build_binary_bvh);
    std::map<std::int32_t, std::pair<std::int32_t, Box>> object_of;  // by the first row: the root, and the box
    for (const ObjectRows& rows : objects)
        object_of[static_cast<std::int32_t>(rows.first)] = {
            append<Scalar>(triangle_tree(tables, rows, 0, build_binary_bvh), tables.object_trees), rows.box};
    add_instances(object_of, tables);
}

template TriangleTree<float> triangle_tree(const SceneTables<float>&, const TriangleRows&, std::int32_t,
                                           const BuildBvh&);
template TriangleTree<double> triangle_tree(const SceneTables<double>&, const TriangleRows&, std::int32_t,
                                            const BuildBvh&);
template void add_triangle_trees(std::int32_t, std::span<const ObjectRows>, SceneTables<float>&);
template void add_triangle_trees(std::int32_t, std::span<const ObjectRows>, SceneTables<double>&);

}  // namespace raypool
