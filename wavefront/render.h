/// From settings to a session: what wavefront/engine.h declares, as a template, instantiated in render_*.cpp.
#pragma once

#include "wavefront/engine.h"
#include "wavefront/rounds.h"

namespace raypool::wavefront {

template <SceneNeeds needs, class Real, class Work, Splitting splitting>
std::unique_ptr<RenderSession> begin(const CompiledScene<ScalarOf<Real>>& scene, const RenderSettings& settings,
                                     const PoolSettings& pool, Framebuffer& framebuffer) {
    if (pool.scope == PoolScope::PerThread)
        return std::make_unique<ThreadPoolSession<needs, Real, Work, splitting>>(scene, settings, pool, framebuffer);
    return std::make_unique<SharedPoolSession<needs, Real, Work, splitting>>(scene, settings, pool, framebuffer);
}

/// Picks the code compiled for what the scene needs. Counting and splitting are compiled once each, for all needs.
template <class Real>
std::unique_ptr<RenderSession> begin(const CompiledScene<ScalarOf<Real>>& scene, const RenderSettings& settings,
                                     const PoolSettings& pool, Framebuffer& framebuffer) {
    if (settings.split_depth > 0)
        return begin<kEverything, Real, WorkCount, Splitting::On>(scene, settings, pool, framebuffer);
    if (settings.count_work)
        return begin<kEverything, Real, WorkCount, Splitting::Off>(scene, settings, pool, framebuffer);
    return dispatch_needs(scene.needs, [&]<SceneNeeds needs>() {
        return begin<needs, Real, NoWorkCount, Splitting::Off>(scene, settings, pool, framebuffer);
    });
}

}  // namespace raypool::wavefront
