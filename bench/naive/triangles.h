/// A triangle's test as books have it. The engines' way is triangle_distance() (core/geometry/triangles.h).
#pragma once

#include <array>

#include "core/math/vec.h"

namespace raypool::naive {

/// Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997: each triangle rounds its edges by
/// itself. Infinity for a miss.
template <class Scalar>
Scalar moeller_trumbore_distance(const Vec3<Scalar>& origin, const Vec3<Scalar>& direction,
                                 const std::array<Vec3<Scalar>, 3>& vertex) {
    const Vec3<Scalar> edge1 = vertex[1] - vertex[0];
    const Vec3<Scalar> edge2 = vertex[2] - vertex[0];
    const Vec3<Scalar> p = direction.cross(edge2);
    const Scalar inverse = 1 / edge1.dot(p);
    const Vec3<Scalar> s = origin - vertex[0];
    const Scalar u = inverse * s.dot(p);
    if (!(u >= 0 && u <= 1)) return kInfinity<Scalar>;
    const Vec3<Scalar> q = s.cross(edge1);
    const Scalar v = inverse * direction.dot(q);
    const Scalar t = inverse * edge2.dot(q);
    return v >= 0 && u + v <= 1 && t > 0 ? t : kInfinity<Scalar>;
}

}  // namespace raypool::naive
