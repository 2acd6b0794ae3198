/// Welch's test: whether two sets of independent values have the same mean, their variances unknown and unequal.
///
/// Called by tests/reference/; whether a p-value is too small is for tests/significance.h to say.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace raypool::test {

/// Probability that a variable of Student's distribution is at least |t| away from 0: the integral of its density over
/// the angle whose tangent is t / sqrt(degrees of freedom), by Simpson's rule from |t| to infinity.
inline double p_value_of_t(double t, double degrees_of_freedom) {
    const double n = degrees_of_freedom;
    const double from = std::atan(std::abs(t) / std::sqrt(n));
    const auto density = [n](double angle) { return std::pow(std::cos(angle), n - 1); };
    constexpr int kSteps = 2000;
    const double step = (std::numbers::pi / 2 - from) / kSteps;
    double sum = density(from) + density(std::numbers::pi / 2);
    for (int i = 1; i < kSteps; ++i) sum += (i % 2 == 1 ? 4 : 2) * density(from + i * step);
    const double factor = std::exp(std::lgamma((n + 1) / 2) - std::lgamma(n / 2)) / std::sqrt(std::numbers::pi);
    return std::min(1.0, 2 * factor * sum * step / 3);
}

/// Mean and the variance of the mean.
struct MeanEstimate {
    double mean;
    double variance;
    double count;

    explicit MeanEstimate(std::span<const double> values)
        : mean(0), variance(0), count(static_cast<double>(values.size())) {
        for (const double value : values) mean += value / count;
        for (const double value : values) variance += (value - mean) * (value - mean) / (count - 1) / count;
    }
};

/// Two-sided. `rounding` is the standard error that arithmetic adds to either mean, so that constant values compare.
inline double p_value_of_welch(const MeanEstimate& a, const MeanEstimate& b, double rounding) {
    const double va = a.variance + rounding * rounding;
    const double vb = b.variance + rounding * rounding;
    if (va + vb == 0) return a.mean == b.mean ? 1 : 0;
    const double degrees_of_freedom = (va + vb) * (va + vb) / (va * va / (a.count - 1) + vb * vb / (b.count - 1));
    return p_value_of_t((a.mean - b.mean) / std::sqrt(va + vb), degrees_of_freedom);
}

}  // namespace raypool::test
