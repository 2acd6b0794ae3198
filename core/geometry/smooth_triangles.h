/// Points of triangles that stand for a smooth surface: vertices have normals, and light sees what lies between them.
///
/// The normal of shading is that of Phong, "Illumination for Computer Generated Pictures", CACM 18(6), 1975. Rays leave
/// the triangle from above it, near the surface that the normals tell of: Hanika, "Hacking the Shadow Terminator", Ray
/// Tracing Gems II, chapter 4, 2021. That is a function of the weights, the vertices and their normals alone, and moves
/// no start by more than the triangle's longest edge. Lengths are in scene units.
#pragma once

#include <array>

#include "core/math/vec.h"

namespace raypool {

/// A point of a smooth triangle, seen along a ray. Its near side is the one that the ray arrives from.
template <class Real>
struct SmoothPoint {
    Vec3<Real> normal;  ///< unit, of shading: on the near side, and it faces the ray
    Vec3<Real> lift;    ///< from the point to where rays start on the near side; 0 where not lifted
    /// The start is so far from the triangle that a ray toward the triangle meets it, in spite of rounding.
    Mask<Real> is_lifted;
};

/// The least cosine between a normal of shading and the way back along the ray. A normal that faces less is turned
/// toward the ray: near a silhouette rays see the backs of interpolated normals, and a mirror would send them inward.
template <class Scalar>
inline constexpr Scalar kLeastFacing = Scalar(0.01);

/// `normal` are unit normals of the vertices, on either side of the triangle; `weight` are the weights of the vertices,
/// which add up to 1, at `position`, whose error is at most `error` (triangle_error()); `outward` is the triangle's
/// unit normal and `direction` the ray's.
template <class Real>
RAYPOOL_INLINE SmoothPoint<Real> smooth_point(const std::array<Vec3<Real>, 3>& vertex,
                                              const std::array<Vec3<Real>, 3>& normal,
                                              const std::array<Real, 3>& weight, const Vec3<Real>& position,
                                              const Vec3<Real>& error, const Vec3<Real>& outward,
                                              const Vec3<Real>& direction) {
    using S = ScalarOf<Real>;
    Vec3<Real> mixed;
    for (int axis = 0; axis < 3; ++axis)
        mixed[axis] =
            mad<Real>(weight[0], normal[0][axis], mad<Real>(weight[1], normal[1][axis], weight[2] * normal[2][axis]));

    // All normals are taken to the near side together, so that a file may have them on either.
    const Mask<Real> is_front = dot<Real>(direction, outward) < Real(0);
    const Mask<Real> is_inward = dot<Real>(mixed, outward) < Real(0);
    const Mask<Real> is_turned = (is_inward && is_front) || (!is_inward && !is_front);
    const Real sign = select(is_turned, Real(-1), Real(1));
    const Vec3<Real> side = select<Real>(is_front, outward, -outward);

    SmoothPoint<Real> point;
    const Mask<Real> is_short = dot<Real>(mixed, mixed) < Real(1e-6F);  // where normals cancel
    point.normal =
        unit<Real>(select<Real>(is_short, side, vec3<Real>(sign * mixed[0], sign * mixed[1], sign * mixed[2])));
    const Real averted = max(dot<Real>(direction, point.normal) + Real(kLeastFacing<S>), Real(0));
    point.normal = unit<Real>(along<Real>(point.normal, -averted, direction));

    // How far the point lies below the tangent plane of each vertex, weighed as the vertices are.
    point.lift = vec3<Real>(Real(0), Real(0), Real(0));
    for (int i = 0; i < 3; ++i) {
        const Vec3<Real> near = vec3<Real>(sign * normal[i][0], sign * normal[i][1], sign * normal[i][2]);
        const Vec3<Real> to =
            vec3<Real>(vertex[i][0] - position[0], vertex[i][1] - position[1], vertex[i][2] - position[2]);
        point.lift = along<Real>(point.lift, weight[i] * max(dot<Real>(to, near), Real(0)), near);
    }
    // A distance along a ray is known to some 10 epsilon of the triangle's coordinates, and this is above 32.
    const Real clear = Real(4) * (error[0] + error[1] + error[2]);
    point.is_lifted = dot<Real>(point.lift, side) > clear;
    for (int axis = 0; axis < 3; ++axis) point.lift[axis] = select(point.is_lifted, point.lift[axis], Real(0));
    return point;
}

}  // namespace raypool
