/// What a material does with light: a direction is sampled, and what a surface sends toward a given one is evaluated.
///
/// The two agree, as tests hold: the mean of the weights of sampled directions is the integral of bsdf_value(), and
/// bsdf_density() is the density at which directions of diffuse surfaces and fuzzy mirrors are sampled. Mirrors that
/// are not fuzzy and glass have no density: toward a direction that they did not sample they send nothing.
#pragma once

#include <numbers>

#include "core/shading/interaction.h"
#include "core/shading/materials.h"

namespace raypool {

/// Whether glass may send a path both ways instead of drawing one of them.
enum class Splitting : bool { Off, On };

/// A sampled direction. Its weight is the surface's colour, and of glass 1.
template <class Real>
struct BsdfSample {
    Vec3<Real> direction;    ///< unit; the normal where nothing scatters
    Mask<Real> is_absorbed;  ///< the direction of a mirror points below its surface, or SurfacePoint::loses() it

    // With Splitting::On, where is_split: the above is the refracted branch, and there is a reflected one.
    Mask<Real> is_split;
    Vec3<Real> reflected_direction;
    Mask<Real> is_reflected_absorbed;
    Real reflectance;  ///< the weight of the reflected branch; of the refracted one it is 1 less this
};

/// `direction` is that of the ray which arrives, and `random` a block of RandomPurpose::Scatter. With Splitting::On,
/// glass is not chosen from but split where `may_split`.
template <Features features, class Real, Splitting splitting>
RAYPOOL_INLINE BsdfSample<Real> sample_bsdf(const SurfacePoint<Real>& point,
                                            const SurfaceMaterial<features, Real>& material,
                                            const Vec3<Real>& direction, const std::array<Real, 4>& random,
                                            const Mask<Real>& may_split) {
    BsdfSample<Real> out;
    out.direction = point.normal;
    out.is_absorbed = Mask<Real>(false);
    if constexpr (splitting == Splitting::On) {
        out.is_split = Mask<Real>(false);
        out.reflected_direction = vec3<Real>(Real(0), Real(0), Real(0));
        out.is_reflected_absorbed = Mask<Real>(false);
        out.reflectance = Real(0);
    }
    const Mask<Real> is_glass = material.is_glass();
    const Mask<Real> is_metal = material.is_metal();
    const Mask<Real> is_rough = material.is_fuzzy();
    const Mask<Real> is_diffuse = material.is_diffuse();
    Vec3<Real> on_sphere = point.normal;
    if (any(is_diffuse || is_rough)) on_sphere = unit_sphere<Real>(random[0], random[1]);
    if (any(is_diffuse)) out.direction = diffuse_direction<Real>(point.normal, on_sphere);
    if constexpr (features.metal || features.dielectric) {
        if (any(is_metal || is_glass)) {
            const Vec3<Real> mirrored = mirror_direction<Real>(direction, point.normal);
            Vec3<Real> onward = mirrored;  // NOLINT(performance-unnecessary-copy-initialization): fuzz changes it
            if constexpr (features.fuzz) {
                if (any(is_rough)) {
                    onward =
                        select<Real>(is_rough, fuzzy_direction<Real>(mirrored, material.parameter, on_sphere), onward);
                }
            }
            if constexpr (features.metal) out.is_absorbed = is_metal && dot<Real>(onward, point.normal) <= Real(0);
            if constexpr (features.dielectric) {
                if (any(is_glass)) {
                    const Real ior = material.parameter;
                    const Real eta = select(point.is_front, Real(1) / ior, ior);
                    const FresnelSplit<Real> split = fresnel_split<Real>(direction, point.normal, eta);
                    Mask<Real> is_refracted = is_glass && random[2] >= split.reflectance;
                    if constexpr (splitting == Splitting::On) {
                        out.is_split = is_glass && may_split;
                        is_refracted = is_refracted || out.is_split;
                        out.reflected_direction = mirrored;
                        out.reflectance = split.reflectance;
                    }
                    onward = select<Real>(is_refracted, split.refracted, onward);
                }
            }
            out.direction = select<Real>(is_metal || is_glass, onward, out.direction);
        }
    }
    if constexpr (features.triangles) {
        if (any(point.is_bounded || point.is_bounded_beyond)) {
            const Mask<Real> is_beyond = is_glass && dot<Real>(out.direction, point.normal) < Real(0);
            out.is_absorbed = out.is_absorbed || point.loses(out.direction, is_beyond);
            if constexpr (splitting == Splitting::On)
                out.is_reflected_absorbed = point.loses(out.reflected_direction, Mask<Real>(false));
        }
    }
    return out;
}

/// Of solid angle: of sample_bsdf() at unit `direction`; `arriving` is that of the ray which arrives.
template <Features features, class Real>
RAYPOOL_INLINE Real bsdf_density(const SurfacePoint<Real>& point, const SurfaceMaterial<features, Real>& material,
                                 const Vec3<Real>& arriving, const Vec3<Real>& direction) {
    constexpr ScalarOf<Real> kInversePi = std::numbers::inv_pi_v<ScalarOf<Real>>;
    const Real cosine = dot<Real>(direction, point.normal);
    Real density = select(material.is_diffuse(), cosine * Real(kInversePi), Real(0));
    if constexpr (features.fuzz) {
        const Mask<Real> is_fuzzy = material.is_fuzzy();
        if (any(is_fuzzy)) {
            const Vec3<Real> mirrored = mirror_direction<Real>(arriving, point.normal);
            density = select(is_fuzzy, fuzzy_density<Real>(mirrored, material.parameter, direction), density);
        }
    }
    if constexpr (features.triangles) {
        if (any(point.is_bounded)) density = select(point.loses(direction, Mask<Real>(false)), Real(0), density);
    }
    return select(cosine > Real(0), density, Real(0));
}

/// The part of the light from unit `direction` that goes back along the ray which arrived: the BSDF times the cosine.
/// `colour` is the surface's.
template <Features features, class Real>
RAYPOOL_INLINE Vec3<Real> bsdf_value(const SurfacePoint<Real>& point, const SurfaceMaterial<features, Real>& material,
                                     const Vec3<Real>& colour, const Vec3<Real>& arriving,
                                     const Vec3<Real>& direction) {
    // Light is sampled as it is reflected, so that the weight of a sample is the colour.
    const Real density = bsdf_density<features, Real>(point, material, arriving, direction);
    return vec3<Real>(colour[0] * density, colour[1] * density, colour[2] * density);
}

}  // namespace raypool
