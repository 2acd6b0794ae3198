/// Three-vectors over any Real, as Eigen matrices. Sums with a fixed order and explicit fused multiply-adds, so that
/// every width gives the same bits.
#pragma once

#include <Eigen/Core>

#include "core/math/real.h"

template <raypool::Simd V>
struct Eigen::NumTraits<V> : Eigen::GenericNumTraits<typename V::value_type> {
    using Real = V;
    using NonInteger = V;
    using Nested = V;
    using Literal = typename V::value_type;
    enum {
        IsComplex = 0,
        IsInteger = 0,
        IsSigned = 1,
        RequireInitialization = 0,
        ReadCost = 1,
        AddCost = 1,
        MulCost = 1
    };
};

namespace raypool {

template <class Real>
using Vec3 = Eigen::Matrix<Real, 3, 1>;

template <class Real>
RAYPOOL_INLINE Vec3<Real> vec3(const Real& x, const Real& y, const Real& z) {
    Vec3<Real> v;
    v[0] = x, v[1] = y, v[2] = z;
    return v;
}
/// The scalar vector in every lane.
template <class Real>
RAYPOOL_INLINE Vec3<Real> broadcast(const Vec3<ScalarOf<Real>>& v) {
    return vec3<Real>(Real(v[0]), Real(v[1]), Real(v[2]));
}
template <class Real>
RAYPOOL_INLINE Real dot(const Vec3<Real>& a, const Vec3<Real>& b) {
    return mad<Real>(a[0], b[0], mad<Real>(a[1], b[1], a[2] * b[2]));
}
template <class Real>
RAYPOOL_INLINE Vec3<Real> cross(const Vec3<Real>& a, const Vec3<Real>& b) {
    return vec3<Real>(nmad<Real>(a[2], b[1], a[1] * b[2]), nmad<Real>(a[0], b[2], a[2] * b[0]),
                      nmad<Real>(a[1], b[0], a[0] * b[1]));
}
/// Of each component.
template <class Real>
RAYPOOL_INLINE Vec3<Real> product(const Vec3<Real>& a, const Vec3<Real>& b) {
    return vec3<Real>(a[0] * b[0], a[1] * b[1], a[2] * b[2]);
}
/// a + t b
template <class Real>
RAYPOOL_INLINE Vec3<Real> along(const Vec3<Real>& a, const Real& t, const Vec3<Real>& b) {
    return vec3<Real>(mad<Real>(t, b[0], a[0]), mad<Real>(t, b[1], a[1]), mad<Real>(t, b[2], a[2]));
}
/// v scaled to length one; v must not be zero, and its squared length must be a normal number.
template <class Real>
RAYPOOL_INLINE Vec3<Real> unit(const Vec3<Real>& v) {
    const Real scale = Real(1) / sqrt(dot<Real>(v, v));
    return vec3<Real>(v[0] * scale, v[1] * scale, v[2] * scale);
}
template <class Real>
RAYPOOL_INLINE Vec3<Real> select(const Mask<Real>& m, const Vec3<Real>& yes, const Vec3<Real>& no) {
    return vec3<Real>(select(m, yes[0], no[0]), select(m, yes[1], no[1]), select(m, yes[2], no[2]));
}

/// A ray of unit direction (to rounding; renormalised at every bounce), at a time in [0, 1] when shapes move.
template <class Real>
struct Ray {
    Vec3<Real> origin;
    Vec3<Real> direction;
    Real time;
};

/// No primitive: the ray left the scene, or starts on nothing.
inline constexpr int kNoPrimitive = -1;

/// The closest hit so far: distance > 0 along the ray, and the primitive's id; kNoPrimitive at infinity for none.
template <class Real>
struct Hit {
    Real t = Real(kInfinity<Real>);
    Int<Real> primitive_id = Int<Real>(kNoPrimitive);

    /// Takes a hit of a single ray that is closer, or as close and of a smaller id.
    RAYPOOL_INLINE void keep_closer(Real distance, std::int32_t id) {
        const bool is_tie_won = distance == t && id < primitive_id;
        if (distance < t || is_tie_won) *this = {distance, id};
    }
};

}  // namespace raypool
