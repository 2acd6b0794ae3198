// The fused pool, compiled for RAYPOOL_PART of the sets of features. CMakeLists.txt compiles every part.
#include "bench/studies/feature_engines.h"
#include "wavefront/compiled_stages.h"

namespace raypool::studies {

namespace {

template <Features features>
struct FusedPool {
    static std::unique_ptr<RenderSession> begin(const CompiledScene<float>& scene, const RenderSettings& settings,
                                                Framebuffer& framebuffer) {
        using Real = wavefront::WideReal<float>;
        return wavefront::begin<features, Real, NoTestCount, Splitting::Off>(scene, settings, wavefront::PoolSettings{},
                                                                             framebuffer);
    }
};

}  // namespace

template <>
BeginFunction pool_begin_of_part<RAYPOOL_PART>(std::size_t set) {
    constexpr std::size_t kFirst = RAYPOOL_PART * kPartSets;
    return begin_of_set<FusedPool, kFirst, std::min(kPartSets, kFeatureSets.size() - kFirst)>(set);
}

}  // namespace raypool::studies
