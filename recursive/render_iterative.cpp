#include "recursive/engine.h"
#include "recursive/render.h"

namespace raypool::recursive {

std::unique_ptr<RenderSession> IterativeEngine::begin(const CompiledScene<float>& scene, const RenderSettings& settings,
                                                      Framebuffer& framebuffer) const {
    return recursive::begin<Form::Iterative>(scene, settings, framebuffer);
}
std::unique_ptr<RenderSession> IterativeEngine::begin(const CompiledScene<double>& scene,
                                                      const RenderSettings& settings, Framebuffer& framebuffer) const {
    return recursive::begin<Form::Iterative>(scene, settings, framebuffer);
}

}  // namespace raypool::recursive
