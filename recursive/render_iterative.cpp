#include "recursive/engine.h"
#include "recursive/render.h"

namespace raypool::recursive {

std::unique_ptr<RenderSession> IterativeEngine::begin(const CompiledScene<float>& scene, const RenderSettings& settings,
                                                      Framebuffer& framebuffer) const {
    return recursive::begin<Form::Iterative>(scene, settings, framebuffer);
}
#ifdef RAYPOOL_NO_DOUBLE
std::unique_ptr<RenderSession> IterativeEngine::begin(const CompiledScene<double>&, const RenderSettings&,
                                                      Framebuffer&) const {
    refuse_double();
}
#else
std::unique_ptr<RenderSession> IterativeEngine::begin(const CompiledScene<double>& scene,
                                                      const RenderSettings& settings, Framebuffer& framebuffer) const {
    return recursive::begin<Form::Iterative>(scene, settings, framebuffer);
}
#endif

}  // namespace raypool::recursive
