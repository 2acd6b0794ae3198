#include "wavefront/render.h"
#include "wavefront/render_widths.h"

namespace raypool::wavefront {

RenderReport render_scalar(const CompiledScene<float>& scene, const RenderSettings& settings, const PoolSettings& pool,
                           Framebuffer& framebuffer) {
    return render<float>(scene, settings, pool, framebuffer);
}

}  // namespace raypool::wavefront
