#include "wavefront/render.h"
#include "wavefront/render_widths.h"

namespace raypool::wavefront {

RenderReport render_simd(const CompiledScene<double>& scene, const RenderSettings& settings, const PoolSettings& pool,
                         Framebuffer& framebuffer) {
    return render<Wide<double, stdx::native_simd<double>::size()>>(scene, settings, pool, framebuffer);
}

}  // namespace raypool::wavefront
