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
constexpr Features kStillWithLights = record_features({.lights = true});
constexpr Features kMoving = record_features(kAllButLights);
constexpr Features kMovingWithLights = record_features(kEverything);

#define RAYPOOL_SESSION(features, scalar)                                                                      \
    template std::unique_ptr<RenderSession> begin_session(const CompiledScene<scalar>&, const RenderSettings&, \
                                                          const PoolSettings&, Framebuffer&,                   \
                                                          const StagesMaker<features, scalar>&);
RAYPOOL_SESSION(kStill, float)
RAYPOOL_SESSION(kStillWithLights, float)
RAYPOOL_SESSION(kMoving, float)
RAYPOOL_SESSION(kMovingWithLights, float)
#ifndef RAYPOOL_NO_DOUBLE
RAYPOOL_SESSION(kMoving, double)
RAYPOOL_SESSION(kMovingWithLights, double)
#endif
#undef RAYPOOL_SESSION

}  // namespace raypool::wavefront
