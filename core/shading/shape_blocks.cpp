#include "core/shading/shape_blocks.h"

#include <algorithm>
#include <array>
#include <limits>
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
        tables_.sphere_tree = block_tree<SphereBlock<Scalar, kWidth>, Scalar, kWidth>(
            build_binary_bvh(boxes, kWidth), ids,
            [&](std::span<const std::uint32_t> in_leaf) { return sphere_block(in_leaf); });
        if (!has_motion_) return;
        for (int axis = 0; axis < 3; ++axis) tables_.sphere_tree.motion[axis] = node_motion(tables_.sphere_tree, axis);
    }

    void add_planars() {
        const std::size_t first_plane = scene_.spheres.size() + scene_.quads.size();
        const Ids ids = shown_ids(scene_.spheres.size(), first_plane);
        const auto box_of = [&](std::uint32_t id) {
            return quad_box<Scalar>(scene_.quads[id - scene_.spheres.size()]);
        };
        tables_.quad_tree = block_tree<PlanarBlock<Scalar, kWidth>, Scalar, kWidth>(
            build_binary_bvh(boxes_by_id(ids, box_of), kWidth), ids, [&](std::span<const std::uint32_t> in_leaf) {
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

  private:
    static constexpr int kWidth = kTreeWidth<Scalar>;

    /// Of the ids in [first, end), those of shapes that no earlier one hides.
    [[nodiscard]] Ids shown_ids(std::size_t first, std::size_t end) const {
        Ids ids;
        for (std::size_t id = first; id < end; ++id)
            if (!coincidence_.is_hidden[id]) ids.push_back(static_cast<std::uint32_t>(id));
        return ids;
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

    const Scene& scene_;
    const Coincidence& coincidence_;
    bool has_motion_;
    SceneTables<Scalar>& tables_;
};

}  // namespace

template <class Scalar>
void add_blocks(const Scene& scene, const Coincidence& coincidence, SceneTables<Scalar>& tables) {
    BlockMaker<Scalar> maker(scene, coincidence, tables);
    maker.add_spheres();
    maker.add_planars();
    const auto first_triangle = static_cast<std::int32_t>(coincidence.is_hidden.size());
    tables.triangle_tree = triangle_tree(tables, first_triangle, build_binary_bvh);
}

template <class Scalar>
TriangleTree<Scalar> triangle_tree(const SceneTables<Scalar>& tables, std::int32_t first_triangle,
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
    Ids ids;
    for (std::uint32_t i = 0; i < tables.triangles.size(); ++i)
        if (triangle_normal<Scalar>(vertices_of(i)).allFinite()) ids.push_back(i);
    const auto box_of = [&](std::uint32_t triangle) {
        Vec3<Scalar> low;
        Vec3<Scalar> high;
        triangle_box<Scalar>(vertices_of(triangle), low, high);
        return Box{low.template cast<double>(), high.template cast<double>()};
    };
    return block_tree<TriangleBlock<Scalar, kWidth>, Scalar, kWidth>(
        build(boxes_by_id(ids, box_of), kWidth), ids, [&](std::span<const std::uint32_t> in_leaf) {
            TriangleBlock<Scalar, kWidth> block;
            for (auto& vertex : block.vertex)
                for (auto& axis : vertex) std::fill_n(axis, kWidth, std::numeric_limits<Scalar>::quiet_NaN());
            std::fill_n(block.id, kWidth, kNoPrimitive);
            for (std::size_t lane = 0; lane < in_leaf.size(); ++lane) {
                const std::array<Vec3<Scalar>, 3> vertices = vertices_of(in_leaf[lane]);
                for (int i = 0; i < 3; ++i)
                    for (int axis = 0; axis < 3; ++axis) block.vertex[i][axis][lane] = vertices[i][axis];
                block.id[lane] = first_triangle + static_cast<std::int32_t>(in_leaf[lane]);
            }
            return block;
        });
}

template void add_blocks(const Scene&, const Coincidence&, SceneTables<float>&);
template void add_blocks(const Scene&, const Coincidence&, SceneTables<double>&);
template TriangleTree<float> triangle_tree(const SceneTables<float>&, std::int32_t, const BuildBvh&);
template TriangleTree<double> triangle_tree(const SceneTables<double>&, std::int32_t, const BuildBvh&);

}  // namespace raypool
