/// Warps from the unit square, and the elementary functions they need.
///
/// Sine, cosine and arc tangent are polynomials of ours: library versions differ between widths, and these do not.
#pragma once

#include <array>
#include <numbers>
#include <type_traits>

#include "core/math/vec.h"

namespace raypool {

template <class Real>
struct SinCos {
    Real sin;
    Real cos;
};

namespace detail {
/// What coefficients of series are made in before they are rounded to a scalar: no wider than a GPU has.
template <class S>
using CoefficientMaker = std::conditional_t<sizeof(S) == 4, double, S>;
}  // namespace detail

/// Sine and cosine of 2 pi u for u in [0, 1). The nearest quarter turn is taken off exactly; what is left, within an
/// eighth of a turn, goes through Taylor polynomials. Error below 1.5 ulp of 1 in float, 3e-16 in double.
template <class Real>
RAYPOOL_INLINE SinCos<Real> sincos_of_turn(const Real& u) {
    const Real quarter = floor(mad<Real>(Real(4), u, Real(0.5F)));
    using S = ScalarOf<Real>;
    using Maker = detail::CoefficientMaker<S>;
    const Real x = nmad<Real>(Real(0.25F), quarter, u) * Real(S(2 * std::numbers::pi_v<Maker>));
    const Real x2 = x * x;

    // Taylor coefficients, as many as the precision of the scalar needs for |x| <= pi / 4.
    constexpr int kTerms = sizeof(S) == 4 ? 5 : sizeof(S) == 8 ? 9 : 11;
    Real s(0), c(0);
    RAYPOOL_UNROLL for (int k = kTerms - 1; k >= 0; --k) {
        Maker odd = 1, even = 1;  // (2k + 1)! and (2k)!
        RAYPOOL_UNROLL for (int i = 2; i <= 2 * k + 1; ++i) odd *= i;
        RAYPOOL_UNROLL for (int i = 2; i <= 2 * k; ++i) even *= i;
        const int sign = k % 2 == 0 ? 1 : -1;
        s = mad<Real>(s, x2, Real(S(sign / odd)));
        c = mad<Real>(c, x2, Real(S(sign / even)));
    }
    s = s * x;

    // quarter is 0..4: swap for odd ones, then give the signs of the quadrant.
    const Real half = floor(quarter * Real(0.5F));
    const Mask<Real> is_odd = nmad<Real>(Real(2), half, quarter) == Real(1);
    const Mask<Real> is_back = half == Real(1);  // quarters 2 and 3
    const Real sin_value = select(is_odd, c, s);
    const Real cos_value = select(is_odd, -s, c);
    return {select(is_back, -sin_value, sin_value), select(is_back, -cos_value, cos_value)};
}

/// The angle of (x, y) in turns, in [0, 1]; 0 for the zero vector. Error below 1e-6 turns in float, 1e-13 in double.
template <class Real>
RAYPOOL_INLINE Real turn_of_angle(const Real& y, const Real& x) {
    using S = ScalarOf<Real>;
    using Maker = detail::CoefficientMaker<S>;
    const Real ax = abs(x);
    const Real ay = abs(y);
    const Mask<Real> is_steep = ay > ax;
    const Real high = select(is_steep, ay, ax);
    const Real low = select(is_steep, ax, ay);
    const Real ratio = select(high == Real(0), Real(0), low / select(high == Real(0), Real(1), high));

    // atan(r) for r in [0, 1]: halve the angle twice, atan(r) = 2 atan(r / (1 + sqrt(1 + r^2))), then the series.
    Real r = ratio;
    for (int i = 0; i < 2; ++i) r = r / (Real(1) + sqrt(mad<Real>(r, r, Real(1))));
    const Real r2 = r * r;
    constexpr int kTerms = sizeof(S) == 4 ? 6 : 13;
    Real sum(0);
    RAYPOOL_UNROLL for (int k = kTerms - 1; k >= 0; --k) {
        const int sign = k % 2 == 0 ? 1 : -1;
        sum = mad<Real>(sum, r2, Real(S(sign / static_cast<Maker>(2 * k + 1))));
    }
    const Real eighth = r * sum * Real(S(4 / (2 * std::numbers::pi_v<Maker>)));

    const Real quarter = select(is_steep, Real(0.25F) - eighth, eighth);
    const Real half = select(x < Real(0), Real(0.5F) - quarter, quarter);
    return select(y < Real(0), Real(1) - half, half);
}

/// A direction uniform on the unit sphere (Archimedes: the height is uniform).
template <class Real>
RAYPOOL_INLINE Vec3<Real> unit_sphere(const Real& u, const Real& v) {
    const Real z = nmad<Real>(Real(2), u, Real(1));
    const Real radius = sqrt(max(nmad<Real>(z, z, Real(1)), Real(0)));
    const SinCos<Real> angle = sincos_of_turn<Real>(v);
    return vec3<Real>(radius * angle.cos, radius * angle.sin, z);
}

/// A point uniform in the unit disc.
template <class Real>
RAYPOOL_INLINE std::array<Real, 2> unit_disc(const Real& u, const Real& v) {
    const Real radius = sqrt(u);
    const SinCos<Real> angle = sincos_of_turn<Real>(v);
    return {radius * angle.cos, radius * angle.sin};
}

}  // namespace raypool
