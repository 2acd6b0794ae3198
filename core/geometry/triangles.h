/// Where rays meet triangles: the watertight test of Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection",
/// JCGT 2(1), 2013, and the point of a triangle that is met, with a bound of its error.
///
/// A ray's shear makes a vertex a point of the plane across the ray, in which the ray is the origin. Triangles that
/// share a vertex share that point to the last bit. On which side of an edge the origin lies is said by a difference of
/// two products: rounding is monotonic, so its sign is right or it is zero, and zero counts as inside on either side.
/// So of the triangles around an edge or a vertex one is met. (The products must not be fused with their difference.)
#pragma once

#include <array>

#include "core/math/vec.h"

namespace raypool {

/// What the test needs of a ray's direction: rows of the matrix that takes its longest axis to z, and it onto z.
template <class Real>
struct RayShear {
    Vec3<Real> x, y, z;
};

template <class Real>
RAYPOOL_INLINE RayShear<Real> ray_shear(const Vec3<Real>& direction) {
    const Vec3<Real> length = vec3<Real>(abs(direction[0]), abs(direction[1]), abs(direction[2]));
    const Mask<Real> is_x = length[0] >= length[1] && length[0] >= length[2];
    const Mask<Real> is_y = !is_x && length[1] >= length[2];
    const auto of_axis = [&](const Real& along_x, const Real& along_y, const Real& along_z) {
        return select(is_x, along_x, select(is_y, along_y, along_z));
    };
    const Real scale = Real(1) / of_axis(direction[0], direction[1], direction[2]);
    const Vec3<Real> d = vec3<Real>(-direction[0] * scale, -direction[1] * scale, -direction[2] * scale);
    const Real zero(0);
    const Real one(1);
    // The two other axes follow the longest in order: y, z; z, x; x, y.
    return {vec3<Real>(of_axis(d[1], zero, one), of_axis(one, d[2], zero), of_axis(zero, one, d[0])),
            vec3<Real>(of_axis(d[2], one, zero), of_axis(zero, d[0], one), of_axis(one, zero, d[1])),
            vec3<Real>(of_axis(scale, zero, zero), of_axis(zero, scale, zero), of_axis(zero, zero, scale))};
}

/// Where the line of a ray meets the plane of a triangle, in parts of `determinant`.
template <class Real>
struct TriangleWeights {
    std::array<Real, 3> of_vertex;  ///< they add up to the determinant, and are of one sign, or 0, where it is met
    Real height;                    ///< the distance, times the determinant
    Real determinant;

    [[nodiscard]] RAYPOOL_INLINE Mask<Real> is_met() const {
        const auto& [u, v, w] = of_vertex;
        return ((u >= Real(0) && v >= Real(0) && w >= Real(0)) || (u <= Real(0) && v <= Real(0) && w <= Real(0))) &&
               determinant != Real(0);
    }
};

template <class Real>
RAYPOOL_INLINE TriangleWeights<Real> triangle_weights(const Vec3<Real>& origin, const RayShear<Real>& shear,
                                                      const std::array<Vec3<Real>, 3>& vertex) {
    Real x[3];
    Real y[3];
    Real z[3];
    for (int i = 0; i < 3; ++i) {
        const Vec3<Real>& v = vertex[i];
        const Vec3<Real> to = vec3<Real>(v[0] - origin[0], v[1] - origin[1], v[2] - origin[2]);
        x[i] = dot<Real>(shear.x, to);
        y[i] = dot<Real>(shear.y, to);
        z[i] = dot<Real>(shear.z, to);
    }
    TriangleWeights<Real> weights;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        weights.of_vertex[i] = x[k] * y[j] - y[k] * x[j];
    }
    const auto& [u, v, w] = weights.of_vertex;
    weights.height = mad<Real>(u, z[0], mad<Real>(v, z[1], w * z[2]));
    weights.determinant = u + v + w;
    return weights;
}

/// Distance to a triangle, seen from either side.
template <class Real>
RAYPOOL_INLINE Real triangle_distance(const Vec3<Real>& origin, const RayShear<Real>& shear,
                                      const std::array<Vec3<Real>, 3>& vertex, const Mask<Real>& is_leaving) {
    const TriangleWeights<Real> weights = triangle_weights<Real>(origin, shear, vertex);
    const Mask<Real> is_met = weights.is_met() && !is_leaving;
    if (none(is_met)) return Real(kInfinity<Real>);
    const Real t = weights.height / weights.determinant;
    return select(is_met && t > Real(0), t, Real(kInfinity<Real>));
}

/// Half the width, along each axis, of what may be the place of a point of a triangle that is computed from its
/// vertices: above the 7 roundings of such a point and the three that follow, of half an epsilon each.
template <class Real>
RAYPOOL_INLINE Vec3<Real> triangle_error(const std::array<Vec3<Real>, 3>& vertex) {
    using S = ScalarOf<Real>;
    Vec3<Real> error;
    for (int i = 0; i < 3; ++i) {
        const Real reach = max(max(abs(vertex[0][i]), abs(vertex[1][i])), abs(vertex[2][i]));
        error[i] = Real(8 * std::numeric_limits<S>::epsilon()) * reach;
    }
    return error;
}

/// A triangle's own box: with room for the rounding of hits. Trees are built over it, and it limits hits.
template <class Real>
RAYPOOL_INLINE void triangle_box(const std::array<Vec3<Real>, 3>& vertex, Vec3<Real>& low, Vec3<Real>& high) {
    const Vec3<Real> room = triangle_error<Real>(vertex);
    for (int i = 0; i < 3; ++i) {
        low[i] = min(min(vertex[0][i], vertex[1][i]), vertex[2][i]) - room[i];
        high[i] = max(max(vertex[0][i], vertex[1][i]), vertex[2][i]) + room[i];
    }
}

/// The unit normal on the side from which vertices are seen counterclockwise; not finite where they lie in a line.
template <class Real>
RAYPOOL_INLINE Vec3<Real> triangle_normal(const std::array<Vec3<Real>, 3>& vertex) {
    // Edges of length about 1, so that no product of those of a small triangle is lost.
    const auto edge = [&](int to) {
        const Vec3<Real> e =
            vec3<Real>(vertex[to][0] - vertex[0][0], vertex[to][1] - vertex[0][1], vertex[to][2] - vertex[0][2]);
        const Real scale = Real(1) / max(max(abs(e[0]), abs(e[1])), abs(e[2]));
        return vec3<Real>(e[0] * scale, e[1] * scale, e[2] * scale);
    };
    return unit<Real>(cross<Real>(edge(1), edge(2)));
}

}  // namespace raypool
