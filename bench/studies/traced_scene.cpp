#include "bench/studies/traced_scene.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "bench/studies/generated_scene.h"
#include "core/base/clock.h"

namespace raypool::studies {

TracedScene::TracedScene(const std::string& kind, std::int64_t triangles, std::int64_t width,
                         const RenderSettings& settings)
    : scene(generated_scene(kind, triangles, width)) {
    const RaySearch single = single_rays(scene->compiled);
    for (RecordedRays& rays : record_rays(scene->compiled, settings)) {
        if (rays.count == 0) throw std::runtime_error(fmt::format("{} has no {} rays", scene->name, rays.kind));
        RayAnswers answers(rays.count);
        single(rays, answers);
        kinds.push_back({std::move(rays), std::move(answers)});
    }
}

void for_each_traced_scene(const std::vector<std::string>& kinds, const std::vector<std::int64_t>& sizes,
                           std::int64_t width, const RenderSettings& settings,
                           const std::function<void(const std::string&, std::int64_t, const LazyTracedScene&)>& visit) {
    constexpr std::int64_t kLargestOfAll = 1'000'000;
    for (const std::string& kind : kinds) {
        for (const std::int64_t triangles : sizes) {
            if (triangles > kLargestOfAll && kind != kinds.front()) continue;
            visit(kind, triangles,
                  std::make_shared<Lazy<TracedScene>>([=] { return TracedScene(kind, triangles, width, settings); }));
        }
    }
}

TimedSearch time_search(const RaySearch& search, const TracedRays& traced, bool is_ours, const std::string& who) {
    const auto& [rays, expected] = traced;
    RayAnswers found(rays.count);
    const double start = wall_seconds();
    search(rays, found);
    TimedSearch timed{.seconds = wall_seconds() - start};

    constexpr float kTie = 1e-4F;
    for (std::size_t i = 0; i < rays.count; ++i) {
        if (found.primitive_id[i] == expected.primitive_id[i]) continue;
        ++timed.others;
        if (!rays.are_shadow && !(std::abs(found.distance[i] - expected.distance[i]) <= kTie * expected.distance[i]))
            ++timed.far_apart;
    }
    const bool is_same = timed.others == 0 && (rays.are_shadow || found.distance == expected.distance);
    constexpr std::int64_t kRaysForOneOther = 1000;
    const std::int64_t wrong = rays.are_shadow ? timed.others : timed.far_apart;  // faces that touch are both right
    if (is_ours ? !is_same : wrong * kRaysForOneOther > static_cast<std::int64_t>(rays.count))
        throw std::runtime_error(
            fmt::format("of {} {} rays {} got another answer from {}", rays.count, rays.kind, timed.others, who));
    return timed;
}

}  // namespace raypool::studies
