#include "core/runtime/adaptive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "core/film/half_variance.h"
#include "core/film/rare_events.h"

namespace raypool {

namespace {

/// Variance of a sample, mean over channels, of a pixel with n samples.
double variance(const Framebuffer& framebuffer, std::size_t pixel, std::int64_t n) {
    const HalfCounts counts = HalfCounts::of(pixel, 0, n);
    const std::array<double, 3> squares = squared_differences(framebuffer, pixel, counts);
    const double scale = framebuffer.fixed_point().scale();
    return (squares[0] + squares[1] + squares[2]) / (scale * scale) /
           (static_cast<double>(n) * static_cast<double>(counts.a) * static_cast<double>(counts.b)) / 3;
}

/// The mean over the pixels around each pixel, as far as they are in the image: its own value is left out, so that its
/// samples do not decide how many it gets. An image of one pixel has no other.
std::vector<double> means_around(const std::vector<double>& values, std::int64_t width, std::int64_t height) {
    constexpr std::int64_t kReach = 2;
    if (values.size() == 1) return values;
    std::vector<double> out(values.size());
    for (std::int64_t y = 0; y < height; ++y) {
        for (std::int64_t x = 0; x < width; ++x) {
            double sum = 0;
            int count = 0;
            for (std::int64_t v = std::max(y - kReach, std::int64_t{0}); v <= std::min(y + kReach, height - 1); ++v) {
                for (std::int64_t u = std::max(x - kReach, std::int64_t{0}); u <= std::min(x + kReach, width - 1);
                     ++u) {
                    if (u == x && v == y) continue;
                    sum += values[static_cast<std::size_t>(v * width + u)];
                    ++count;
                }
            }
            out[static_cast<std::size_t>(y * width + x)] = sum / count;
        }
    }
    return out;
}

/// What a pixel of `pixel_count` adds to the squared error of the image by one sample of `samples` that is as bright as
/// can be: no sample adds more to its estimate.
double greatest_share(double greatest_sample, std::int64_t samples, std::size_t pixel_count) {
    const double share = greatest_sample / static_cast<double>(samples);
    return share * share / static_cast<double>(pixel_count);
}

/// The most that a squared error is which was estimated from terms of which none is above `share`.
double most_expected(double squared_error, double share) {
    return share > 0 ? share * greatest_expectation(squared_error / share) : squared_error;
}

/// How much greater a squared error may be than it was estimated, since halves of a pixel with many terms differ as
/// normal numbers do: the variance of the estimate is up to 2/3 of the sum of the pixels' squared shares in it, which
/// is its square over `effective_pixels`.
double doubt_of_halves(double effective_pixels) {
    return effective_pixels > 0 ? most_expected(1, 2.0 / 3 / effective_pixels) : 1;
}

/// The estimate is believed, where it cannot be proved, once as many pixels make it: about 64 rare events are known to
/// an eighth.
constexpr double kEnoughPixels = 64;
/// Of the squared target at least this much is left to the error that samples tell.
constexpr double kLeastPlanned = 0.5;
/// Every pixel gets this part of the mean number of samples, so that the share of light which it has not found is
/// small.
constexpr double kLeastOfMean = 0.25;

/// Where a pixel with `count` samples may stop next: a quarter more, so that few samples are taken for nothing, and an
/// even number, for equal halves. One that wants more goes on to at most twice what it has before it is looked at
/// again.
std::int64_t next_stop(std::int64_t count) {
    return count == 0 ? AdaptivePlan::kFirstSamples : count + (count + 7) / 8 * 2;
}

}  // namespace

ErrorEstimate estimate_error(const Framebuffer& framebuffer, const std::vector<std::int32_t>& sample_counts,
                             double greatest_sample) {
    ErrorEstimate estimate;
    std::vector<double> variances(sample_counts.size());
    double sum = 0;
    double sum_of_squares = 0;
    for (std::size_t i = 0; i < variances.size(); ++i) {
        variances[i] = variance(framebuffer, i, sample_counts[i]);
        const double squared_error = variances[i] / sample_counts[i];
        sum += squared_error;
        sum_of_squares += squared_error * squared_error;
        if (variances[i] == 0) ++estimate.flat_pixels;
    }
    const auto pixel_count = static_cast<double>(variances.size());
    estimate.fewest_samples = *std::min_element(sample_counts.begin(), sample_counts.end());
    const double share = greatest_share(greatest_sample, estimate.fewest_samples, variances.size());
    estimate.rmse = std::sqrt(sum / pixel_count);
    if (sum_of_squares > 0) estimate.effective_pixels = sum * sum / sum_of_squares;
    estimate.most_rmse =
        std::sqrt(most_expected(doubt_of_halves(estimate.effective_pixels) * sum / pixel_count, share));
    estimate.unseen_rmse = std::sqrt(most_expected(0, share));

    const std::vector<double> around = means_around(variances, framebuffer.width(), framebuffer.height());
    estimate.deviation.resize(around.size());
    std::transform(around.begin(), around.end(), estimate.deviation.begin(),
                   [](double v) { return static_cast<float>(std::sqrt(v)); });
    return estimate;
}

const ErrorEstimate& AdaptivePlan::estimate(const Framebuffer& framebuffer) {
    return estimate_ = estimate_error(framebuffer, counts_, target_.greatest_sample);
}

TargetStatus AdaptivePlan::status() const {
    if (estimate_.fewest_samples == 0) return TargetStatus::Unknown;
    if (estimate_.rmse > target_.error) return TargetStatus::NotReached;
    return estimate_.most_rmse <= target_.error ? TargetStatus::Reached : TargetStatus::Unknown;
}

bool AdaptivePlan::can_be_proved() const {
    const double squared_target = target_.error * target_.error;
    const double share = greatest_share(target_.greatest_sample, target_.most_samples, counts_.size());
    return most_expected(kLeastPlanned * squared_target, share) <= squared_target;
}

std::vector<SamplePass> AdaptivePlan::next(const Framebuffer& framebuffer) {
    if (rounds_++ == 0) return passes(std::vector<float>(counts_.size(), 1));

    estimate(framebuffer);
    if (status() == TargetStatus::Reached) return {};
    const double squared_target = target_.error * target_.error;
    const bool is_kept = estimate_.rmse <= target_.error;
    const std::int64_t twice_the_fewest = 2 * std::int64_t{estimate_.fewest_samples};
    double planned = squared_target;  // of the error that samples tell
    double floor = 0;                 // of the samples of a pixel
    if (can_be_proved()) {
        // Beside what is planned there must be room for light that no sample has found.
        const double share = greatest_share(target_.greatest_sample, estimate_.fewest_samples, counts_.size());
        planned = 2 * squared_target - most_expected(squared_target, share);
        if (planned < kLeastPlanned * squared_target) {
            planned = kLeastPlanned * squared_target;
            floor = static_cast<double>(twice_the_fewest);
        }
        planned /= doubt_of_halves(estimate_.effective_pixels);
    } else if (is_kept) {
        if (estimate_.effective_pixels >= kEnoughPixels) return {};  // more samples would not tell more
        floor = static_cast<double>(twice_the_fewest);
    }

    // By Neyman's rule a pixel should have samples in proportion to its deviation, as many as reach the error. Where
    // the pixels around it have taken them to the wrong ones, all get more.
    const std::vector<float>& deviation = estimate_.deviation;
    const double mean_deviation =
        std::accumulate(deviation.begin(), deviation.end(), 0.0) / static_cast<double>(deviation.size());
    for (double scale = mean_deviation / planned;; scale *= 1.25) {
        const double least = std::max(floor, kLeastOfMean * mean_deviation * scale);
        std::vector<float> wanted(deviation.size());
        bool is_all_done = true;
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            wanted[i] = static_cast<float>(std::max(least, deviation[i] * scale));
            is_all_done = is_all_done && (counts_[i] >= target_.most_samples || wanted[i] == 0);
        }
        std::vector<SamplePass> list = passes(wanted);
        if (!list.empty() || is_all_done) return list;
    }
}

std::vector<SamplePass> AdaptivePlan::passes(const std::vector<float>& wanted) {
    std::map<std::pair<std::int64_t, std::int64_t>, SamplePass> by_range;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        if (counts_[i] >= target_.most_samples || static_cast<float>(counts_[i]) >= wanted[i]) continue;
        const std::int64_t first = counts_[i];
        std::int64_t end = next_stop(first);
        while (static_cast<float>(end) < wanted[i] && next_stop(end) <= 2 * first) end = next_stop(end);
        SamplePass& pass = by_range[{first, end}];
        pass.first = first;
        pass.end = std::min(end, target_.most_samples);
        pass.pixels.push_back(static_cast<std::uint32_t>(i));
        counts_[i] = static_cast<std::int32_t>(pass.end);
    }
    std::vector<SamplePass> list;
    for (auto& [range, pass] : by_range) list.push_back(std::move(pass));
    return list;
}

const char* to_string(TargetStatus status) {
    switch (status) {
        case TargetStatus::Reached:
            return "reached";
        case TargetStatus::NotReached:
            return "not reached";
        case TargetStatus::Unknown:
            return "not known";
    }
    return "";
}

AdaptiveReport AdaptivePlan::report() const {
    return {counts_,  estimate_.rmse, estimate_.most_rmse, estimate_.unseen_rmse, estimate_.flat_pixels,
            status(), rounds_};
}

double AdaptiveReport::mean_samples() const {
    return static_cast<double>(std::accumulate(sample_counts.begin(), sample_counts.end(), std::int64_t{0})) /
           static_cast<double>(sample_counts.size());
}

}  // namespace raypool
