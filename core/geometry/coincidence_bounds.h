/// How far apart two shapes may be and still count as one surface: bounds of the rounding errors of hits on them.
///
/// A bound is a distance in the units of the scene, for hits that are computed in Scalar. Bounds themselves are
/// computed in double.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/shape_bounds.h"
#include "core/geometry/shapes.h"
#include "core/scene/scene.h"

namespace raypool {

/// The unit roundoff: an operation's relative error in Scalar is at most this.
template <class Scalar>
inline constexpr double kRoundoff = 0.5 * static_cast<double>(std::numeric_limits<Scalar>::epsilon());

/// How exactly a shape is described, as a part of its coordinates: they are in double, and come from a sum of a product
/// or two, such as a rotation; another such sum gives normals and corners. Of the order of what is left of them where a
/// plane is across an axis or near the origin; in float it adds nothing elsewhere.
inline constexpr double kDescribed = 8 * kRoundoff<double>;

/// The length of no segment between finite shapes and the camera is greater.
inline double scene_diagonal(const Scene& scene) {
    Box all{scene.camera.look_from, scene.camera.look_from};
    for (const Sphere& sphere : scene.spheres)
        for (const Vector3d& c : {sphere.center0, sphere.center1})
            all.extend({c.array() - sphere.radius, c.array() + sphere.radius});
    for (const Quad& quad : scene.quads)
        for_each_corner(quad, [&](const Vector3d& corner) { all.extend({corner, corner}); });
    for (const Plane& plane : scene.planes) {
        const Vector3d nearest = planar_shape(plane).point;
        all.extend({nearest, nearest});
    }
    return (all.high - all.low).norm();
}

/// By how much a plane and a flat shape may differ at `x`, along the plane's normal n, for rounding to decide which of
/// the two a ray from the other meets. `a` and `b` are the points that the two are stored by. In units of roundoff:
///
///   a start on the one, put back onto its plane: |a| for the point stored, |x - a| for the normal stored, |x - a| for
///   the difference and 3 |x - a| for the three operations of the dot product, |x| for the point moved;
///   the other's side, as its distance sees it: |b|, and 5 |x - b| in the same way;
///   in double, |a|, |b| and |x| once more, as all three are sums of a corner and parts of edges;
///
/// each weighted by |n|, axis by axis, so that a plane across an axis is known to an ulp of one coordinate. To this
/// comes what putting back leaves of the ray's own error: that was at most 9 diagonals before (7 from the distance, one
/// for each operation of o + t d), and is multiplied by at most 7 roundoffs (4 as above, 2 for the normal's length, 1).
/// It counts for no more than all the rest: in float a sun 1e11 away would else make one plane of a small box's faces.
template <class Scalar>
double flat_bound(const Vector3d& x, const Vector3d& n, const Vector3d& a, const Vector3d& b, double diagonal) {
    constexpr double u = kRoundoff<Scalar>;
    const Vector3d weight = n.cwiseAbs();
    const double first_order = 2 * weight.dot(a.cwiseAbs() + b.cwiseAbs() + x.cwiseAbs()) +
                               5 * weight.dot((x - a).cwiseAbs() + (x - b).cwiseAbs());
    return u * first_order + std::min(63 * u * u * diagonal, u * first_order);
}

/// The same for two spheres, any normal: a bound of |centre - centre'| + |radius - radius'|. In units of roundoff:
/// twice the distance of each centre from the origin, with its way (stored, and moved to a time); the distance of a hit
/// from the origin; and 20 radii: 2 for the radii stored, 4 for the unit normal or, where a hit is not put back, 13 for
/// its distance (5 for c, whose terms reach (2 r)^2, over 2 r, and 3 for the root), and 5 for the side that the other
/// sees.
template <class Scalar>
double sphere_bound(const Sphere& a, const Sphere& b) {
    const auto reach = [](const Sphere& s) { return s.center0.norm() + (s.center1 - s.center0).norm(); };
    const double radius = std::max(a.radius, b.radius);
    return kRoundoff<Scalar> * (2 * (reach(a) + reach(b)) + std::max(reach(a), reach(b)) + 21 * radius);
}

}  // namespace raypool
