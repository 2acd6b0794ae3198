#include "wavefront/engine.h"

#include "core/error.h"
#include "wavefront/render_widths.h"

namespace raypool::wavefront {

namespace {

template <class Scalar>
RenderReport render_any(const CompiledScene<Scalar>& scene, const RenderSettings& settings, const PoolSettings& pool,
                        Framebuffer& framebuffer) {
    if (settings.cost_image != nullptr)
        throw InputError(
            "--cost-image: a pool works on many pixels at a time; the engines that know what a pixel costs are "
            "recursive "
            "and iterative");
    if (pool.scope == PoolScope::Shared && needs_owned_pixels(pool.accumulator))
        throw InputError(
            "--accumulator: owned and owned-planar need --pool-scope thread, since no thread owns a pixel of a shared "
            "pool");
    check_settings(settings, framebuffer);
    if (framebuffer.has_squares() && adds_reals(pool.accumulator))
        throw InputError("--accumulator: atomic-float and atomic-double keep no squares, which --target-error needs");
    const std::int64_t paths = path_count(scene, settings);
    if (settings.depth == 0 || paths == 0) {  // no path has a segment
        RenderReport report;
        report.threads.resize(static_cast<std::size_t>(settings.threads));
        report.threads[0].paths = paths;
        if (settings.progress != nullptr) settings.progress->paths += paths;
        return report;
    }
    return pool.width == StageWidth::Simd ? render_simd(scene, settings, pool, framebuffer)
                                          : render_scalar(scene, settings, pool, framebuffer);
}

}  // namespace

RenderReport WavefrontEngine::render(const CompiledScene<float>& scene, const RenderSettings& settings,
                                     Framebuffer& framebuffer) const {
    return render_any(scene, settings, pool_, framebuffer);
}
RenderReport WavefrontEngine::render(const CompiledScene<double>& scene, const RenderSettings& settings,
                                     Framebuffer& framebuffer) const {
    return render_any(scene, settings, pool_, framebuffer);
}

}  // namespace raypool::wavefront
