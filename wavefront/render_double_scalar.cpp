#include "wavefront/render.h"
#include "wavefront/render_widths.h"

namespace raypool::wavefront {

RenderReport render_scalar(const CompiledScene<double>& scene, const RenderSettings& settings, const PoolSettings& pool,
                           Framebuffer& framebuffer) {
    return render<double>(scene, settings, pool, framebuffer);
}

}  // namespace raypool::wavefront
