/// An engine that is many: every rank renders what it takes of the work, with an engine of its own.
///
/// The render command calls it in place of its engine where there are several ranks, at the same time and with the same
/// settings on each of them. Reports are of what this rank did, but `seconds` is what rank 0 waited, on all ranks: so
/// a decision by it is the same everywhere.
///
/// Sums stay where they were made until gather(), so a render costs one reduction, however many pieces it has: before,
/// only the sum over ranks of their framebuffers means anything. An adaptive render must know all sums to decide what
/// is next; a framebuffer with second moments is therefore whole on every rank after each merge().
#pragma once

#include <memory>

#include "cluster/ranks.h"
#include "core/runtime/engine.h"

namespace raypool::cluster {

class RankEngine : public Engine {
  public:
    /// `ranks` outlives it. RAYPOOL_SLOW_RANK=R:F in the environment makes rank R spin after each unit, so that it is
    /// F times as slow: for experiments on balance (docs/scaling.md). InputError where that makes no sense.
    RankEngine(std::unique_ptr<Engine> engine, Ranks& ranks);

    [[nodiscard]] std::string name() const override { return engine_->name(); }
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<float>& scene,
                                                       const RenderSettings& settings,
                                                       Framebuffer& framebuffer) const override;
    [[nodiscard]] std::unique_ptr<RenderSession> begin(const CompiledScene<double>& scene,
                                                       const RenderSettings& settings,
                                                       Framebuffer& framebuffer) const override;

  private:
    std::unique_ptr<Engine> engine_;
    Ranks& ranks_;
    double slowness_ = 1;
};

}  // namespace raypool::cluster
