/// Adaptive sampling: more samples for the pixels that need them, until the image is as exact as asked.
///
/// A render goes in passes. Before each, the variance of every pixel is estimated from the framebuffer's sums of two
/// halves of its samples, and the pixels that have too few samples get more. Halves tell less than each sample's square
/// would, one degree of freedom a pixel, but what is asked is about many pixels, and a sample may come in any number of
/// parts (light sampling, splitting). Of all ways to reach an error, samples in proportion to each pixel's standard
/// deviation are the fewest (Neyman, "On the Two Different Aspects of the Representative Method", 1934); samples that
/// bring every pixel to the same error would be no fewer than everywhere the same number.
///
/// Error is the root of the mean over pixels and channels of the squared standard error: the RMSE that is expected
/// against the converged image. All estimates come from exact integers and from arithmetic that every machine rounds
/// alike, so the passes, and the image, are the same for all.
///
/// Two things keep it honest where light is rare. Samples that decide how many a pixel gets must not be its own: one
/// that has found no light would look finished, and the image would darken. So a pixel's deviation is that of the
/// pixels around it, without its own. And a variance that is estimated says nothing of light that no sample has found:
/// the target counts as reached only where the limit of the error (ErrorEstimate::most_rmse) keeps it, which holds for
/// anything up to the greatest sample that the scene allows.
#pragma once

#include <cstdint>
#include <vector>

#include "core/runtime/engine.h"

namespace raypool {

/// What is left of the error, and where.
struct ErrorEstimate {
    std::vector<float> deviation;  ///< of a sample, by pixel, root mean square over channels: of the pixels around it
    double rmse = 0;               ///< of the image as it is, as far as its samples differ
    /// The RMSE is below it with a probability of 99 %, light that no sample has found included.
    double most_rmse = 0;
    double unseen_rmse = 0;           ///< what light that no sample has found adds is below it, likewise
    std::int64_t flat_pixels = 0;     ///< pixels whose halves are equal, so that their variance is not known
    double effective_pixels = 0;      ///< the number of pixels that make the estimate, were they alike
    std::int32_t fewest_samples = 0;  ///< of a pixel
};

/// Each pixel of `framebuffer`, which keeps halves apart, has the given number of samples, at least 2. No sample has
/// more than `greatest_sample` in any channel.
ErrorEstimate estimate_error(const Framebuffer& framebuffer, const std::vector<std::int32_t>& sample_counts,
                             double greatest_sample);

/// Samples [first, end) of some pixels.
struct SamplePass {
    std::int64_t first = 0;
    std::int64_t end = 0;
    std::vector<std::uint32_t> pixels;  ///< in rising order
};

/// What became of a target. Unknown: the estimate keeps it, but light that no sample has found may break it.
enum class TargetStatus : std::uint8_t { Reached, NotReached, Unknown };
/// "reached", "not reached" or "not known".
const char* to_string(TargetStatus status);

/// What an adaptive render is asked for.
struct AdaptiveTarget {
    double error = 0;               ///< RMSE, > 0, in radiance
    double greatest_sample = 0;     ///< no sample has more in any channel
    std::int64_t most_samples = 2;  ///< of a pixel, at least 2
};

/// What an adaptive render did.
struct AdaptiveReport {
    std::vector<std::int32_t> sample_counts;  ///< by pixel
    double rmse = 0;                          ///< ErrorEstimate's, as the next four
    double most_rmse = 0;
    double unseen_rmse = 0;
    std::int64_t flat_pixels = 0;
    TargetStatus status = TargetStatus::Unknown;
    int rounds = 0;  ///< of estimate and render

    [[nodiscard]] double mean_samples() const;
};

/// Decides which pixels get more samples.
class AdaptivePlan {
  public:
    static constexpr std::int64_t kFirstSamples = 16;

    AdaptivePlan(const AdaptiveTarget& target, std::int64_t width, std::int64_t height)
        : AdaptivePlan(target, std::vector<std::int32_t>(static_cast<std::size_t>(width * height)), 0) {}

    /// Goes on from where another plan was: its sample counts and rounds.
    AdaptivePlan(const AdaptiveTarget& target, std::vector<std::int32_t> sample_counts, int rounds)
        : target_(target), counts_(std::move(sample_counts)), rounds_(rounds) {}

    /// What to render next: passes of pixels that have as many samples each. None when all is done. The framebuffer
    /// must hold what was asked for before.
    std::vector<SamplePass> next(const Framebuffer& framebuffer);

    [[nodiscard]] const std::vector<std::int32_t>& sample_counts() const { return counts_; }
    /// Looks at what next() asked for without asking for more. Returns what is left of the error.
    const ErrorEstimate& estimate(const Framebuffer& framebuffer);

    /// As estimated by the last next() or estimate().
    [[nodiscard]] double rmse() const { return estimate_.rmse; }
    [[nodiscard]] TargetStatus status() const;
    [[nodiscard]] AdaptiveReport report() const;
    /// How often next() was asked: estimates, and what followed from them.
    [[nodiscard]] int rounds() const { return rounds_; }

  private:
    /// Whether some number of samples that is allowed would prove that the target is reached, whatever light no sample
    /// has found. It depends on the target, the greatest sample and the size of the image.
    [[nodiscard]] bool can_be_proved() const;
    /// Brings pixels that have fewer samples than wanted to a next stop.
    std::vector<SamplePass> passes(const std::vector<float>& wanted);

    AdaptiveTarget target_;
    std::vector<std::int32_t> counts_;
    int rounds_ = 0;
    ErrorEstimate estimate_;
};

/// Renders into a framebuffer that keeps halves apart until the plan is satisfied. After each round, go_on() says
/// whether to; what it sees, the framebuffer and the plan, is what a render can go on from.
template <class Scalar, class GoOn>
RenderReport render_adaptively(const Engine& engine, const CompiledScene<Scalar>& scene, const RenderSettings& settings,
                               AdaptivePlan& plan, Framebuffer& framebuffer, GoOn go_on) {
    const std::unique_ptr<RenderSession> session = engine.begin(scene, settings, framebuffer);
    for (std::vector<SamplePass> passes = plan.next(framebuffer); !passes.empty(); passes = plan.next(framebuffer)) {
        for (const SamplePass& pass : passes) session->add({pass.first, pass.end, &pass.pixels});
        session->merge();
        if (!go_on()) {
            plan.estimate(framebuffer);
            break;
        }
    }
    return session->finish();
}

/// Until the RMSE is known to be at most target_error, or every pixel has settings.end_sample samples.
template <class Scalar>
RenderReport render_adaptively(const Engine& engine, const CompiledScene<Scalar>& scene, const RenderSettings& settings,
                               double target_error, Framebuffer& framebuffer, AdaptiveReport& adaptive) {
    AdaptivePlan plan({target_error, greatest_sample(scene, settings), settings.end_sample}, scene.width, scene.height);
    RenderReport report = render_adaptively(engine, scene, settings, plan, framebuffer, [] { return true; });
    adaptive = plan.report();
    return report;
}

}  // namespace raypool
