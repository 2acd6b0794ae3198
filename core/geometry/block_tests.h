/// One ray against a register of boxes or shapes: what walks of single rays are made of. The mirror image of
/// wide_rays.h, which has a register of rays against one.
#pragma once

#include <cstdint>

#include "core/geometry/tree_bounds.h"

namespace raypool {

/// One ray in every lane, with what the box test and the shapes need of it.
template <class Real>
struct SpreadRay {
    Vec3<Real> origin;
    Vec3<Real> direction;
    Real time;
    RayInverse<Real> inverse;
    int sign[3];  ///< of the direction: 1 where negative, so that bounds[axis][sign] is the near side
    std::int32_t leaving_id;

    RAYPOOL_INLINE SpreadRay(const Ray<ScalarOf<Real>>& ray, const RayInverse<ScalarOf<Real>>& scalar,
                             std::int32_t leaving)
        : origin(broadcast<Real>(ray.origin)),
          direction(broadcast<Real>(ray.direction)),
          time(ray.time),
          leaving_id(leaving) {
        for (int i = 0; i < 3; ++i) {
            inverse.near_scale[i] = Real(scalar.near_scale[i]);
            inverse.far_scale[i] = Real(scalar.far_scale[i]);
            inverse.is_negative[i] = Mask<Real>(scalar.is_negative[i]);
            sign[i] = scalar.is_negative[i] ? 1 : 0;
        }
    }
};

/// One ray in every lane, in an object's space.
template <class Real>
struct SpreadObjectRay : ObjectRay<Real> {
    int sign[3];  ///< as SpreadRay's
    Real time;

    RAYPOOL_INLINE SpreadObjectRay(const InstanceRow<ScalarOf<Real>>& instance, const SpreadRay<Real>& ray)
        : ObjectRay<Real>(ObjectRay<Real>::of(instance, ray.origin, ray.direction)), time(ray.time) {
        for (int i = 0; i < 3; ++i) sign[i] = lane(this->inverse.near_scale[i], 0) < ScalarOf<Real>(0) ? 1 : 0;
    }
};

namespace detail {

template <class Real>
RAYPOOL_INLINE Mask<Real> is_leaving(const std::int32_t* id, std::int32_t leaving_id) {
    using Ids = stdx::rebind_simd_t<std::int32_t, Uint32<Real>>;
    const Ids ids(id, stdx::vector_aligned);
    return as_mask<Real>(stdx::static_simd_cast<Int<Real>>(ids) == Int<Real>(leaving_id));
}

/// The lanes in `bits`. What is found is a Hit, or else whatever has a distance t beyond which nothing matters, and
/// keep_closer().
template <class Real, class Found>
RAYPOOL_INLINE void keep_closest(const Real& t, const std::int32_t* id, unsigned bits, Found& found) {
    alignas(64) ScalarOf<Real> distance[kLanes<Real>];
    t.copy_to(distance, stdx::vector_aligned);
    for (; bits != 0; bits &= bits - 1) {
        const int i = std::countr_zero(bits);
        found.keep_closer(distance[i], id[i]);
    }
}

template <Features features, InBox in_box, class Real, class Block, class Found>
requires requires(Block b) {
    b.radius;
}
RAYPOOL_INLINE void intersect_block(const Block& block, const SpreadRay<Real>& ray, Found& hit) {
    Vec3<Real> center = load<Real>(block.center);
    if constexpr (features.motion) center = center_at<Real>(center, load<Real>(block.motion), ray.time);
    const Real t = sphere_distance<Real>(ray.origin, ray.direction, center, load<Real>(block.radius),
                                         is_leaving<Real>(block.id, ray.leaving_id));
    Mask<Real> is_closer = t <= Real(hit.t) && t < Real(kInfinity<Real>);
    if (none(is_closer)) return;
    if constexpr (in_box == InBox::Yes) {
        const Real r = load<Real>(block.padded_radius);
        const Vec3<Real> low = vec3<Real>(center[0] - r, center[1] - r, center[2] - r);
        const Vec3<Real> high = vec3<Real>(center[0] + r, center[1] + r, center[2] + r);
        is_closer = is_closer && is_inside_box<Real>(low, high, ray.origin, ray.inverse, t);
    }
    keep_closest<Real>(t, block.id, mask_bits(is_closer), hit);
}

template <Features features, InBox in_box, class Real, class Block, class Found>
requires requires(Block b) {
    b.dual_u;
}
RAYPOOL_INLINE void intersect_block(const Block& block, const SpreadRay<Real>& ray, Found& hit) {
    const Mask<Real> leaving = is_leaving<Real>(block.group, ray.leaving_id);
    const Vec3<Real> point = load<Real>(block.point);
    const Vec3<Real> normal = load<Real>(block.normal);
    if constexpr (in_box == InBox::No) {
        if (none(may_meet_plane<Real>(ray.origin, ray.direction, point, normal, Real(hit.t)))) return;
        const Real t = plane_distance<Real>(ray.origin, ray.direction, point, normal, leaving);
        keep_closest<Real>(t, block.id, mask_bits(t <= Real(hit.t) && t < Real(kInfinity<Real>)), hit);
    } else {
        const Real t = quad_distance<Real>(ray.origin, ray.direction, point, normal, load<Real>(block.corner),
                                           load<Real>(block.dual_u), load<Real>(block.dual_v), leaving);
        const Mask<Real> is_closer = t <= Real(hit.t) && t < Real(kInfinity<Real>);
        if (none(is_closer)) return;
        const Mask<Real> is_inside =
            is_inside_box<Real>(load<Real>(block.low), load<Real>(block.high), ray.origin, ray.inverse, t);
        keep_closest<Real>(t, block.id, mask_bits(is_closer && is_inside), hit);
    }
}

/// `ray` is sheared, and placed where the triangles are an object's.
template <Features features, InBox in_box, class Real, IsTriangles Block, class SpreadRays, class Found>
RAYPOOL_INLINE void intersect_block(const Block& block, const SpreadRays& ray, Found& hit) {
    std::array<Vec3<Real>, 3> stored;
    for (int i = 0; i < 3; ++i) stored[i] = load<Real>(block.vertex[i]);
    std::array<Vec3<Real>, 3> vertex = stored;
    if constexpr (IsPlaced<SpreadRays>) vertex = ray.placing.points(stored);
    const Real t = triangle_distance<Real>(ray.origin, ray.shear, vertex, is_leaving<Real>(block.id, ray.leaving_id));
    Mask<Real> is_closer = t <= Real(hit.t) && t < Real(kInfinity<Real>);
    if (none(is_closer)) return;
    is_closer = is_closer && is_inside_triangle_box<Real>(vertex, ray.origin, ray, t);
    if constexpr (IsPlaced<SpreadRays>) is_closer = is_closer && is_inside_object_box<Real>(stored, ray.in_object, t);
    keep_closest<Real>(t, block.id, mask_bits(is_closer), hit);
}

/// A ray as the shapes of a tree take it.
template <class Block, class Real>
RAYPOOL_INLINE decltype(auto) ready_for(const SpreadRay<Real>& ray) {
    if constexpr (IsTriangles<Block> || IsInstance<Block>) {
        const auto first = [](const Vec3<Real>& v) {
            return vec3<ScalarOf<Real>>(lane(v[0], 0), lane(v[1], 0), lane(v[2], 0));
        };
        const RayShear<ScalarOf<Real>> shear = ray_shear<ScalarOf<Real>>(first(ray.direction));
        return Sheared<SpreadRay<Real>, Real>{
            ray, {broadcast<Real>(shear.x), broadcast<Real>(shear.y), broadcast<Real>(shear.z)}};
    } else {
        return (ray);
    }
}

}  // namespace detail

}  // namespace raypool
