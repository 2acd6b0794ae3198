/// The per-pixel engines: recursion as in the paper, and the same tracer as a loop.
///
/// Threads take balanced items of the image (core/runtime/balanced_items.h), or pixels, lines or tiles under any
/// schedule of OpenMP. A thread owns the whole pixels that it renders, so nothing is shared but the scene; only where
/// there are few pixels for many threads are their samples shared out too. Follows He, Song and Zong, "Parallel Ray
/// Tracing with OpenMP": the paper's basic version is lines with the default schedule, its better ones `static,1` and
/// single pixels.
#pragma once

#include "core/runtime/engine.h"
#include "core/runtime/registry.h"

namespace raypool::recursive {

class RecursiveEngine : public Engine {
  public:
    [[nodiscard]] std::string name() const override { return "recursive"; }
    /// Throws InputError when a thread's stack cannot hold the depth, and says what would.
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<float>&, const RenderSettings&,
                                                       Framebuffer&) const override;
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<double>&, const RenderSettings&,
                                                       Framebuffer&) const override;
};

class IterativeEngine : public Engine {
  public:
    [[nodiscard]] std::string name() const override { return "iterative"; }
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<float>&, const RenderSettings&,
                                                       Framebuffer&) const override;
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<double>&, const RenderSettings&,
                                                       Framebuffer&) const override;
};

/// The two.
void add_engines(EngineRegistry& registry);

}  // namespace raypool::recursive
