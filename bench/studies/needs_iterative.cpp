#include "bench/studies/needs_engines.h"
#include "recursive/render.h"

namespace raypool::studies {

namespace {

template <SceneNeeds needs>
struct Iterative {
    static RenderReport run(const CompiledScene<float>& scene, const RenderSettings& settings,
                            Framebuffer& framebuffer) {
        using recursive::Form;
        return recursive::render<Form::Iterative, needs, float, NoWorkCount>(scene, settings, framebuffer);
    }
};

}  // namespace

RenderFunction iterative_render(std::size_t set) {
    return render_of_set<Iterative, 0, kFeatureSets.size()>(set);
}

}  // namespace raypool::studies
