/// How surfaces send light on: the three scattering rules, each written once for any Real.
///
/// A rule takes the unit direction of the ray that arrives, the unit normal on the side it arrives from, and numbers
/// in [0, 1); it returns a unit direction. Diffuse is Lambert's law sampled by its cosine, so the albedo alone is the
/// weight of a sample; metal is "Ray Tracing in One Weekend"'s fuzzy mirror, whose fuzz may dip below the surface and
/// is then absorbed (a loss of the model: a white fuzzy metal is darker than white at grazing angles); glass follows
/// Fresnel's equations for unpolarised light exactly.
#pragma once

#include <numbers>

#include "core/math/sampling.h"

namespace raypool {

/// normal + a point of the unit sphere, which is distributed as the cosine; the normal itself where the two cancel.
template <class Real>
RAYPOOL_INLINE Vec3<Real> diffuse_direction(const Vec3<Real>& normal, const Vec3<Real>& on_sphere) {
    const Vec3<Real> w = vec3<Real>(normal[0] + on_sphere[0], normal[1] + on_sphere[1], normal[2] + on_sphere[2]);
    const Mask<Real> is_short = dot<Real>(w, w) < Real(1e-12F);
    return unit<Real>(select<Real>(is_short, normal, w));
}

template <class Real>
RAYPOOL_INLINE Vec3<Real> mirror_direction(const Vec3<Real>& direction, const Vec3<Real>& normal) {
    const Real twice = Real(-2) * dot<Real>(direction, normal);
    return unit<Real>(along<Real>(direction, twice, normal));
}

/// The mirrored direction moved within a sphere of radius `fuzz`. May point below the surface.
template <class Real>
RAYPOOL_INLINE Vec3<Real> fuzzy_direction(const Vec3<Real>& mirrored, const Real& fuzz, const Vec3<Real>& on_sphere) {
    const Vec3<Real> w = along<Real>(mirrored, fuzz, on_sphere);
    const Mask<Real> is_short = dot<Real>(w, w) < Real(1e-12F);
    return unit<Real>(select<Real>(is_short, mirrored, w));
}

/// Of solid angle: of fuzzy_direction() at unit `direction`, for fuzz in (0, 1]. The direction passes the sphere around
/// the end of the mirrored one at two distances, cos +- chord / 2. At each, area has the density 1 / (4 pi fuzz^2), and
/// solid angle has distance^2 over the cosine to the sphere's normal of area, which is chord / 2 over fuzz.
template <class Real>
RAYPOOL_INLINE Real fuzzy_density(const Vec3<Real>& mirrored, const Real& fuzz, const Vec3<Real>& direction) {
    const Real cosine = dot<Real>(mirrored, direction);
    const Vec3<Real> across = cross<Real>(mirrored, direction);
    const Real square = fuzz * fuzz - dot<Real>(across, across);
    const Real half_chord = sqrt(max(square, Real(1e-20F)));
    const Real near = max(cosine - half_chord, Real(0));
    const Real far = max(cosine + half_chord, Real(0));
    constexpr ScalarOf<Real> kFourPi = 4 * std::numbers::pi_v<ScalarOf<Real>>;
    const Real density = mad<Real>(near, near, far * far) / (Real(kFourPi) * fuzz * half_chord);
    return select(square > Real(0), density, Real(0));
}

/// What happens at a smooth boundary between two media.
template <class Real>
struct FresnelSplit {
    Real reflectance;      ///< in [0, 1]; 1 beyond the critical angle
    Vec3<Real> refracted;  ///< unit; without meaning where reflectance is 1
};

/// `eta` is the index of refraction on the arriving side over that on the other side. Total reflection is decided by
/// the very discriminant whose root is taken, so neither side of the decision can meet a negative root. Where
/// eta = 1 the boundary is invisible: no reflection, and the direction's bits pass unchanged.
template <class Real>
RAYPOOL_INLINE FresnelSplit<Real> fresnel_split(const Vec3<Real>& direction, const Vec3<Real>& normal,
                                                const Real& eta) {
    const Real cos_in = min(-dot<Real>(direction, normal), Real(1));
    const Real k = nmad<Real>(eta * eta, nmad<Real>(cos_in, cos_in, Real(1)), Real(1));
    const Mask<Real> is_total = k < Real(0);
    const Real cos_out = sqrt(max(k, Real(0)));

    const Real s_in = eta * cos_in;
    const Real p_out = eta * cos_out;
    const Real r_s = (s_in - cos_out) / (s_in + cos_out);
    const Real r_p = (cos_in - p_out) / (cos_in + p_out);
    const Real r = Real(0.5F) * mad<Real>(r_s, r_s, r_p * r_p);

    const Mask<Real> is_invisible = eta == Real(1);
    const Real scale = s_in - cos_out;
    Vec3<Real> bent;
    for (int i = 0; i < 3; ++i) bent[i] = mad<Real>(scale, normal[i], eta * direction[i]);

    FresnelSplit<Real> split;
    split.reflectance = select(is_invisible, Real(0), select(is_total, Real(1), min(r, Real(1))));
    split.refracted = select<Real>(is_invisible, direction, unit<Real>(select<Real>(is_total, normal, bent)));
    return split;
}

}  // namespace raypool
