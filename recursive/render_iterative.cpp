#include "recursive/engine.h"
#include "recursive/render.h"

namespace raypool::recursive {

RenderReport IterativeEngine::render(const CompiledScene<float>& scene, const RenderSettings& settings,
                                     Framebuffer& framebuffer) const {
    return recursive::render<Form::Iterative>(scene, settings, framebuffer);
}
RenderReport IterativeEngine::render(const CompiledScene<double>& scene, const RenderSettings& settings,
                                     Framebuffer& framebuffer) const {
    return recursive::render<Form::Iterative>(scene, settings, framebuffer);
}

}  // namespace raypool::recursive
