#include "bench/studies/feature_engines.h"
#include "recursive/render.h"

namespace raypool::studies {

namespace {

template <Features features>
struct Iterative {
    static std::unique_ptr<RenderSession> begin(const CompiledScene<float>& scene, const RenderSettings& settings,
                                                Framebuffer& framebuffer) {
        using recursive::Form;
        return recursive::begin<Form::Iterative, features, float, NoTestCount>(scene, settings, framebuffer);
    }
};

}  // namespace

BeginFunction iterative_begin(std::size_t set) {
    return begin_of_set<Iterative, 0, kFeatureSets.size()>(set);
}

}  // namespace raypool::studies
