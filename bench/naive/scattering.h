/// Scattering as books have it: directions without a guard, glass with two tests for one question and Schlick's
/// polynomial in place of Fresnel's equations. The rules of the engines are in core/shading/materials.h.
#pragma once

#include "core/shading/materials.h"

namespace raypool::naive {

/// normal + a point of the unit sphere, whatever is left of it.
template <class Real>
RAYPOOL_INLINE Vec3<Real> diffuse_direction(const Vec3<Real>& normal, const Vec3<Real>& on_sphere) {
    return unit<Real>(Vec3<Real>(normal + on_sphere));
}

/// v scaled by its greatest component first: for lengths whose square is no number.
template <class Real>
RAYPOOL_INLINE Vec3<Real> scaled_unit(const Vec3<Real>& v) {
    const Real greatest = max(abs(v[0]), max(abs(v[1]), abs(v[2])));
    return unit<Real>(vec3<Real>(v[0] / greatest, v[1] / greatest, v[2] / greatest));
}

/// The mirrored direction, not made unit again.
template <class Real>
RAYPOOL_INLINE Vec3<Real> mirror_direction(const Vec3<Real>& direction, const Vec3<Real>& normal) {
    return along<Real>(direction, Real(-2) * dot<Real>(direction, normal), normal);
}

/// Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994, with the cosine of the ray that arrives,
/// as in "Ray Tracing in One Weekend", chapter 11.4.
template <class Real>
RAYPOOL_INLINE Real schlick(const Real& cosine, const Real& eta) {
    const Real at_normal = (Real(1) - eta) / (Real(1) + eta);
    const Real r0 = at_normal * at_normal;
    const Real x = Real(1) - cosine;
    return r0 + (Real(1) - r0) * (x * x * x * x * x);
}

/// Fresnel's equations without regard to eta = 1, where rounding reflects light at grazing angles.
template <class Real>
RAYPOOL_INLINE Real plain_fresnel(const Real& cosine, const Real& eta) {
    const Real cos_out = sqrt(max(Real(1) - eta * eta * (Real(1) - cosine * cosine), Real(0)));
    const Real r_s = (eta * cosine - cos_out) / (eta * cosine + cos_out);
    const Real r_p = (cosine - eta * cos_out) / (cosine + eta * cos_out);
    return (r_s * r_s + r_p * r_p) / Real(2);
}

/// Snell's law by the sine of a cosine that rounding may have put above 1: the sine is then not a number.
template <class Scalar>
FresnelSplit<Scalar> unclamped_dielectric(const Vec3<Scalar>& direction, const Vec3<Scalar>& normal, Scalar eta) {
    const Scalar cosine = -dot<Scalar>(direction, normal);
    const Scalar sine_out = eta * std::sqrt(1 - cosine * cosine);
    if (sine_out > 1) return {1, normal};
    const Scalar cos_out = std::sqrt(1 - sine_out * sine_out);
    return {schlick<Scalar>(cosine, eta),
            unit<Scalar>(Vec3<Scalar>(eta * direction + (eta * cosine - cos_out) * normal))};
}

/// Total reflection is decided by the sine, and the root is taken of another form of the same number: where the two
/// disagree it is that of a negative one.
template <class Scalar>
FresnelSplit<Scalar> sine_dielectric(const Vec3<Scalar>& direction, const Vec3<Scalar>& normal, Scalar eta) {
    const Scalar cosine = std::min(-dot<Scalar>(direction, normal), Scalar(1));
    const Scalar sine = std::sqrt(1 - cosine * cosine);
    if (eta * sine > 1) return {1, normal};
    const Scalar cos_out = std::sqrt(1 - eta * eta * (1 - cosine * cosine));
    return {schlick<Scalar>(cosine, eta),
            unit<Scalar>(Vec3<Scalar>(eta * direction + (eta * cosine - cos_out) * normal))};
}

}  // namespace raypool::naive
