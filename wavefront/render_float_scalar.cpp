#include "wavefront/render.h"
#include "wavefront/render_widths.h"

namespace raypool::wavefront {

std::unique_ptr<RenderSession> begin_scalar(const CompiledScene<float>& scene, const RenderSettings& settings,
                                            const PoolSettings& pool, Framebuffer& framebuffer) {
    return begin<float>(scene, settings, pool, framebuffer);
}

}  // namespace raypool::wavefront
