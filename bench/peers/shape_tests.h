/// Where a ray, or a packet of them, meets a sphere or a flat.
///
/// Called by embree_scene.cpp, from inside Embree's traversal and for planes. A hit is closer than the ray's tfar and
/// farther than 0. RayHit is Embree's RTCRayHit or PacketRayHit.
#pragma once

#include <type_traits>

#include "bench/peers/embree_scene.h"

namespace raypool::peers {

template <class RayHit>
using FloatOf = std::remove_reference_t<decltype(lanes(std::declval<RayHit&>().ray.tfar))>;

template <class F, class RayHit>
RAYPOOL_PEER_INLINE V3<F> origin_of(RayHit& rayhit) {
    return {lanes(rayhit.ray.org_x), lanes(rayhit.ray.org_y), lanes(rayhit.ray.org_z)};
}
template <class F, class RayHit>
RAYPOOL_PEER_INLINE V3<F> direction_of(RayHit& rayhit) {
    return {lanes(rayhit.ray.dir_x), lanes(rayhit.ray.dir_y), lanes(rayhit.ray.dir_z)};
}

template <class F, class RayHit>
RAYPOOL_PEER_INLINE void keep_hit(RayHit& rayhit, MaskOf<F> is_met, F t, std::uint32_t id, std::uint32_t geometry) {
    const UintOf<F> none{};
    lanes(rayhit.ray.tfar) = select(is_met, t, lanes(rayhit.ray.tfar));
    lanes(rayhit.hit.primID) = select(is_met, none + id, lanes(rayhit.hit.primID));
    lanes(rayhit.hit.geomID) = select(is_met, none + geometry, lanes(rayhit.hit.geomID));
}

/// The discriminant is r^2 less the squared distance from the centre to the line, which keeps its precision far away.
/// A ray that starts on the sphere meets it at the other end of its chord.
template <class RayHit, class F = FloatOf<RayHit>>
RAYPOOL_PEER_INLINE void test_sphere(const SphereShape& sphere, std::uint32_t id, std::uint32_t geometry,
                                     MaskOf<F> is_active, RayHit& rayhit) {
    const V3<F> direction = direction_of<F>(rayhit);
    const F time = lanes(rayhit.ray.time);
    const V3<F> center = all_lanes<F>(sphere.center) + time * all_lanes<F>(sphere.motion);
    const V3<F> f = origin_of<F>(rayhit) - center;
    const F b = -dot(f, direction);
    const V3<F> closest = f + b * direction;
    const F discriminant = sphere.radius * sphere.radius - dot(closest, closest);
    const F half_chord = root(discriminant);
    const F t_far = lanes(rayhit.ray.tfar);
    const MaskOf<F> is_leaving = lanes(rayhit.ray.id) == id;
    const F t = select(is_leaving, 2.0F * b, select(b > half_chord, b - half_chord, b + half_chord));
    const MaskOf<F> is_met = is_active & ((discriminant >= 0.0F) | is_leaving) & (t > 0.0F) & (t < t_far);
    if (any(is_met)) keep_hit<F>(rayhit, is_met, t, id, geometry);
}

enum class Extent : bool { Quad, Plane };

/// Quads that share an edge overlap by a hair, so that no ray slips between them.
template <Extent extent, class RayHit, class F = FloatOf<RayHit>>
RAYPOOL_PEER_INLINE void test_flat(const PlanarShape& planar, std::uint32_t id, std::uint32_t geometry, MaskOf<F> is_active,
                                   RayHit& rayhit) {
    constexpr float kHair = 1e-6F;
    const V3<F> direction = direction_of<F>(rayhit);
    const V3<F> f = origin_of<F>(rayhit) - all_lanes<F>(planar.corner);
    const V3<F> normal = all_lanes<F>(planar.normal);
    const F t = -dot(f, normal) / dot(direction, normal);
    const V3<F> p = f + t * direction;
    const F u = dot(p, all_lanes<F>(planar.dual_u));
    const F v = dot(p, all_lanes<F>(planar.dual_v));
    const F t_far = lanes(rayhit.ray.tfar);
    const MaskOf<F> is_leaving = lanes(rayhit.ray.id) == id;
    MaskOf<F> is_met = is_active & (t > 0.0F) & (t < t_far) & !is_leaving;
    if constexpr (extent == Extent::Quad)
        is_met = is_met & (u >= -kHair) & (u <= 1 + kHair) & (v >= -kHair) & (v <= 1 + kHair);
    if (!any(is_met)) return;
    keep_hit<F>(rayhit, is_met, t, id, geometry);
    lanes(rayhit.hit.u) = select(is_met, u, lanes(rayhit.hit.u));
    lanes(rayhit.hit.v) = select(is_met, v, lanes(rayhit.hit.v));
}

}  // namespace raypool::peers
