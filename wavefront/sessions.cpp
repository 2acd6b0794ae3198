#include "wavefront/render.h"
#include "wavefront/rounds.h"

namespace raypool::wavefront {

template <SceneNeeds needs, class Scalar>
std::unique_ptr<RenderSession> begin_session(const CompiledScene<Scalar>& scene, const RenderSettings& settings,
                                             const PoolSettings& pool, Framebuffer& framebuffer,
                                             const StagesMaker<needs, Scalar>& maker) {
    if (pool.scope == PoolScope::PerThread)
        return std::make_unique<ThreadPoolSession<needs, Scalar>>(scene, settings, pool, framebuffer, maker);
    return std::make_unique<SharedPoolSession<needs, Scalar>>(scene, settings, pool, framebuffer, maker);
}

constexpr SceneNeeds kStill = record_needs({});
constexpr SceneNeeds kMoving = record_needs(kEverything);

template std::unique_ptr<RenderSession> begin_session(const CompiledScene<float>&, const RenderSettings&,
                                                      const PoolSettings&, Framebuffer&,
                                                      const StagesMaker<kStill, float>&);
template std::unique_ptr<RenderSession> begin_session(const CompiledScene<float>&, const RenderSettings&,
                                                      const PoolSettings&, Framebuffer&,
                                                      const StagesMaker<kMoving, float>&);
#ifndef RAYPOOL_NO_DOUBLE
template std::unique_ptr<RenderSession> begin_session(const CompiledScene<double>&, const RenderSettings&,
                                                      const PoolSettings&, Framebuffer&,
                                                      const StagesMaker<kMoving, double>&);
#endif

}  // namespace raypool::wavefront
