#include "wavefront/engine.h"

#include <new>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/memory.h"
#include "wavefront/render.h"

namespace raypool::wavefront {

namespace {

/// Of depth 0: no path has a segment.
template <class Scalar>
class DarkSession : public RenderSession {
  public:
    DarkSession(const CompiledScene<Scalar>& scene, Progress* progress) : scene_(scene), progress_(progress) {}

  private:
    RenderReport render(const RenderUnit& unit) override {
        RenderReport report;
        report.threads.resize(1);
        report.threads[0].paths = path_count(scene_, unit);
        if (progress_ != nullptr) progress_->paths += report.threads[0].paths;
        return report;
    }
    const CompiledScene<Scalar>& scene_;
    Progress* progress_;
};

template <class Scalar>
std::unique_ptr<RenderSession> begin_any(const CompiledScene<Scalar>& scene, const RenderSettings& settings,
                                         const PoolSettings& pool, Framebuffer& framebuffer) {
    if (settings.cost_image != nullptr)
        throw InputError(
            "--cost-image: a pool works on many pixels at a time; the engines that know what a pixel costs are "
            "recursive "
            "and iterative");
    if (pool.scope == PoolScope::Shared && needs_owned_pixels(pool.accumulator))
        throw InputError(
            "--accumulator: owned and owned-planar need --pool-scope thread, since no thread owns a pixel of a shared "
            "pool");
    if (framebuffer.has_halves() && adds_reals(pool.accumulator))
        throw InputError(
            "--accumulator: sums of atomic-float and atomic-double depend on their order, and so would what "
            "--target-error and --aovs ask for");
    if (settings.depth == 0) return std::make_unique<DarkSession<Scalar>>(scene, settings.progress);
    try {
        return pool.width == StageWidth::Simd ? begin<WideReal<Scalar>>(scene, settings, pool, framebuffer)
                                              : begin<Scalar>(scene, settings, pool, framebuffer);
    } catch (const std::bad_alloc&) {
        throw InputError(
            fmt::format("--pool-rays, --threads, --accumulator: no memory for the pools, the stages and the "
                        "accumulator; {} are available",
                        bytes_text(available_memory())));
    }
}

}  // namespace

std::unique_ptr<RenderSession> WavefrontEngine::begin(const CompiledScene<float>& scene, const RenderSettings& settings,
                                                      Framebuffer& framebuffer) const {
    return begin_any(scene, settings, pool_, framebuffer);
}
#ifdef RAYPOOL_NO_DOUBLE
std::unique_ptr<RenderSession> WavefrontEngine::begin(const CompiledScene<double>&, const RenderSettings&,
                                                      Framebuffer&) const {
    refuse_double();
}
#else
std::unique_ptr<RenderSession> WavefrontEngine::begin(const CompiledScene<double>& scene,
                                                      const RenderSettings& settings, Framebuffer& framebuffer) const {
    return begin_any(scene, settings, pool_, framebuffer);
}
#endif

void add_engines(EngineRegistry& registry) {
    registry.add({.name = "wavefront",
                  .description = "rounds over pools of ray records",
                  .keeps_costs = false,
                  .has_pool = true,
                  .make = [](const std::any& options) {
                      const auto* pool = std::any_cast<PoolSettings>(&options);
                      return std::make_unique<WavefrontEngine>(pool == nullptr ? PoolSettings{} : *pool);
                  }});
}

}  // namespace raypool::wavefront
