#include "wavefront/render.h"
#include "wavefront/rounds.h"

namespace raypool::wavefront {

template <Features features, class Scalar>
std::unique_ptr<RenderSession> begin_session(const CompiledScene<Scalar>& scene, const RenderSettings& settings,
                                             const PoolSettings& pool, Framebuffer& framebuffer,
                                             const StagesMaker<features, Scalar>& maker) {
    if (pool.scope == PoolScope::PerThread)
        return std::make_unique<ThreadPoolSession<features, Scalar>>(scene, settings, pool, framebuffer, maker);
    return std::make_unique<SharedPoolSession<features, Scalar>>(scene, settings, pool, framebuffer, maker);
}

constexpr Features kStill = record_features({});
constexpr Features kMoving = record_features(kEverything);

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
