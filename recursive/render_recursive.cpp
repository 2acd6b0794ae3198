// Compiled with -fno-optimize-sibling-calls: recursion stays recursion, as the paper's tracer has it.
#include "recursive/engine.h"
#include "recursive/render.h"

namespace raypool::recursive {

std::unique_ptr<RenderSession> RecursiveEngine::begin(const CompiledScene<float>& scene, const RenderSettings& settings,
                                                      Framebuffer& framebuffer) const {
    return recursive::begin<Form::Recursive>(scene, settings, framebuffer);
}
#ifdef RAYPOOL_NO_DOUBLE
std::unique_ptr<RenderSession> RecursiveEngine::begin(const CompiledScene<double>&, const RenderSettings&,
                                                      Framebuffer&) const {
    refuse_double();
}
#else
std::unique_ptr<RenderSession> RecursiveEngine::begin(const CompiledScene<double>& scene,
                                                      const RenderSettings& settings, Framebuffer& framebuffer) const {
    return recursive::begin<Form::Recursive>(scene, settings, framebuffer);
}
#endif

}  // namespace raypool::recursive
