#include "wavefront/render.h"
#include "wavefront/render_widths.h"

namespace raypool::wavefront {

RenderReport render_simd(const CompiledScene<float>& scene, const RenderSettings& settings, const PoolSettings& pool,
                         Framebuffer& framebuffer) {
    return render<Wide<float, stdx::native_simd<float>::size()>>(scene, settings, pool, framebuffer);
}

}  // namespace raypool::wavefront
