// Both engines, compiled for RAYPOOL_PART of the sets of features. CMakeLists.txt compiles every part.
#include "bench/studies/feature_engines.h"

#include <algorithm>

#include "recursive/render.h"
#include "wavefront/compiled_stages.h"

namespace raypool::studies {

namespace {

template <Features features>
std::unique_ptr<RenderSession> iterative(const CompiledScene<float>& scene, const RenderSettings& settings,
                                         Framebuffer& framebuffer) {
    return recursive::begin<recursive::Form::Iterative, features, float, NoTestCount>(scene, settings, framebuffer);
}

template <Features features>
std::unique_ptr<RenderSession> fused_pool(const CompiledScene<float>& scene, const RenderSettings& settings,
                                          Framebuffer& framebuffer) {
    return wavefront::begin<features, wavefront::WideReal<float>, NoTestCount, Splitting::Off>(
        scene, settings, wavefront::PoolSettings{}, framebuffer);
}

}  // namespace

template <>
std::vector<FeatureFunctions> functions_of_part<RAYPOOL_PART>() {
    constexpr std::size_t kFirst = RAYPOOL_PART * kPartSets;
    return []<std::size_t... i>(std::index_sequence<i...>)->std::vector<FeatureFunctions> {
        return {{&iterative<kFeatureSets[kFirst + i].features>, &fused_pool<kFeatureSets[kFirst + i].features>}...};
    }
    (std::make_index_sequence<std::min(kPartSets, kFeatureSets.size() - kFirst)>());
}

}  // namespace raypool::studies
