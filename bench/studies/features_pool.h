/// The fused pool, compiled for a set of features: what features_pool_*.cpp instantiate.
#pragma once

#include "bench/studies/feature_engines.h"
#include "wavefront/compiled_stages.h"

namespace raypool::studies {

template <Features features>
struct FusedPool {
    static std::unique_ptr<RenderSession> begin(const CompiledScene<float>& scene, const RenderSettings& settings,
                                                Framebuffer& framebuffer) {
        using Real = wavefront::WideReal<float>;
        return wavefront::begin<features, Real, NoTestCount, Splitting::Off>(scene, settings, wavefront::PoolSettings{},
                                                                             framebuffer);
    }
};

}  // namespace raypool::studies
