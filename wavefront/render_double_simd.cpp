#include "wavefront/render.h"
#include "wavefront/render_widths.h"

namespace raypool::wavefront {

std::unique_ptr<RenderSession> begin_simd(const CompiledScene<double>& scene, const RenderSettings& settings,
                                          const PoolSettings& pool, Framebuffer& framebuffer) {
    return begin<Wide<double, stdx::native_simd<double>::size()>>(scene, settings, pool, framebuffer);
}

}  // namespace raypool::wavefront
