/// A register of rays, or a single one, against one box or one shape: what packets and streams are made of, and walks
/// on a GPU.
///
/// The mirror image of block_tests.h, which has one ray against a register of boxes and shapes; the same
/// kernels of shapes.h, so the same bits.
#pragma once

#include "core/geometry/tree_bounds.h"

namespace raypool {

/// A ray a lane, with what the kernels need of each.
template <class Real>
struct WideRays {
    Ray<Real> ray;
    RayInverse<Real> inverse;
    Int<Real> leaving_id;
};

/// Camera rays, which start on nothing.
template <class Real>
RAYPOOL_INLINE WideRays<Real> wide_camera_rays(const Ray<Real>& ray) {
    return {ray, ray_inverse<Real>(ray.direction), Int<Real>(kNoPrimitive)};
}
/// Takes the hits at `t` of primitive `id` that are closer than the closest so far.
template <class Real>
RAYPOOL_INLINE Mask<Real> closer(const Real& t, std::int32_t id, const Hit<Real>& hit) {
    const Mask<Real> is_tie_won = t == hit.t && as_mask<Real>(Int<Real>(id) < hit.primitive_id);
    return (t < hit.t || is_tie_won) && t < Real(kInfinity<Real>);
}

template <class Real>
RAYPOOL_INLINE Vec3<Real> lane_of(const auto(&columns)[3], int lane) {
    return vec3<Real>(Real(columns[0][lane]), Real(columns[1][lane]), Real(columns[2][lane]));
}

/// Tests sphere `lane` of a block. Returns the rays for which it is the closest hit now.
template <Features features, InBox in_box, class Real, class Block>
requires requires(Block b) {
    b.radius;
}
RAYPOOL_INLINE Mask<Real> intersect_lane(const Block& block, int lane, const WideRays<Real>& rays, Hit<Real>& hit) {
    const std::int32_t id = block.id[lane];
    Vec3<Real> center = lane_of<Real>(block.center, lane);
    if constexpr (features.motion) center = center_at<Real>(center, lane_of<Real>(block.motion, lane), rays.ray.time);
    const Mask<Real> is_leaving = as_mask<Real>(rays.leaving_id == Int<Real>(id));
    const Real t =
        sphere_distance<Real>(rays.ray.origin, rays.ray.direction, center, Real(block.radius[lane]), is_leaving);
    Mask<Real> is_closer = closer<Real>(t, id, hit);
    if (none(is_closer)) return is_closer;
    if constexpr (in_box == InBox::Yes) {
        const Real r(block.padded_radius[lane]);
        const Vec3<Real> low = vec3<Real>(center[0] - r, center[1] - r, center[2] - r);
        const Vec3<Real> high = vec3<Real>(center[0] + r, center[1] + r, center[2] + r);
        is_closer = is_closer && is_inside_box<Real>(low, high, rays.ray.origin, rays.inverse, t);
    }
    hit.t = select(is_closer, t, hit.t);
    hit.primitive_id = select(is_closer, Int<Real>(id), hit.primitive_id);
    return is_closer;
}

/// The same for a quad, or (without a box) a plane.
template <Features features, InBox in_box, class Real, class Block>
requires requires(Block b) {
    b.dual_u;
}
RAYPOOL_INLINE Mask<Real> intersect_lane(const Block& block, int lane, const WideRays<Real>& rays, Hit<Real>& hit) {
    const std::int32_t id = block.id[lane];
    const Mask<Real> is_leaving = as_mask<Real>(rays.leaving_id == Int<Real>(block.group[lane]));
    const Vec3<Real> point = lane_of<Real>(block.point, lane);
    const Vec3<Real> normal = lane_of<Real>(block.normal, lane);
    const Ray<Real>& ray = rays.ray;
    Mask<Real> is_closer;
    Real t;
    if constexpr (in_box == InBox::Yes) {
        t = quad_distance<Real>(ray.origin, ray.direction, point, normal, lane_of<Real>(block.corner, lane),
                                lane_of<Real>(block.dual_u, lane), lane_of<Real>(block.dual_v, lane), is_leaving);
        is_closer = closer<Real>(t, id, hit);
        if (none(is_closer)) return is_closer;
        is_closer = is_closer && is_inside_box<Real>(lane_of<Real>(block.low, lane), lane_of<Real>(block.high, lane),
                                                     ray.origin, rays.inverse, t);
    } else {
        is_closer = may_meet_plane<Real>(ray.origin, ray.direction, point, normal, hit.t);
        if (none(is_closer)) return is_closer;
        t = plane_distance<Real>(ray.origin, ray.direction, point, normal, is_leaving);
        is_closer = closer<Real>(t, id, hit);
    }
    hit.t = select(is_closer, t, hit.t);
    hit.primitive_id = select(is_closer, Int<Real>(id), hit.primitive_id);
    return is_closer;
}

/// The same for a triangle, of rays that are sheared, and placed where it is an object's.
template <Features features, InBox in_box, class Real, IsTriangles Block, class Rays>
RAYPOOL_INLINE Mask<Real> intersect_lane(const Block& block, int lane, const Rays& rays, Hit<Real>& hit) {
    const std::int32_t id = block.id[lane];
    std::array<Vec3<Real>, 3> stored;
    for (int i = 0; i < 3; ++i) stored[i] = lane_of<Real>(block.vertex[i], lane);
    std::array<Vec3<Real>, 3> vertex = stored;
    if constexpr (IsPlaced<Rays>) vertex = rays.placing.points(stored);
    const Ray<Real>& ray = rays.ray;
    const Real t =
        triangle_distance<Real>(ray.origin, rays.shear, vertex, as_mask<Real>(rays.leaving_id == Int<Real>(id)));
    Mask<Real> is_closer = closer<Real>(t, id, hit);
    if (none(is_closer)) return is_closer;
    is_closer = is_closer && detail::is_inside_triangle_box<Real>(vertex, ray.origin, rays, t);
    if constexpr (IsPlaced<Rays>)
        is_closer = is_closer && detail::is_inside_object_box<Real>(stored, rays.in_object, t);
    hit.t = select(is_closer, t, hit.t);
    hit.primitive_id = select(is_closer, Int<Real>(id), hit.primitive_id);
    return is_closer;
}

/// Rays as the shapes of a tree take them: these, or what is made of them.
template <class Block, class Real>
RAYPOOL_INLINE decltype(auto) ready_for(const WideRays<Real>& rays) {
    if constexpr (IsTriangles<Block> || IsInstance<Block>) {
        return Sheared<WideRays<Real>, Real>{rays, ray_shear<Real>(rays.ray.direction)};
    } else {
        return (rays);
    }
}
template <class Block, class Real>
void ready_for(const WideRays<Real>&&) = delete;  // what is returned would not outlive it

/// A register of rays as the triangles of an instance take them.
template <class Real>
using PlacedRays = Placed<Sheared<WideRays<Real>, Real>, Real>;
template <class Real>
RAYPOOL_INLINE PlacedRays<Real> placed_rays(const InstanceRow<ScalarOf<Real>>& instance,
                                            const Sheared<WideRays<Real>, Real>& rays) {
    using Row = InstanceRow<ScalarOf<Real>>;
    PlacedRays<Real> placed{rays, Placing<Real>::of(instance.value + Row::kTransform),
                            ObjectRay<Real>::of(instance, rays.ray.origin, rays.ray.direction)};
    placed.leaving_id = placed.leaving_id - Int<Real>(instance.number(Row::kFirstId));
    return placed;
}

/// Calls visit(lane) for the lanes of a block that hold a shape.
template <class Block, class Visit>
RAYPOOL_INLINE void for_each_shape(const Block& block, Visit visit) {
    for (int lane = 0; lane < Block::kLanes && block.id[lane] != kNoPrimitive; ++lane) visit(lane);
}

/// Shapes that are in no tree. `count` is the number of lanes that matter, for the account of tests.
template <Features features, class Blocks, class Real, class Work>
RAYPOOL_INLINE void intersect_all(const Blocks& blocks, const WideRays<Real>& rays, int count, Hit<Real>& hit,
                                  Work& work) {
    for (const auto& block : blocks) {
        for_each_shape(block, [&](int lane) {
            work.count_primitives(count);
            intersect_lane<features, InBox::No, Real>(block, lane, rays, hit);
        });
    }
}

/// Which of some shadow rays such shapes hide from their lights, hits on which are `light`.
template <Features features, class Blocks, class Real, class Work>
RAYPOOL_INLINE Mask<Real> hidden_by_any(const Blocks& blocks, const WideRays<Real>& rays, int count,
                                        const Hit<Real>& light, Work& work) {
    Mask<Real> is_hidden(false);
    for (const auto& block : blocks) {
        for_each_shape(block, [&](int lane) {
            work.count_primitives(count);
            Hit<Real> hit = light;
            const Mask<Real> is_before = intersect_lane<features, InBox::No, Real>(block, lane, rays, hit);
            is_hidden = is_hidden || (is_before && as_mask<Real>(light.primitive_id != Int<Real>(block.id[lane])));
        });
    }
    return is_hidden;
}

/// Where the rays are inside child `lane` of a node, before `limit`.
template <class Real, class Bounds, class Rays>
RAYPOOL_INLINE Interval<Real> child_interval(const Bounds& bounds, std::size_t node, int lane, const Rays& rays,
                                             const Real& time, const Real& limit) {
    Vec3<Real> near;
    Vec3<Real> far;
    for (int i = 0; i < 3; ++i) {
        const Real low = bounds.template child<Real>(node, lane, i, 0, time);
        const Real high = bounds.template child<Real>(node, lane, i, 1, time);
        near[i] = select(rays.inverse.is_negative[i], high, low);
        far[i] = select(rays.inverse.is_negative[i], low, high);
    }
    if constexpr (requires { rays.near_origin; }) {
        return box_interval<Real>(near, far, rays.near_origin, rays.far_origin, rays.inverse, limit);
    } else {
        return box_interval<Real>(near, far, rays.ray.origin, rays.inverse, limit);
    }
}

}  // namespace raypool
