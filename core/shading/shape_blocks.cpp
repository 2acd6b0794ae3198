#include "core/shading/shape_blocks.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "core/geometry/large_boxes.h"
#include "core/geometry/node_motion.h"
#include "core/geometry/shape_bounds.h"
#include "core/shading/block_tree.h"
#include "core/shading/triangle_trees.h"

namespace raypool {

namespace {

using detail::block_tree;
using detail::boxes_by_id;
using detail::Ids;

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
void add_blocks(const Scene& scene, const Coincidence& coincidence, std::span<const ObjectRows> objects,
                SceneTables<Scalar>& tables) {
    BlockMaker<Scalar> maker(scene, coincidence, tables);
    maker.add_spheres();
    maker.add_planars();
    add_triangle_trees(static_cast<std::int32_t>(coincidence.is_hidden.size()), objects, tables);
}

template void add_blocks(const Scene&, const Coincidence&, std::span<const ObjectRows>, SceneTables<float>&);
template void add_blocks(const Scene&, const Coincidence&, std::span<const ObjectRows>, SceneTables<double>&);

}  // namespace raypool
