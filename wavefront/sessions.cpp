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

#define RAYPOOL_SESSION(features, scalar)                                                                      \
    template std::unique_ptr<RenderSession> begin_session(const CompiledScene<scalar>&, const RenderSettings&, \
                                                          const PoolSettings&, Framebuffer&,                   \
                                                          const StagesMaker<record_features(features), scalar>&);
RAYPOOL_SESSION(kEverything, float)
#ifndef RAYPOOL_NO_DOUBLE
RAYPOOL_SESSION(kEverything, double)
#endif
#ifndef RAYPOOL_ONE_FEATURE_SET
constexpr Features kStillWithLights{.lights = true};
RAYPOOL_SESSION({}, float)
RAYPOOL_SESSION(kStillWithLights, float)
RAYPOOL_SESSION(kAllButLights, float)
#ifndef RAYPOOL_NO_DOUBLE
RAYPOOL_SESSION(kAllButLights, double)
#endif
#endif
#undef RAYPOOL_SESSION

}  // namespace raypool::wavefront
