/// What a path begins with, and what a segment makes of it. All physics is in core/; the forms differ in nothing but
/// which thread does what when.
#pragma once

#include <cstdint>

#include "core/shading/camera.h"
#include "core/shading/ray_record.h"
#include "core/shading/shade.h"
#include "gpu/launch.h"
#include "gpu/walk.h"

namespace raypool::gpu {

/// Path `path` of a launch at the camera.
template <Features features>
RAYPOOL_INLINE RayRecord<float> camera_record(const Launch& launch, std::int64_t path) {
    const std::int64_t sample = path / launch.pixel_count;
    const auto number = static_cast<std::uint32_t>(path - sample * launch.pixel_count);
    RayRecord<float> record;
    record.key = {launch.pixels == nullptr ? number : launch.pixels[number],
                  static_cast<std::uint32_t>(launch.first_sample + sample)};
    const auto width = static_cast<std::uint32_t>(launch.scene.width);
    const std::uint32_t y = record.key.pixel / width;
    const std::uint32_t x = record.key.pixel - y * width;
    record.ray = camera_ray<features, float>(launch.scene.camera, static_cast<float>(x), static_cast<float>(y),
                                             record.key.pixel, record.key.sample, launch.seed);
    record.throughput = vec3<float>(1, 1, 1);
    record.leaving_id = static_cast<std::uint32_t>(kNoPrimitive);
    record.step = 0;
    record.density = 0;
    return record;
}

/// A ray toward a light, and what it brings home if nothing lies before it.
struct ShadowRay {
    Ray<float> ray;
    std::uint32_t leaving_id;
    float t;  ///< of the light
    std::uint32_t light_id;
    Vec3<float> radiance;
    std::uint32_t cell;  ///< of the framebuffer
};

/// Of a record whose ray was traced: calls add(radiance) with what its path brings home, reach(ShadowRay) with a ray
/// toward a light, and makes it the record of the next segment. Returns whether there is one.
template <Features features, class Add, class Reach>
RAYPOOL_INLINE bool shade(const Launch& launch, const Hit<float>& hit, RayRecord<float>& record, Add add, Reach reach) {
    const SceneView<float>& scene = launch.scene;
    if (hit.primitive_id == kNoPrimitive) {
        add(escaping_radiance<features, float>(scene, record.ray.direction, record.throughput, launch.light_sampling,
                                               record.density));
        return false;
    }
    LightPart<float> lights;
    if constexpr (features.lights) {
        lights.sampling = launch.light_sampling;
        lights.arriving_density = record.density;
        lights.depth = launch.depth;
    }
    const Scattered<float> out =
        scatter<features, float>(scene, record.ray, hit.t, hit.primitive_id, record.throughput, record.key, record.step,
                                 launch.seed, 0, launch.roulette, features.lights ? &lights : nullptr);
    if constexpr (features.lights) {
        if (lights.has_shadow_ray)
            reach(ShadowRay{{out.start.origin, lights.light.direction, record.ray.time},
                            static_cast<std::uint32_t>(out.start.leaving_id),
                            lights.light.t,
                            static_cast<std::uint32_t>(lights.light.primitive_id),
                            lights.radiance,
                            cell_of<std::uint32_t>(launch.has_halves, record.key.pixel, record.key.sample)});
        record.density = lights.density;
    }
    if (out.is_emitter) {
        add(out.throughput);
        return false;
    }
    record.ray = {out.start.origin, out.direction, record.ray.time};
    record.throughput = out.throughput;
    record.leaving_id = static_cast<std::uint32_t>(out.start.leaving_id);
    ++record.step;
    return out.is_alive && record.step != static_cast<std::uint32_t>(launch.depth);
}

template <Features features>
RAYPOOL_INLINE Hit<float> trace(const Launch& launch, const RayRecord<float>& record) {
    return closest_hit<features>(launch.scene, record.ray, static_cast<std::int32_t>(record.leaving_id));
}
template <Features features>
RAYPOOL_INLINE bool is_seen(const Launch& launch, const ShadowRay& shadow) {
    return !is_occluded<features>(launch.scene, shadow.ray, static_cast<std::int32_t>(shadow.leaving_id),
                                  {shadow.t, static_cast<std::int32_t>(shadow.light_id)});
}

}  // namespace raypool::gpu
