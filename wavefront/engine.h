/// The wavefront engine: rounds over pools of ray records instead of recursion.
///
/// With PoolScope::Shared and Refill::Drain it is the operation pool of He, Song and Zong, "Parallel Ray Tracing with
/// OpenMP"; its default settings are the fastest that were measured (docs/pool.md). Same image as the recursive engine,
/// to the last bit, whatever the settings, unless the accumulator adds floating-point numbers.
#pragma once

#include "core/runtime/engine.h"
#include "core/runtime/registry.h"
#include "wavefront/pool_report.h"
#include "wavefront/settings.h"

namespace raypool::wavefront {

class WavefrontEngine : public Engine {
  public:
    explicit WavefrontEngine(const PoolSettings& pool) : pool_(pool) {}
    [[nodiscard]] std::string name() const override { return "wavefront"; }
    [[nodiscard]] bool loops_over_image() const override { return wavefront::loops_over_image(pool_); }
    /// Throws InputError for an accumulator that needs pixels owned by threads with a shared pool.
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<float>&, const RenderSettings&,
                                                       Framebuffer&) const override;
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<double>&, const RenderSettings&,
                                                       Framebuffer&) const override;

  private:
    PoolSettings pool_;
};

/// Its options are PoolSettings.
void add_engines(EngineRegistry& registry);

}  // namespace raypool::wavefront
