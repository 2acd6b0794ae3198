// Compiled with -fno-optimize-sibling-calls: recursion stays recursion, as the paper's tracer has it.
#include "recursive/engine.h"
#include "recursive/render.h"

namespace raypool::recursive {

RenderReport RecursiveEngine::render(const CompiledScene<float>& scene, const RenderSettings& settings,
                                     Framebuffer& framebuffer) const {
    return recursive::render<Form::Recursive>(scene, settings, framebuffer);
}
RenderReport RecursiveEngine::render(const CompiledScene<double>& scene, const RenderSettings& settings,
                                     Framebuffer& framebuffer) const {
    return recursive::render<Form::Recursive>(scene, settings, framebuffer);
}

}  // namespace raypool::recursive
