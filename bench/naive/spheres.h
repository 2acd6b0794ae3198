/// Ray against sphere as books and code bases have it, and as the cases of stability show it to fail.
///
/// Only bench/ and tests/ call this; the method of the engines is sphere_distance() (core/geometry/shapes.h). Templates
/// over any Real, as the kernels. `least` is the distance below which a hit does not count: the epsilon that is to keep
/// a ray from meeting the surface it leaves.
#pragma once

#include <bit>

#include "core/geometry/shapes.h"

namespace raypool::naive {

/// The epsilon of "Ray Tracing in One Weekend".
inline constexpr float kBookEpsilon = 1e-3F;

/// The first of two roots (near <= far) that is beyond `least`.
template <class Real>
RAYPOOL_INLINE Real root_beyond(const Mask<Real>& is_met, const Real& near, const Real& far, const Real& least) {
    const Real t = select(near > least, near, far);
    return select(is_met && t > least, t, Real(kInfinity<Real>));
}

template <class Real>
RAYPOOL_INLINE Real plain_dot(const Vec3<Real>& a, const Vec3<Real>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The quadratic of "Ray Tracing in One Weekend", chapter 6: h^2 - a c cancels where the sphere is far or huge.
template <class Real>
RAYPOOL_INLINE Real half_b_distance(const Vec3<Real>& origin, const Vec3<Real>& direction, const Vec3<Real>& center,
                                    const Real& radius, const Real& least = Real(0)) {
    const Vec3<Real> oc = vec3<Real>(center[0] - origin[0], center[1] - origin[1], center[2] - origin[2]);
    const Real a = plain_dot<Real>(direction, direction);
    const Real h = plain_dot<Real>(direction, oc);
    const Real c = plain_dot<Real>(oc, oc) - radius * radius;
    const Real discriminant = h * h - a * c;
    const Real root = sqrt(max(discriminant, Real(0)));
    return root_beyond<Real>(discriminant >= Real(0), (h - root) / a, (h + root) / a, least);
}

/// The discriminant and the roots of Haines et al. (Ray Tracing Gems, chapter 7), with the squared distance to the
/// surface as it is there, f.f - r^2, which cancels above a huge sphere.
template <class Real>
RAYPOOL_INLINE Real haines_distance(const Vec3<Real>& origin, const Vec3<Real>& direction, const Vec3<Real>& center,
                                    const Real& radius, const Real& least = Real(0)) {
    const Vec3<Real> f = vec3<Real>(origin[0] - center[0], origin[1] - center[1], origin[2] - center[2]);
    const Real b = -dot<Real>(f, direction);
    const Vec3<Real> closest = along<Real>(f, b, direction);
    const Real discriminant = radius * radius - plain_dot<Real>(closest, closest);
    const Real q = b + copysign(sqrt(max(discriminant, Real(0))), b);
    const Real other = (plain_dot<Real>(f, f) - radius * radius) / q;
    return root_beyond<Real>(discriminant >= Real(0), min(q, other), max(q, other), least);
}

/// A number known to lie in [low, high]: every operation widens by an ulp. For scalars.
template <class Scalar>
struct Bounded {
    Scalar low;
    Scalar high;

    static Bounded between(Scalar a, Scalar b) {
        const Scalar far = std::numeric_limits<Scalar>::infinity();
        return {std::nextafter(a, -far), std::nextafter(b, far)};
    }
    friend Bounded operator+(const Bounded& a, const Bounded& b) { return between(a.low + b.low, a.high + b.high); }
    friend Bounded operator-(const Bounded& a, const Bounded& b) { return between(a.low - b.high, a.high - b.low); }
    friend Bounded operator*(const Bounded& a, const Bounded& b) {
        const Scalar products[] = {a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high};
        return between(*std::min_element(products, products + 4), *std::max_element(products, products + 4));
    }
};

/// The same quadratic in interval arithmetic, a hit refused where the discriminant might be negative.
template <class Scalar>
Scalar interval_distance(const Vec3<Scalar>& origin, const Vec3<Scalar>& direction, const Vec3<Scalar>& center,
                         Scalar radius, Scalar least = 0) {
    using B = Bounded<Scalar>;
    const auto exact = [](Scalar a) { return B{a, a}; };
    B h = exact(0), a = exact(0), c = exact(0) - exact(radius) * exact(radius);
    for (int i = 0; i < 3; ++i) {
        const B d = exact(direction[i]);
        const B oc = exact(center[i]) - exact(origin[i]);
        a = a + d * d;
        h = h + d * oc;
        c = c + oc * oc;
    }
    const B discriminant = h * h - a * c;
    if (!(discriminant.low >= 0)) return kInfinity<Scalar>;
    const Scalar root = std::sqrt((discriminant.low + discriminant.high) / 2);
    const Scalar middle = (h.low + h.high) / 2;
    const Scalar norm = (a.low + a.high) / 2;
    return root_beyond<Scalar>(true, (middle - root) / norm, (middle + root) / norm, least);
}

/// A ray's origin moved off the surface along the normal, by ulps or, near zero, by 2^-16: Waechter and Binder, "A Fast
/// and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems, chapter 6. It keeps acne away at the price of
/// the displacement.
inline Vec3<float> offset_origin(const Vec3<float>& p, const Vec3<float>& normal) {
    Vec3<float> moved;
    for (int i = 0; i < 3; ++i) {
        const auto ulps = static_cast<std::int32_t>(256 * normal[i]);
        const auto bits = std::bit_cast<std::int32_t>(p[i]);
        const auto by_bits = std::bit_cast<float>(bits + (p[i] < 0 ? -ulps : ulps));
        moved[i] = std::fabs(p[i]) < 1.0F / 32 ? p[i] + normal[i] / 65536 : by_bits;
    }
    return moved;
}

}  // namespace raypool::naive
