#include "core/adaptive.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace raypool {

namespace {

/// Variance of a sample, mean over channels: (sum of squares / n - mean^2) n / (n - 1).
double variance(const Framebuffer& framebuffer, std::size_t pixel, double n) {
    const double scale = 1 / (framebuffer.fixed_point().scale() * n);
    double squared_means = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double mean = static_cast<double>(framebuffer.sums()[3 * pixel + k]) * scale;
        squared_means += mean * mean;
    }
    const double square =
        static_cast<double>(framebuffer.squares()[pixel]) / (framebuffer.fixed_point().square_scale() * n);
    return std::max(0.0, square - squared_means) * n / (n - 1) / 3;
}

/// The mean over each pixel and those around it, as far as they are in the image.
std::vector<double> smoothed(const std::vector<double>& values, std::int64_t width, std::int64_t height) {
    std::vector<double> out(values.size());
    for (std::int64_t y = 0; y < height; ++y) {
        for (std::int64_t x = 0; x < width; ++x) {
            double sum = 0;
            int count = 0;
            for (std::int64_t v = std::max<std::int64_t>(y - 1, 0); v <= std::min(y + 1, height - 1); ++v) {
                for (std::int64_t u = std::max<std::int64_t>(x - 1, 0); u <= std::min(x + 1, width - 1); ++u) {
                    sum += values[static_cast<std::size_t>(v * width + u)];
                    ++count;
                }
            }
            out[static_cast<std::size_t>(y * width + x)] = sum / count;
        }
    }
    return out;
}

/// Where a pixel with `count` samples may stop next: a quarter more, so that few samples are taken for nothing. One that
/// wants more goes on to at most twice what it has before it is looked at again.
std::int64_t next_stop(std::int64_t count) {
    return count == 0 ? AdaptivePlan::kFirstSamples : count + (count + 3) / 4;
}

}  // namespace

ErrorEstimate estimate_error(const Framebuffer& framebuffer, const std::vector<std::int32_t>& sample_counts) {
    std::vector<double> variances(sample_counts.size());
    double squared_error = 0;
    for (std::size_t i = 0; i < variances.size(); ++i) {
        variances[i] = variance(framebuffer, i, sample_counts[i]);
        squared_error += variances[i] / sample_counts[i];
    }
    ErrorEstimate estimate;
    estimate.rmse = std::sqrt(squared_error / static_cast<double>(variances.size()));
    const std::vector<double> local = smoothed(variances, framebuffer.width(), framebuffer.height());
    estimate.deviation.resize(local.size());
    std::transform(local.begin(), local.end(), estimate.deviation.begin(),
                   [](double v) { return static_cast<float>(std::sqrt(v)); });
    return estimate;
}

AdaptivePlan::AdaptivePlan(double target_error, std::int64_t most_samples, std::int64_t width, std::int64_t height)
    : target_error_(target_error), most_samples_(most_samples), counts_(static_cast<std::size_t>(width * height)) {}

ErrorEstimate AdaptivePlan::estimate(const Framebuffer& framebuffer) {
    ErrorEstimate estimate = estimate_error(framebuffer, counts_);
    rmse_ = estimate.rmse;
    return estimate;
}

std::vector<SamplePass> AdaptivePlan::next(const Framebuffer& framebuffer) {
    if (rounds_++ == 0) return passes(std::vector<float>(counts_.size(), 1));

    const ErrorEstimate estimate = this->estimate(framebuffer);
    if (rmse_ <= target_error_) return {};

    // By Neyman's rule a pixel should have samples in proportion to its deviation, as many as reach the error. Where
    // smoothing has taken them to the wrong pixels, all get more.
    const std::vector<float>& deviation = estimate.deviation;
    double scale = std::accumulate(deviation.begin(), deviation.end(), 0.0) /
                   (static_cast<double>(deviation.size()) * target_error_ * target_error_);
    for (;; scale *= 1.25) {
        std::vector<float> wanted(deviation.size());
        bool is_all_done = true;
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            wanted[i] = static_cast<float>(deviation[i] * scale);
            is_all_done = is_all_done && (counts_[i] >= most_samples_ || wanted[i] == 0);
        }
        std::vector<SamplePass> list = passes(wanted);
        if (!list.empty() || is_all_done) return list;
    }
}

std::vector<SamplePass> AdaptivePlan::passes(const std::vector<float>& wanted) {
    std::map<std::pair<std::int64_t, std::int64_t>, SamplePass> by_range;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        if (counts_[i] >= most_samples_ || static_cast<float>(counts_[i]) >= wanted[i]) continue;
        const std::int64_t first = counts_[i];
        std::int64_t end = next_stop(first);
        while (static_cast<float>(end) < wanted[i] && next_stop(end) <= 2 * first) end = next_stop(end);
        SamplePass& pass = by_range[{first, end}];
        pass.first = first;
        pass.end = std::min(end, most_samples_);
        pass.pixels.push_back(static_cast<std::uint32_t>(i));
        counts_[i] = static_cast<std::int32_t>(pass.end);
    }
    std::vector<SamplePass> list;
    for (auto& [range, pass] : by_range) list.push_back(std::move(pass));
    return list;
}

double AdaptiveReport::mean_samples() const {
    return static_cast<double>(std::accumulate(sample_counts.begin(), sample_counts.end(), std::int64_t{0})) /
           static_cast<double>(sample_counts.size());
}

}  // namespace raypool
