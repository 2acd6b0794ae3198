/// What happens to a ray at the end of its segment: it leaves for the sky, meets an emitter, or is scattered.
///
/// Called by every engine, one ray or a register of rays at a time, with the same bits per ray either way. A path is
/// carried on by value: throughput is multiplied down the path in one order, so that engines agree.
#pragma once

#include "core/math/path.h"
#include "core/math/random.h"
#include "core/shading/bsdf.h"
#include "core/shading/lights.h"
#include "core/shading/roulette.h"

namespace raypool {

/// Radiance from the direction of a ray that met nothing.
template <class Real>
RAYPOOL_INLINE Vec3<Real> sky_radiance(const Sky<ScalarOf<Real>>& sky, const Vec3<Real>& direction) {
    return along<Real>(broadcast<Real>(sky.middle), direction[1], broadcast<Real>(sky.slope));
}

/// What a path brings home whose ray met nothing. `arriving_density` is RayRecord::density; where lights were sampled
/// too, an image around the scene is shared with them (share_with_lights()).
template <Features features, class Real>
RAYPOOL_INLINE Vec3<Real> escaping_radiance(const SceneView<ScalarOf<Real>>& scene, const Vec3<Real>& direction,
                                            const Vec3<Real>& throughput,
                                            [[maybe_unused]] LightSampling sampling = LightSampling::None,
                                            [[maybe_unused]] const Real& arriving_density = Real(0)) {
    if constexpr (features.environment) {
        if (!scene.environment.texels.empty()) {
            const EnvironmentSight<Real> seen = see_environment<Real>(scene.environment, direction);
            Vec3<Real> radiance = product<Real>(throughput, seen.radiance);
            if constexpr (features.lights) {
                const Mask<Real> is_sampled = arriving_density > Real(0) && seen.density > Real(0);
                const Real share =
                    sampling == LightSampling::Mis ? arriving_density / (arriving_density + seen.density) : Real(0);
                for (int i = 0; i < 3; ++i) radiance[i] = select(is_sampled, radiance[i] * share, radiance[i]);
            }
            return radiance;
        }
    }
    return product<Real>(throughput, sky_radiance<Real>(scene.sky, direction));
}

/// A path after a hit.
template <class Real>
struct Scattered {
    RayStart<Real> start;
    Vec3<Real> direction;
    Vec3<Real> throughput;  ///< where is_emitter: the radiance that the path brings home
    Mask<Real> is_alive;    ///< the path goes on
    Mask<Real> is_emitter;  ///< the path ends on an emitter

    // With Splitting::On, and where is_split: the above is the refracted branch, and there is a reflected one.
    Mask<Real> is_split;
    RayStart<Real> reflected_start;
    Vec3<Real> reflected_direction;
    Vec3<Real> reflected_throughput;
    Mask<Real> is_reflected_alive;
};

/// What light sampling asks and says at a hit: with Features::lights.
template <class Real>
struct LightPart {
    LightSampling sampling = LightSampling::None;
    Real arriving_density = Real(0);  ///< RayRecord::density of the ray that arrives
    std::int32_t depth = 0;           ///< most segments of a path

    // Set by scatter(), unless the sampling is None.
    Real density = Real(0);  ///< of the direction of what goes on, where lights were sampled too; else 0
    Mask<Real> has_shadow_ray = Mask<Real>(false);
    LightSample<Real> light;  ///< what the shadow ray is to reach
    Vec3<Real> radiance;      ///< what the path brings home if nothing lies before the light
};

/// sample_light() by a call: a recursion has its frame at every depth, and needs none of the temporaries there.
template <Features features, class Real>
[[gnu::noinline]] RAYPOOL_HOST_DEVICE LightSample<Real> call_sample_light(const SceneView<ScalarOf<Real>>& scene,
                                                                          const RayStart<Real>& start, const Real& time,
                                                                          const std::array<Real, 4>& random,
                                                                          LightSurface<Real>& surface) {
    return sample_light<features, Real>(scene, start, time, random, surface);
}

/// Weighs what is found on a light by chance, and samples a light where a surface has a density. Weights are shares of
/// what either technique would bring alone: no part of a path brings more than throughput times radiance.
template <Features features, class Real>
RAYPOOL_INLINE void share_with_lights(const SceneView<ScalarOf<Real>>& scene, const Ray<Real>& ray, const Real& t,
                                      const Int<Real>& primitive_id, const Real* row, const PathKey<Real>& key,
                                      const Uint32<Real>& step, const RandomSeed& seed, const SurfacePoint<Real>& point,
                                      const SurfaceMaterial<features, Real>& material, LightPart<Real>& lights,
                                      Scattered<Real>& out) {
    const bool is_shared = lights.sampling == LightSampling::Mis;
    if (any(out.is_emitter && lights.arriving_density > Real(0))) {
        const Int<Real> emitter_id = select(out.is_emitter, primitive_id, Int<Real>(0));
        const Real weight = detail::gather<Real>(scene.light_weights.data(), emitter_id);
        const Mask<Real> is_sampled = out.is_emitter && lights.arriving_density > Real(0) && weight > Real(0);
        const Real density = light_density<features, Real>(ray, t, weight, row);
        const Real share = is_shared ? lights.arriving_density / (lights.arriving_density + density) : Real(0);
        for (int i = 0; i < 3; ++i)
            out.throughput[i] = select(is_sampled, out.throughput[i] * share, out.throughput[i]);
    }
    const auto most_hits =
        static_cast<ScalarOf<Real>>(lights.depth - 1 < kMostSampledHits ? lights.depth - 1 : kMostSampledHits);
    lights.has_shadow_ray =
        material.has_density() && from_uint32<Real>(path_step::bounce<Uint32<Real>>(step)) < Real(most_hits);
    lights.density = select(lights.has_shadow_ray,
                            bsdf_density<features, Real>(point, material, ray.direction, out.direction), Real(0));
    if (none(lights.has_shadow_ray)) return;

    LightSurface<Real> surface;
    const std::array<Real, 4> random = random_block<Real>(key, step, RandomPurpose::Light, seed);
    if constexpr (Simd<Real>) {
        lights.light = sample_light<features, Real>(scene, out.start, ray.time, random, surface);
    } else {
        lights.light = call_sample_light<features, Real>(scene, out.start, ray.time, random, surface);
    }
    LightSample<Real>& light = lights.light;
    const Mask<Real> is_around = light.template is_environment<features>();
    Real of_light(0);
    Vec3<Real> radiance = vec3<Real>(Real(0), Real(0), Real(0));
    if (features.environment && any(is_around)) {
        const std::array<Real, 4> choice = random_block<Real>(key, step, RandomPurpose::Environment, seed);
        const EnvironmentSample<Real> around =
            sample_environment<Real>(scene.environment, choice, random[1], random[2]);
        light.direction = select<Real>(is_around, around.direction, light.direction);
        light.is_seen = light.is_seen || is_around;
        of_light = around.density;
        radiance = around.radiance;
    }
    const Real density = bsdf_density<features, Real>(point, material, ray.direction, light.direction);
    lights.has_shadow_ray = lights.has_shadow_ray && density > Real(0) && light.is_seen;
    if (none(lights.has_shadow_ray)) return;
    const Ray<Real> shadow_ray{out.start.origin, light.direction, ray.time};
    if (!all(is_around)) {
        const Int<Real> id =
            features.environment ? select(is_around, Int<Real>(0), light.primitive_id) : light.primitive_id;
        const Real weight = detail::gather<Real>(scene.light_weights.data(), id);
        of_light = select(is_around, of_light, light_density<features, Real>(shadow_ray, light.t, weight, surface.row));
        radiance = select<Real>(
            is_around, radiance,
            emitted_radiance<features, Real>(scene, shadow_ray, light, surface, lights.has_shadow_ray && !is_around));
    }
    const Real share = density / (is_shared ? of_light + density : of_light);
    for (int i = 0; i < 3; ++i) lights.radiance[i] = out.throughput[i] * (radiance[i] * share);
    lights.has_shadow_ray = lights.has_shadow_ray && carries_light<Real>(lights.radiance);
}

/// Scatters rays that hit primitive `primitive_id` (valid in every lane, also those the caller ignores) at distance t.
/// `step` is the path's (path_step). A path that can carry nothing any more is not alive. With Splitting::On, the first
/// `split_depth` hits on glass split a path in two, weighted by Fresnel's reflectance. With `roulette`, paths end by
/// chance after kHitsBeforeRoulette hits; both branches of a split play with one number. `lights` is not null where
/// lights may be sampled.
template <Features features, class Real, Splitting splitting = Splitting::Off>
RAYPOOL_INLINE Scattered<Real> scatter(const SceneView<ScalarOf<Real>>& scene, const Ray<Real>& ray, const Real& t,
                                       const Int<Real>& primitive_id, const Vec3<Real>& throughput,
                                       const PathKey<Real>& key, const Uint32<Real>& step, const RandomSeed& seed,
                                       int split_depth = 0, bool roulette = false,
                                       [[maybe_unused]] LightPart<Real>* lights = nullptr) {
    using Row = SurfaceRow<ScalarOf<Real>>;
    Real row[Row::kColumns];
    const TrianglePoint<Real> triangle = load_surface<features, Real>(scene, ray, primitive_id, row);
    const SurfaceCode<Int<Real>> code{bits_of<Real>(row[Row::kCode])};
    SurfacePoint<Real> point = surface_point<features, Real>(ray, t, row);
    if constexpr (features.triangles) triangle.place(point);
    const std::array<Real, 4> random = random_block<Real>(key, step, RandomPurpose::Scatter, seed);

    Scattered<Real> out;
    set_ray_start<features, Real>(out.start, point, triangle, primitive_id, row);
    const SurfaceMaterial<features, Real> material{code.material(), row[Row::kParameter]};
    out.is_emitter = material.is_emitter();

    const Mask<Real> is_glass = material.is_glass();  // glass has no colour
    const Vec3<Real> colour =
        surface_colour<features, Real>(scene, point, triangle, primitive_id, row, code, !is_glass);
    for (int i = 0; i < 3; ++i) out.throughput[i] = select(is_glass, throughput[i], throughput[i] * colour[i]);
    if constexpr (features.emissive) {
        if (any(out.is_emitter)) {
            const Real emission = select(out.is_emitter, material.emission(point.is_front), Real(1));
            for (int i = 0; i < 3; ++i) out.throughput[i] = out.throughput[i] * emission;
        }
    }

    Mask<Real> may_split(false);
    if constexpr (splitting == Splitting::On) {
        const Real most_branches(static_cast<ScalarOf<Real>>((1 << split_depth) - 1));
        may_split = from_uint32<Real>(path_step::branch<Uint32<Real>>(step)) < most_branches;
    }
    const BsdfSample<Real> sample =
        sample_bsdf<features, Real, splitting>(point, material, ray.direction, random, may_split);
    out.direction = sample.direction;
    if constexpr (features.lights) {
        if (lights != nullptr && lights->sampling != LightSampling::None)
            share_with_lights<features, Real>(scene, ray, t, primitive_id, row, key, step, seed, point, material,
                                              *lights, out);
    }
    if constexpr (splitting == Splitting::On) out.reflected_start = out.start;
    if constexpr (features.triangles && features.dielectric) {
        const Mask<Real> is_through =
            triangle.is_here && is_glass && dot<Real>(sample.direction, point.normal) < Real(0);
        if (any(is_through)) set_start_beyond<Real>(out.start, point, triangle, primitive_id, is_through);
    }
    if constexpr (splitting == Splitting::On) {
        out.is_split = sample.is_split;
        out.reflected_direction = sample.reflected_direction;
        const Real transmittance = Real(1) - sample.reflectance;
        for (int i = 0; i < 3; ++i) {
            out.reflected_throughput[i] = throughput[i] * sample.reflectance;
            out.throughput[i] = select(out.is_split, throughput[i] * transmittance, out.throughput[i]);
        }
    }

    out.is_alive = carries_light<Real>(out.throughput) && !(sample.is_absorbed || out.is_emitter);
    if constexpr (splitting == Splitting::On) {
        out.is_reflected_alive =
            out.is_split && carries_light<Real>(out.reflected_throughput) && !sample.is_reflected_absorbed;
    }
    if (roulette) [[unlikely]] {
        const Mask<Real> is_played = plays_roulette<Real>(step);
        const Mask<Real> survives = survives_roulette<Real>(out.throughput, random[3], is_played && !out.is_emitter);
        out.is_alive = out.is_alive && survives;
        if constexpr (splitting == Splitting::On) {
            const Mask<Real> survives_too = survives_roulette<Real>(out.reflected_throughput, random[3], is_played);
            out.is_reflected_alive = out.is_reflected_alive && survives_too;
        }
    }
    return out;
}

}  // namespace raypool
