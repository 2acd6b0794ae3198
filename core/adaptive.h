/// Adaptive sampling: more samples for the pixels that need them, until the image is as exact as asked.
///
/// A render goes in passes. Before each, the variance of every pixel is estimated from the framebuffer's sums and sums
/// of squares, and the pixels that have too few samples get more. Of all ways to reach an error, samples in proportion
/// to each pixel's standard deviation are the fewest (Neyman, "On the Two Different Aspects of the Representative
/// Method", 1934); samples that bring every pixel to the same error would be no fewer than everywhere the same number.
///
/// Error is the root of the mean over pixels and channels of the squared standard error: the RMSE that is expected
/// against the converged image. All estimates come from exact integers that no engine, thread or pool size changes, so
/// the passes, and the image, are the same for all. To stop by what was seen is biased: a pixel whose light no sample
/// has found yet looks finished. Estimates are therefore means over a pixel and its neighbours, and no pixel has fewer
/// than kFirstSamples; `raypool study adaptive` measures what bias is left.
#pragma once

#include <cstdint>
#include <vector>

#include "core/engine.h"

namespace raypool {

/// What is left of the error, and where: from second moments.
struct ErrorEstimate {
    std::vector<float> deviation;  ///< of a sample of each pixel, root mean square over channels; smoothed, 3 x 3
    double rmse = 0;               ///< of the image as it is
};

/// Each pixel of `framebuffer`, which keeps second moments, has the given number of samples, at least 2.
ErrorEstimate estimate_error(const Framebuffer& framebuffer, const std::vector<std::int32_t>& sample_counts);

/// Samples [first, end) of some pixels.
struct SamplePass {
    std::int64_t first = 0;
    std::int64_t end = 0;
    std::vector<std::uint32_t> pixels;  ///< in rising order
};

/// Decides which pixels get more samples.
class AdaptivePlan {
  public:
    static constexpr std::int64_t kFirstSamples = 16;

    /// For an RMSE of at most `target_error` (> 0, radiance), with at most `most_samples` (>= 2) a pixel.
    AdaptivePlan(double target_error, std::int64_t most_samples, std::int64_t width, std::int64_t height);

    /// Goes on from where another plan was: its sample counts and rounds.
    AdaptivePlan(double target_error, std::int64_t most_samples, std::vector<std::int32_t> sample_counts, int rounds)
        : target_error_(target_error),
          most_samples_(most_samples),
          counts_(std::move(sample_counts)),
          rounds_(rounds) {}

    /// What to render next: passes of pixels that have as many samples each. None when all is done. The framebuffer
    /// must hold what was asked for before.
    std::vector<SamplePass> next(const Framebuffer& framebuffer);

    [[nodiscard]] const std::vector<std::int32_t>& sample_counts() const { return counts_; }
    /// Looks at what next() asked for without asking for more. Returns what is left of the error.
    ErrorEstimate estimate(const Framebuffer& framebuffer);

    /// As estimated by the last next() or estimate().
    [[nodiscard]] double rmse() const { return rmse_; }
    /// How often next() was asked: estimates, and what followed from them.
    [[nodiscard]] int rounds() const { return rounds_; }

  private:
    /// Brings pixels that have fewer samples than wanted to a next stop.
    std::vector<SamplePass> passes(const std::vector<float>& wanted);

    double target_error_;
    std::int64_t most_samples_;
    std::vector<std::int32_t> counts_;
    double rmse_ = 0;
    int rounds_ = 0;
};

/// What an adaptive render did.
struct AdaptiveReport {
    std::vector<std::int32_t> sample_counts;  ///< by pixel
    double rmse = 0;                          ///< estimated, of the image
    int rounds = 0;                           ///< of estimate and render

    [[nodiscard]] double mean_samples() const;
};

/// Renders into a framebuffer that keeps second moments until the plan is satisfied. After each round, go_on() says
/// whether to; what it sees, the framebuffer and the plan, is what a render can go on from.
template <class Scalar, class GoOn>
RenderReport render_adaptively(const Engine& engine, const CompiledScene<Scalar>& scene, RenderSettings settings,
                               AdaptivePlan& plan, Framebuffer& framebuffer, GoOn go_on) {
    RenderReport report;
    for (std::vector<SamplePass> passes = plan.next(framebuffer); !passes.empty(); passes = plan.next(framebuffer)) {
        for (const SamplePass& pass : passes) {
            settings.first_sample = pass.first;
            settings.end_sample = pass.end;
            settings.pixels = &pass.pixels;
            report.add(engine.render(scene, settings, framebuffer));
        }
        if (!go_on()) {
            plan.estimate(framebuffer);
            break;
        }
    }
    return report;
}

/// Until the estimated RMSE is target_error, or every pixel has settings.end_sample samples.
template <class Scalar>
RenderReport render_adaptively(const Engine& engine, const CompiledScene<Scalar>& scene, const RenderSettings& settings,
                               double target_error, Framebuffer& framebuffer, AdaptiveReport& adaptive) {
    AdaptivePlan plan(target_error, settings.end_sample, scene.width, scene.height);
    RenderReport report = render_adaptively(engine, scene, settings, plan, framebuffer, [] { return true; });
    adaptive = {plan.sample_counts(), plan.rmse(), plan.rounds()};
    return report;
}

}  // namespace raypool
