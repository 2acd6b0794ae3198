#include "bench/studies/recorded_rays.h"

#include "core/runtime/loop.h"
#include "recursive/tracer.h"

namespace raypool::studies {

namespace {

struct LoggedRay {
    Ray<float> ray;
    std::int32_t leaving_id;
    Occlusion<float> light;
};

/// Finds hits as recursion does, and keeps the rays.
struct RayLog : NoTestCount {
    std::array<std::vector<LoggedRay>, kRayKinds.size()> rays;
    int bounce = 0;

    void add(const Ray<float>& ray, std::int32_t leaving_id) {
        bounce = leaving_id == kNoPrimitive ? 0 : bounce + 1;  // camera rays leave nothing
        const std::size_t kind = bounce == 0 ? 0 : bounce == 1 ? 1 : bounce == 4 ? 2 : kRayKinds.size();
        if (kind < kRayKinds.size()) rays[kind].push_back({ray, leaving_id, {}});
    }
    void add_shadow(const Ray<float>& ray, std::int32_t leaving_id, const Occlusion<float>& light) {
        if (bounce == 0) rays[3].push_back({ray, leaving_id, light});
    }
};

template <Features features>
Hit<float> closest_hit(const SceneView<float>& scene, const Ray<float>& ray, std::int32_t leaving_id, RayLog& log) {
    log.add(ray, leaving_id);
    NoTestCount nothing;
    return raypool::closest_hit<features>(scene, ray, leaving_id, nothing);
}

template <Features features>
bool is_occluded(const SceneView<float>& scene, const Ray<float>& ray, std::int32_t leaving_id,
                 const Occlusion<float>& light, RayLog& log) {
    log.add_shadow(ray, leaving_id, light);
    NoTestCount nothing;
    return raypool::is_occluded<features, float>(scene, ray, leaving_id, light, nothing);
}

RecordedRays in_columns(std::size_t kind, const std::vector<LoggedRay>& rays) {
    const std::size_t room = rays.size() + wavefront::kPadding;
    RecordedRays recorded{.kind = kRayKinds[kind],
                          .are_camera = kind == 0,
                          .are_shadow = kind == 3,
                          .count = rays.size(),
                          .records = RecordedRays::Records(rays.size()),
                          .light_t = std::vector<float>(room),
                          .light_id = std::vector<std::int32_t>(room, kNoPrimitive)};
    for (std::size_t i = 0; i < rays.size(); ++i) {
        RayRecord<float> record{};
        record.ray = rays[i].ray;
        record.leaving_id = static_cast<std::uint32_t>(rays[i].leaving_id);
        recorded.records.append<float>(i, record, 1, rays.size());
        recorded.light_t[i] = rays[i].light.t;
        recorded.light_id[i] = rays[i].light.light_id;
    }
    return recorded;
}

}  // namespace

std::array<RecordedRays, kRayKinds.size()> record_rays(const CompiledScene<float>& scene, RenderSettings settings) {
    settings.light_sampling = LightSampling::Mis;
    settings.depth = 5;
    const FlushDenormals flush;
    recursive::Tracer<kEverything, float, RayLog, Splitting::Off> tracer(
        scene, settings, fixed_point(scene, settings, settings.end_sample));
    for (std::int64_t y = 0; y < scene.height; ++y)
        for (std::int64_t x = 0; x < scene.width; ++x)
            for (std::int64_t s = settings.first_sample; s < settings.end_sample; ++s)
                tracer.sample<recursive::Form::Iterative>(x, y, s);
    const auto& rays = tracer.work().rays;
    return {in_columns(0, rays[0]), in_columns(1, rays[1]), in_columns(2, rays[2]), in_columns(3, rays[3])};
}

}  // namespace raypool::studies
