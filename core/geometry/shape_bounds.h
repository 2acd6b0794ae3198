/// Shapes of the description, prepared for the tables: padded boxes, and the planes of quads.
///
/// Called by compile() and by what decides which surfaces coincide. Everything is in double; a box is exact in Scalar.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "core/geometry/bvh.h"
#include "core/scene/scene.h"

namespace raypool {

/// Half the edge of a sphere's box: the radius, and room for the rounding of centre + radius and of distances.
template <class Scalar>
Scalar padded_radius(const Sphere& sphere) {
    const double reach = std::max(sphere.center0.cwiseAbs().maxCoeff(), sphere.center1.cwiseAbs().maxCoeff());
    const double epsilon = std::numeric_limits<Scalar>::epsilon();
    return static_cast<Scalar>(sphere.radius * (1 + 8 * epsilon) + 4 * epsilon * (reach + sphere.radius));
}

/// One more ulp on either side: room for the rounding of the union over time.
template <class Scalar>
Box widened(const Box& box) {
    Box wide;
    for (int axis = 0; axis < 3; ++axis) {
        constexpr Scalar kFar = std::numeric_limits<Scalar>::infinity();
        wide.low[axis] = std::nextafter(static_cast<Scalar>(box.low[axis]), -kFar);
        wide.high[axis] = std::nextafter(static_cast<Scalar>(box.high[axis]), kFar);
    }
    return wide;
}

/// The box from time 0 to `end`, 0 or 1, exact in Scalar. It holds every box that a kernel makes of
/// center_at(time) -+ padded radius.
template <class Scalar>
Box sphere_box(const Sphere& sphere, double end) {
    const Scalar r = padded_radius<Scalar>(sphere);
    Box box;
    for (const double time : {0.0, end}) {
        for (int axis = 0; axis < 3; ++axis) {
            const Scalar from = static_cast<Scalar>(sphere.center0[axis]);
            const Scalar motion = static_cast<Scalar>(sphere.center1[axis] - sphere.center0[axis]);
            const Scalar center = from + static_cast<Scalar>(time) * motion;
            box.low[axis] = std::min(box.low[axis], static_cast<double>(static_cast<Scalar>(center - r)));
            box.high[axis] = std::max(box.high[axis], static_cast<double>(static_cast<Scalar>(center + r)));
        }
    }
    return widened<Scalar>(box);
}

/// Calls visit(corner) for the four corners of a quad.
template <class Visit>
void for_each_corner(const Quad& quad, Visit visit) {
    for (const double s : {0.0, 1.0})
        for (const double t : {0.0, 1.0}) visit(Vector3d(quad.corner + s * quad.edge_u + t * quad.edge_v));
}

/// Room for the rounding of hits, and for quads that take the plane of one that they coincide with.
template <class Scalar>
Box quad_box(const Quad& quad) {
    Box box;
    for_each_corner(quad, [&](const Vector3d& corner) { box.extend({corner, corner}); });
    const double reach = std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff());
    const double pad = 32 * static_cast<double>(std::numeric_limits<Scalar>::epsilon()) * reach;
    return widened<Scalar>({box.low.array() - pad, box.high.array() + pad});
}

/// A quad or plane: coordinates are measured from `corner`, and the plane is the one through `point`.
///
/// The point is that of the shape which is nearest to the origin (for a skewed quad: about that), so that the plane's
/// rounding error at any place of the shape is a few ulps of the coordinates there, however far the shape reaches.
struct PlanarShape {
    Vector3d corner, normal, dual_u, dual_v, point;
    int material_id;
};

inline PlanarShape planar_shape(const Quad& quad) {
    const Vector3d n = quad.edge_u.cross(quad.edge_v);
    const Vector3d dual_u = quad.edge_v.cross(n) / n.squaredNorm();
    const Vector3d dual_v = n.cross(quad.edge_u) / n.squaredNorm();
    const double s = std::clamp(-quad.corner.dot(dual_u), 0.0, 1.0);
    const double t = std::clamp(-quad.corner.dot(dual_v), 0.0, 1.0);
    return {quad.corner,     n.normalized(), dual_u, dual_v, quad.corner + s * quad.edge_u + t * quad.edge_v,
            quad.material_id};
}

/// A plane's coordinates run along the image of the x axis (or the z axis, when the plane faces x) within it.
inline PlanarShape planar_shape(const Plane& plane) {
    const Vector3d n = plane.normal.normalized();
    const Vector3d axis = std::abs(n.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitZ();
    const Vector3d u = (axis - axis.dot(n) * n).normalized();
    return {plane.point, n, u, n.cross(u), plane.point.dot(n) * n, plane.material_id};
}

}  // namespace raypool
