/// Planes and quads as books have them. The engines' are plane_distance() and quad_distance() (core/geometry/shapes.h).
#pragma once

#include "core/geometry/shapes.h"

namespace raypool::naive {

/// "Ray Tracing: The Next Week", chapter 6.2: a plane as n . p = offset, which cancels far from the origin.
template <class Real>
RAYPOOL_INLINE Real offset_plane_distance(const Vec3<Real>& origin, const Vec3<Real>& direction,
                                          const Vec3<Real>& normal, const Real& offset) {
    return (offset - dot<Real>(normal, origin)) / dot<Real>(normal, direction);
}

/// Coordinates within [0, 1] and not an ulp beyond: quads that share an edge leave a gap where both round outward.
template <class Scalar>
Scalar strict_quad_distance(const Vec3<Scalar>& origin, const Vec3<Scalar>& direction, const Vec3<Scalar>& corner,
                            const Vec3<Scalar>& normal, const Vec3<Scalar>& dual_u, const Vec3<Scalar>& dual_v) {
    const Scalar t = plane_distance<Scalar>(origin, direction, corner, normal, false);
    const auto [u, v] = plane_coordinates<Scalar>(along<Scalar>(origin, t, direction), corner, dual_u, dual_v);
    return u >= 0 && u <= 1 && v >= 0 && v <= 1 ? t : kInfinity<Scalar>;
}

}  // namespace raypool::naive
