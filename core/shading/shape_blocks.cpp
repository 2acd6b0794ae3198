#include "core/shading/shape_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "core/geometry/large_boxes.h"
#include "core/geometry/node_motion.h"
#include "core/geometry/shape_bounds.h"
#include "core/geometry/triangles.h"

namespace raypool {

namespace {

/// Shapes that are worth more than one thread.
constexpr std::size_t kFewestShapes = 16384;

template <class Scalar>
class BlockMaker {
  public:
    BlockMaker(const Scene& scene, const Coincidence& coincidence, SceneTables<Scalar>& tables)
        : scene_(scene), coincidence_(coincidence), has_motion_(scene_features(scene).motion), tables_(tables) {}

    void add_spheres() {
        Ids ids = shown_ids(0, scene_.spheres.size());
        const auto boxes_of = [&](const Ids& of) {
            return boxes_by_id(
                of, [&](std::uint32_t id) { return sphere_box<Scalar>(scene_.spheres[id], has_motion_ ? 1 : 0); });
        };
        std::vector<Box> boxes = boxes_of(ids);
        Ids large = large_boxes(boxes, kWidth);
        if (!large.empty()) {
            for (std::uint32_t& place : large) place = ids[place];
            tables_.large_spheres.push_back(sphere_block(large));
            std::erase_if(ids,
                          [&](std::uint32_t id) { return std::find(large.begin(), large.end(), id) != large.end(); });
            boxes = boxes_of(ids);
        }
        tables_.sphere_tree = block_tree<SphereBlock<Scalar, kWidth>>(
            boxes, ids, [&](std::span<const std::uint32_t> in_leaf) { return sphere_block(in_leaf); });
        if (!has_motion_) return;
        for (int axis = 0; axis < 3; ++axis) tables_.sphere_tree.motion[axis] = node_motion(tables_.sphere_tree, axis);
    }

    void add_planars() {
        const std::size_t first_plane = scene_.spheres.size() + scene_.quads.size();
        const Ids ids = shown_ids(scene_.spheres.size(), first_plane);
        const auto box_of = [&](std::uint32_t id) {
            return quad_box<Scalar>(scene_.quads[id - scene_.spheres.size()]);
        };
        tables_.quad_tree = block_tree<PlanarBlock<Scalar, kWidth>>(
            boxes_by_id(ids, box_of), ids, [&](std::span<const std::uint32_t> in_leaf) {
                std::array<Box, kWidth> leaf_boxes;
                std::transform(in_leaf.begin(), in_leaf.end(), leaf_boxes.begin(), box_of);
                return planar_block(in_leaf, leaf_boxes);
            });
        const Ids planes = shown_ids(first_plane, first_plane + scene_.planes.size());
        for (std::size_t i = 0; i < planes.size(); i += kWidth) {
            const std::span block = std::span(planes).subspan(i, std::min<std::size_t>(kWidth, planes.size() - i));
            tables_.planes.push_back(planar_block(block, std::array<Box, kWidth>{}));
        }
    }

    void add_triangles(std::span<const ObjectRows> objects) {
        const auto alone = objects.empty() ? tables_.triangles.size() : objects.front().first;
        tables_.triangle_tree =
            triangle_tree({0, static_cast<std::uint32_t>(alone), {}}, static_cast<std::int32_t>(hidden_count()));
        std::map<std::int32_t, std::pair<std::int32_t, Box>> object_of;  // by the first row: the root, and the box
        for (const ObjectRows& rows : objects)
            object_of[static_cast<std::int32_t>(rows.first)] = {append(triangle_tree(rows, 0)), rows.box};
        add_instances(object_of);
    }

  private:
    using Ids = std::vector<std::uint32_t>;
    static constexpr int kWidth = kTreeWidth<Scalar>;

    /// Of the ids in [first, end), those of shapes that no earlier one hides.
    [[nodiscard]] Ids shown_ids(std::size_t first, std::size_t end) const {
        Ids ids;
        for (std::size_t id = first; id < end; ++id)
            if (!coincidence_.is_hidden[id]) ids.push_back(static_cast<std::uint32_t>(id));
        return ids;
    }

    [[nodiscard]] std::size_t hidden_count() const { return coincidence_.is_hidden.size(); }

    using TriangleTree = BlockTree<TriangleBlock<Scalar, kWidth>, Scalar, kWidth>;
    /// Of the triangles in `rows`, whose ids count from `first_id`. Those without an area are not there.
    TriangleTree triangle_tree(const ObjectRows& rows, std::int32_t first_id) const {
        Ids ids;
        for (std::uint32_t i = rows.first; i < rows.first + rows.count; ++i)
            if (triangle_normal<Scalar>(vertices_of(i)).allFinite()) ids.push_back(i);
        const auto box_of = [&](std::uint32_t triangle) {
            Vec3<Scalar> low;
            Vec3<Scalar> high;
            triangle_box<Scalar>(vertices_of(triangle), low, high);
            return Box{low.template cast<double>(), high.template cast<double>()};
        };
        return block_tree<TriangleBlock<Scalar, kWidth>>(
            boxes_by_id(ids, box_of), ids, [&](std::span<const std::uint32_t> in_leaf) {
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

    /// Puts the tree of an object behind those of others, and returns its root, or kNoPrimitive for none.
    std::int32_t append(TriangleTree tree) {
        if (tree.nodes.empty()) return kNoPrimitive;
        TriangleTree& all = tables_.object_trees;
        const auto first_node = static_cast<std::int32_t>(all.nodes.size());
        const auto first_block = static_cast<std::int32_t>(all.blocks.size());
        for (WideNode<Scalar, kWidth>& node : tree.nodes) {
            for (std::int32_t& child : node.child)
                if (child != 0) child += child > 0 ? first_node : -first_block;  // no node has the root as its child
            all.nodes.push_back(node);
        }
        all.blocks.insert(all.blocks.end(), tree.blocks.begin(), tree.blocks.end());
        all.depth = std::max(all.depth, tree.depth);
        return first_node;
    }

    /// Instances of what has no triangle with an area are in no leaf.
    void add_instances(const std::map<std::int32_t, std::pair<std::int32_t, Box>>& object_of) {
        using Row = InstanceRow<Scalar>;
        Ids ids;
        std::vector<Box> boxes;
        std::vector<Row>& instances = tables_.instance_tree.blocks;
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
                    child =
                        ~static_cast<std::int32_t>(ids[bvh.order[bvh.leaves[static_cast<std::size_t>(~child)].first]]);
        }
        tables_.instance_tree.nodes = std::move(bvh.nodes);
        tables_.instance_tree.depth = bvh.depth;
    }

    /// Holds the boxes of all triangles where they stand: with room for theirs, and for the rounding of vertices.
    static Box instance_box(const InstanceRow<Scalar>& instance, const Box& object) {
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

    [[nodiscard]] std::array<Vec3<Scalar>, 3> vertices_of(std::uint32_t triangle) const {
        std::array<Vec3<Scalar>, 3> vertices;
        for (int i = 0; i < 3; ++i) {
            const auto vertex = static_cast<std::size_t>(bits_of<Scalar>(tables_.triangles[triangle].value[i]));
            const Scalar* position = tables_.vertices[vertex].value;
            vertices[i] = vec3<Scalar>(position[0], position[1], position[2]);
        }
        return vertices;
    }

    SphereBlock<Scalar, kWidth> sphere_block(std::span<const std::uint32_t> ids) const {
        SphereBlock<Scalar, kWidth> block{};
        std::fill_n(block.radius, kWidth, std::numeric_limits<Scalar>::quiet_NaN());
        std::fill_n(block.id, kWidth, kNoPrimitive);
        for (std::size_t lane = 0; lane < ids.size(); ++lane) {
            using Row = SurfaceRow<Scalar>;
            const Row& row = tables_.surfaces[ids[lane]];
            for (int i = 0; i < 3; ++i) {
                block.center[i][lane] = row.value[Row::kCenter + i];
                block.motion[i][lane] = row.value[Row::kMotion + i];
            }
            block.radius[lane] = row.value[Row::kRadius];
            block.padded_radius[lane] = padded_radius<Scalar>(scene_.spheres[ids[lane]]);
            block.id[lane] = static_cast<std::int32_t>(ids[lane]);
        }
        return block;
    }

    PlanarBlock<Scalar, kWidth> planar_block(std::span<const std::uint32_t> ids,
                                             const std::array<Box, kWidth>& boxes) const {
        PlanarBlock<Scalar, kWidth> block{};
        for (auto& component : block.normal) std::fill_n(component, kWidth, std::numeric_limits<Scalar>::quiet_NaN());
        std::fill_n(block.id, kWidth, kNoPrimitive);
        for (std::size_t lane = 0; lane < ids.size(); ++lane) {
            const SurfaceRow<Scalar>& surface = tables_.surfaces[ids[lane]];
            const PlanarRow<Scalar>& planar = tables_.planars[ids[lane] - scene_.spheres.size()];
            for (int i = 0; i < 3; ++i) {
                block.point[i][lane] = surface.value[SurfaceRow<Scalar>::kMotion + i];
                block.corner[i][lane] = planar.value[PlanarRow<Scalar>::kCorner + i];
                block.normal[i][lane] = surface.value[SurfaceRow<Scalar>::kCenter + i];
                block.dual_u[i][lane] = planar.value[PlanarRow<Scalar>::kDualU + i];
                block.dual_v[i][lane] = planar.value[PlanarRow<Scalar>::kDualV + i];
                block.low[i][lane] = static_cast<Scalar>(boxes[lane].low[i]);
                block.high[i][lane] = static_cast<Scalar>(boxes[lane].high[i]);
            }
            block.group[lane] =
                static_cast<std::int32_t>(PlanarMark<Scalar>::group(surface.value[SurfaceRow<Scalar>::kRadius], 0));
            block.id[lane] = static_cast<std::int32_t>(ids[lane]);
        }
        return block;
    }

    template <class BoxOf>
    static std::vector<Box> boxes_by_id(const Ids& ids, BoxOf box_of) {
        std::vector<Box> boxes(ids.size());
#pragma omp parallel for schedule(static) if (ids.size() > kFewestShapes)
        for (std::size_t i = 0; i < ids.size(); ++i) boxes[i] = box_of(ids[i]);
        return boxes;
    }

    /// make_block(ids of a leaf) throws nothing.
    template <class Block, class MakeBlock>
    BlockTree<Block, Scalar, kWidth> block_tree(const std::vector<Box>& boxes, const Ids& ids,
                                                MakeBlock make_block) const {
        WideBvh<Scalar, kWidth> bvh = collapse<Scalar, kWidth>(build_binary_bvh(boxes, kWidth));
        BlockTree<Block, Scalar, kWidth> tree;
        tree.blocks.resize(bvh.leaves.size());
#pragma omp parallel for schedule(static) if (ids.size() > kFewestShapes)
        for (std::size_t i = 0; i < bvh.leaves.size(); ++i) {
            const auto& leaf = bvh.leaves[i];
            std::array<std::uint32_t, kWidth> in_leaf;
            for (std::uint32_t k = 0; k < leaf.count; ++k) in_leaf[k] = ids[bvh.order[leaf.first + k]];
            tree.blocks[i] = make_block(std::span(in_leaf).first(leaf.count));
        }
        tree.nodes = std::move(bvh.nodes);
        tree.depth = bvh.depth;
        return tree;
    }

    const Scene& scene_;
    const Coincidence& coincidence_;
    bool has_motion_;
    SceneTables<Scalar>& tables_;
};

}  // namespace

template <class Scalar>
void add_blocks(const Scene& scene, const Coincidence& coincidence, std::span<const ObjectRows> objects,
                SceneTables<Scalar>& tables) {
    BlockMaker<Scalar> maker(scene, coincidence, tables);
    maker.add_spheres();
    maker.add_planars();
    maker.add_triangles(objects);
}

template void add_blocks(const Scene&, const Coincidence&, std::span<const ObjectRows>, SceneTables<float>&);
template void add_blocks(const Scene&, const Coincidence&, std::span<const ObjectRows>, SceneTables<double>&);

}  // namespace raypool
