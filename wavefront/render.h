/// From settings to a render: what wavefront/engine.h declares, as a template, instantiated in render_*.cpp.
#pragma once

#include "core/error.h"
#include "wavefront/engine.h"
#include "wavefront/rounds.h"

namespace raypool::wavefront {

/// The rounds of all threads, added up by their number.
inline std::vector<RoundWork> merged(const ThreadRounds& threads) {
    std::vector<RoundWork> rounds;
    for (const std::vector<RoundWork>& thread : threads) {
        if (thread.size() > rounds.size()) rounds.resize(thread.size());
        for (std::size_t i = 0; i < thread.size(); ++i) rounds[i].add(thread[i]);
    }
    return rounds;
}

template <SceneNeeds needs, class Real, class Work, Splitting splitting>
RenderReport render(const CompiledScene<ScalarOf<Real>>& scene, const RenderSettings& settings,
                    const PoolSettings& pool, Framebuffer& framebuffer) {
    using Scalar = ScalarOf<Real>;
    const auto accumulator = make_accumulator<Scalar>(pool.accumulator, framebuffer, settings.threads);
    const RenderContext<Scalar> context{
        scene, settings, pool, random_seed(settings.seed, settings.sampler), framebuffer.fixed_point(), *accumulator};
    const std::size_t capacity =
        std::max<std::size_t>(static_cast<std::size_t>(pool.capacity), std::size_t{1} << settings.split_depth);
    const auto threads = static_cast<std::size_t>(settings.threads);
    ThreadRounds rounds(threads);

    RenderReport report;
    if (pool.scope == PoolScope::PerThread) {
        report = render_thread_pools<needs, Real, Work, splitting>(context, capacity, rounds);
        report.pool_bytes = threads * (RayColumns<needs, Scalar>::bytes(capacity) +
                                       Stages<needs, Real, Work, splitting>::bytes(context, capacity));
    } else {
        const std::size_t batch = std::clamp<std::size_t>(static_cast<std::size_t>(pool.batch),
                                                          std::size_t{1} << settings.split_depth, capacity);
        const double begin = omp_get_wtime();
        const auto shared =
            make_shared_pool<needs, Scalar>(pool.append, capacity, batch, settings.split_depth, settings.threads);
        const double making_s = omp_get_wtime() - begin;
        report = render_shared_pool<needs, Real, Work, splitting>(context, *shared, rounds);
        report.seconds += making_s;  // threads make their own pools within the time
        report.pool_bytes =
            shared->bytes() + threads * Stages<needs, Real, Work, splitting>::bytes(context, shared->batch());
    }
    accumulator->finish();
    report.pool_bytes += accumulator->bytes();
    report.record_bytes = record_bytes<needs, Scalar>();
    report.rounds = merged(rounds);
    return report;
}

/// Picks the code compiled for what the scene needs. Counting and splitting are compiled once each, for all needs.
template <class Real>
RenderReport render(const CompiledScene<ScalarOf<Real>>& scene, const RenderSettings& settings,
                    const PoolSettings& pool, Framebuffer& framebuffer) {
    if (settings.split_depth > 0)
        return render<kEverything, Real, WorkCount, Splitting::On>(scene, settings, pool, framebuffer);
    if (settings.count_work)
        return render<kEverything, Real, WorkCount, Splitting::Off>(scene, settings, pool, framebuffer);
    return dispatch_needs(scene.needs, [&]<SceneNeeds needs>() {
        return render<needs, Real, NoWorkCount, Splitting::Off>(scene, settings, pool, framebuffer);
    });
}

}  // namespace raypool::wavefront
