/// Where rays meet shapes: boxes, spheres, planes and quads, each written once for any Real.
///
/// Any mix of scalar and wide is possible: one ray against a register of spheres, a register of rays against one, or
/// one against one; what is single is broadcast. A distance returned is > 0, or infinity for a miss. There is no
/// least distance: a ray that starts on a primitive is told so (`is_leaving`) and gets the exact second root of a
/// sphere, and no hit on the plane or quad it left. Shapes that are one surface to rounding count as one, which is
/// decided before rays are traced (coincidence.h). So nothing leaks through small things, and no surface hits itself.
///
/// Which hit is the closest must not depend on the order in which a tree is walked. Two rules see to that. First,
/// box distances are monotonic: a box inside another is entered no earlier, to the last bit, since both use the same
/// operations. Second, a hit counts only where the ray is inside the primitive's own padded box (is_inside_box), so
/// a walk that skips a box because it is entered beyond the closest hit skips no hit that would have been closer.
#pragma once

#include <array>

#include "core/math/vec.h"

namespace raypool {

/// Slack of the box test, relative: far above the error of a primitive's distance where it touches its own box, and
/// above the 2 gamma_3 of Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013.
template <class Scalar>
inline constexpr Scalar kBoxSlack = 64 * std::numeric_limits<Scalar>::epsilon();

/// What the box test needs of a ray. A zero component of the direction has an infinite inverse, and that is right.
template <class Real>
struct RayInverse {
    Vec3<Real> near_scale;      ///< 1 / direction, a little shorter
    Vec3<Real> far_scale;       ///< 1 / direction, a little longer
    Mask<Real> is_negative[3];  ///< the sign bit of the direction, of -0 too
};

/// `scale` is 1 / direction; of -0 it is negative too.
template <class Real>
RAYPOOL_INLINE RayInverse<Real> inverse_of_scale(const Vec3<Real>& scale) {
    using S = ScalarOf<Real>;
    RayInverse<Real> inverse;
    for (int i = 0; i < 3; ++i) {
        inverse.near_scale[i] = scale[i] * Real(1 - kBoxSlack<S>);
        inverse.far_scale[i] = scale[i] * Real(1 + kBoxSlack<S>);
        inverse.is_negative[i] = scale[i] < Real(0);
    }
    return inverse;
}
template <class Real>
RAYPOOL_INLINE RayInverse<Real> ray_inverse(const Vec3<Real>& direction) {
    return inverse_of_scale<Real>(vec3<Real>(Real(1) / direction[0], Real(1) / direction[1], Real(1) / direction[2]));
}

/// Where a ray is inside a box: from `enter` (>= 0) to `exit`; nowhere if enter > exit.
template <class Real>
struct Interval {
    Real enter;
    Real exit;
};

/// Distance to an axis-aligned plane; NaN for a ray within the plane, which the comparisons below then ignore.
template <class Real>
RAYPOOL_INLINE Real slab_distance(const Real& plane, const Real& origin, const Real& scale) {
    return (plane - origin) * scale;
}

/// `exit` is no farther than `limit`. max(n, t) and min(f, t) keep t when n or f is NaN.
/// The origin is one as the near sides and one as the far sides see it, where it is not known exactly.
template <class Real>
RAYPOOL_INLINE Interval<Real> box_interval(const Vec3<Real>& near, const Vec3<Real>& far, const Vec3<Real>& near_origin,
                                           const Vec3<Real>& far_origin, const RayInverse<Real>& inverse,
                                           const Real& limit) {
    Interval<Real> inside{Real(0), limit};
    for (int i = 0; i < 3; ++i) {
        inside.enter = max(slab_distance<Real>(near[i], near_origin[i], inverse.near_scale[i]), inside.enter);
        inside.exit = min(slab_distance<Real>(far[i], far_origin[i], inverse.far_scale[i]), inside.exit);
    }
    return inside;
}

/// The same of rays whose origin is known.
template <class Real>
RAYPOOL_INLINE Interval<Real> box_interval(const Vec3<Real>& near, const Vec3<Real>& far, const Vec3<Real>& origin,
                                           const RayInverse<Real>& inverse, const Real& limit) {
    return box_interval<Real>(near, far, origin, origin, inverse, limit);
}

/// Whether the hit at distance t lies in the box [low, high] as the box test sees it.
template <class Real>
RAYPOOL_INLINE Mask<Real> is_inside_box(const Vec3<Real>& low, const Vec3<Real>& high, const Vec3<Real>& near_origin,
                                        const Vec3<Real>& far_origin, const RayInverse<Real>& inverse, const Real& t) {
    Vec3<Real> near;
    Vec3<Real> far;
    for (int i = 0; i < 3; ++i) {
        near[i] = select(inverse.is_negative[i], high[i], low[i]);
        far[i] = select(inverse.is_negative[i], low[i], high[i]);
    }
    const Interval<Real> inside =
        box_interval<Real>(near, far, near_origin, far_origin, inverse, Real(kInfinity<Real>));
    return inside.enter <= t && inside.enter <= inside.exit;
}

/// The same of a ray whose origin is known.
template <class Real>
RAYPOOL_INLINE Mask<Real> is_inside_box(const Vec3<Real>& low, const Vec3<Real>& high, const Vec3<Real>& origin,
                                        const RayInverse<Real>& inverse, const Real& t) {
    return is_inside_box<Real>(low, high, origin, origin, inverse, t);
}

/// Where the centre of a moving sphere is; center0 exactly when it does not move.
template <class Real>
RAYPOOL_INLINE Vec3<Real> center_at(const Vec3<Real>& center0, const Vec3<Real>& motion, const Real& time) {
    return vec3<Real>(center0[0] + time * motion[0], center0[1] + time * motion[1], center0[2] + time * motion[2]);
}

/// Distance to a sphere along a unit direction. The discriminant is that of Haines et al., "Precision Improvements for
/// Ray/Sphere Intersection", Ray Tracing Gems, chapter 7; squared distance to the surface, c, is factored along the
/// dominant axis, (M - r)(M + r) + rest, which keeps its precision for a huge ground sphere.
template <class Real>
RAYPOOL_INLINE Real sphere_distance(const Vec3<Real>& origin, const Vec3<Real>& direction, const Vec3<Real>& center,
                                    const Real& radius, const Mask<Real>& is_leaving) {
    const Vec3<Real> f = vec3<Real>(origin[0] - center[0], origin[1] - center[1], origin[2] - center[2]);
    const Real b = -dot<Real>(f, direction);
    const Vec3<Real> closest = along<Real>(f, b, direction);
    const Real discriminant =
        nmad<Real>(closest[0], closest[0],
                   nmad<Real>(closest[1], closest[1], nmad<Real>(closest[2], closest[2], radius * radius)));
    // What leaves the sphere inward meets it again, even where rounding put its origin outside. A NaN is never met.
    // (One comparison: of `d >= 0 || (is_leaving && d < 0)` gcc 12 makes `d >= 0 || is_leaving`.)
    const Mask<Real> is_met = discriminant >= select(is_leaving, -Real(kInfinity<Real>), Real(0));
    if (none(is_met)) return Real(kInfinity<Real>);

    const Real root = sqrt(max(discriminant, Real(0)));
    const Real q = b + copysign(root, b);
    const Real x = abs(f[0]);
    const Real y = abs(f[1]);
    const Real z = abs(f[2]);
    const Real xy_max = max(x, y);
    const Real m = max(xy_max, z);
    const Real second = min(xy_max, z);
    const Real third = min(x, y);
    const Real c = mad<Real>(m - radius, m + radius, mad<Real>(second, second, third * third));

    // From outside (c > 0) the first root is c / q, in front if b > 0; from inside the positive one of q and c / q,
    // which is q at b = 0 too.
    const Real t = select(c <= Real(0) && q > Real(0), q, c / q);
    const Real t_or_second = select(is_leaving, b + b, t);
    return select(is_met && t_or_second > Real(0), t_or_second, Real(kInfinity<Real>));
}

/// What may_meet_sphere() knows of a sphere.
template <class Real>
struct SphereReach {
    Real square;  ///< of a radius larger than the sphere's by more than all rounding
    Real least;   ///< how far behind its origin a ray that leaves the sphere may see the centre: negative
};

/// `padded_radius` is that of shape_bounds.h: p = padded - radius is 12 eps radius + 4 eps reach at least, where reach
/// is the greatest coordinate of the centre.
template <class Real>
RAYPOOL_INLINE SphereReach<Real> sphere_reach(const Real& radius, const Real& padded_radius) {
    using S = ScalarOf<Real>;
    const Real pad = Real(4) * (padded_radius - radius);
    const Real reach = radius + pad;
    // The smallest numbers are flushed to zero where the exact test squares, a few times over.
    const Real flushed(64 * std::numeric_limits<S>::min());
    return {mad<Real>(reach * reach, Real(1 + 4 * std::numeric_limits<S>::epsilon()), flushed), -pad};
}

/// From a ray's origin to the centre of a sphere at the ray's time, for may_meet_sphere(). Rounds otherwise than
/// center_at() and a difference do, and takes an operation less.
template <class Real>
RAYPOOL_INLINE Vec3<Real> toward_sphere(const Vec3<Real>& center0, const Vec3<Real>& motion, const Real& time,
                                        const Vec3<Real>& origin) {
    return along<Real>(vec3<Real>(center0[0] - origin[0], center0[1] - origin[1], center0[2] - origin[2]), time,
                       motion);
}

/// Whether sphere_distance() may find a hit: false for most that it does not, never for one that it does. `toward`
/// leads from the ray's origin to the centre.
///
/// Why none is lost. Let u = eps / 2, f the exact test's own origin - centre, g = toward, d the direction, |d|^2 = 1 +
/// h with |h| <= 9 u, as unit() makes it, R = radius + 4 p. f + g is at most D = 3 u |g| + 9 u reach. The exact test
/// meets the line where the vector it computes from the centre to the line's closest point, with an error of at most
/// 3.2 u |f| + 3 u radius, is no longer than the radius. So the true distance of line and centre is at most
/// radius (1 + 3 u) + 3.2 u |f| + D, and with |g|^2 = distance^2 + (g.d)^2 / (1 + h)
///     |g|^2 - (g.d)^2 <= R^2 + 27 eps |g|^2,
/// where mixed terms go to R^2 (it exceeds radius^2 by 96 eps radius^2 + 32 eps radius reach) or to |g|^2. The 27
/// include the rounding below and h; 32 are allowed. A hit has the centre ahead (g.d > 0) or the origin within the
/// sphere, |f| <= radius (1 + 3 u), which the same inequality without (g.d)^2 lets pass. A ray that leaves the sphere
/// meets it again only where f.d < 0, and g.d differs from -f.d by at most 9 u |g| + 9 u reach, with |g| the radius to
/// rounding: less than 4 p. Coordinates are far from overflow: scenes end at 1e12.
template <class Real>
RAYPOOL_INLINE Mask<Real> may_meet_sphere(const Vec3<Real>& toward, const Vec3<Real>& direction,
                                          const SphereReach<Real>& reach, const Mask<Real>& is_leaving) {
    constexpr ScalarOf<Real> kEpsilon = std::numeric_limits<ScalarOf<Real>>::epsilon();
    const Real ahead = dot<Real>(toward, direction);
    const Real in_front = max(ahead, Real(0));
    const Real rest = nmad<Real>(dot<Real>(toward, toward), Real(1 - 32 * kEpsilon), reach.square);
    const Mask<Real> is_near = mad<Real>(in_front, in_front, rest) >= Real(0);
    return (is_leaving && ahead >= reach.least) || (is_near && !is_leaving);
}

/// Distance to the plane through `point` with unit `normal`, seen from either side.
template <class Real>
RAYPOOL_INLINE Real plane_distance(const Vec3<Real>& origin, const Vec3<Real>& direction, const Vec3<Real>& point,
                                   const Vec3<Real>& normal, const Mask<Real>& is_leaving) {
    const Vec3<Real> f = vec3<Real>(point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]);
    const Real t = dot<Real>(f, normal) / dot<Real>(direction, normal);
    return select(t > Real(0) && !is_leaving, t, Real(kInfinity<Real>));
}

/// Whether plane_distance() may find a hit at `limit` or before: false for most that it does not, never for one that it
/// does. It spares a division where a scene has many planes, of which all but a few are behind the ray or the closest
/// hit.
///
/// Why none is lost. The distance is height / slope, rounded once. It is > 0 where their signs agree, and at most the
/// limit only where |height| <= limit |slope| (1 + eps): 4 eps hold the rounding of the products as well. A product too
/// small for the processor to keep is 0, so the smallest numbers are let through.
template <class Real>
RAYPOOL_INLINE Mask<Real> may_meet_plane(const Vec3<Real>& origin, const Vec3<Real>& direction, const Vec3<Real>& point,
                                         const Vec3<Real>& normal, const Real& limit) {
    using S = ScalarOf<Real>;
    const Vec3<Real> f = vec3<Real>(point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]);
    const Real height = dot<Real>(f, normal);
    const Real slope = dot<Real>(direction, normal);
    const Real along_slope = select(slope < Real(0), -height, height);
    const Real most = mad<Real>(abs(slope) * limit, Real(1 + 4 * std::numeric_limits<S>::epsilon()),
                                Real(2 * std::numeric_limits<S>::min()));
    return along_slope > Real(0) && along_slope <= most;
}

/// Coordinates of a point of a plane: its offset from `corner` along two vectors of the plane's dual basis.
template <class Real>
RAYPOOL_INLINE std::array<Real, 2> plane_coordinates(const Vec3<Real>& p, const Vec3<Real>& corner,
                                                     const Vec3<Real>& dual_u, const Vec3<Real>& dual_v) {
    const Vec3<Real> f = vec3<Real>(p[0] - corner[0], p[1] - corner[1], p[2] - corner[2]);
    return {dot<Real>(f, dual_u), dot<Real>(f, dual_v)};
}

/// How far a quad reaches beyond its edges, as a part of them: quads that share an edge leave no gap to rounding.
template <class Scalar>
inline constexpr Scalar kEdgeSlack = 8 * std::numeric_limits<Scalar>::epsilon();

/// Distance to the parallelogram where both coordinates are in [0, 1], or beyond by kEdgeSlack. Its plane is the one
/// through `point`, its coordinates are measured from `corner`.
template <class Real>
RAYPOOL_INLINE Real quad_distance(const Vec3<Real>& origin, const Vec3<Real>& direction, const Vec3<Real>& point,
                                  const Vec3<Real>& normal, const Vec3<Real>& corner, const Vec3<Real>& dual_u,
                                  const Vec3<Real>& dual_v, const Mask<Real>& is_leaving) {
    const Real t = plane_distance<Real>(origin, direction, point, normal, is_leaving);
    const Mask<Real> is_finite = t < Real(kInfinity<Real>);
    if (none(is_finite)) return t;
    const auto [u, v] = plane_coordinates<Real>(along<Real>(origin, t, direction), corner, dual_u, dual_v);
    const Real least(-kEdgeSlack<ScalarOf<Real>>);
    const Real most(1 + kEdgeSlack<ScalarOf<Real>>);
    const Mask<Real> is_met = is_finite && u >= least && u <= most && v >= least && v <= most;
    return select(is_met, t, Real(kInfinity<Real>));
}

}  // namespace raypool
