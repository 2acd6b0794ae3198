/// Whether a statistic is too far from what chance makes it: the one place where tests take such decisions.
///
/// A family of `test_count` tests is allowed to alarm falsely, all together, with a probability of kFalseAlarm; each
/// single test gets its share by Sidak's correction. Seeds are fixed, so a test that passes once passes always.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace raypool::test {

inline constexpr double kFalseAlarm = 0.01;

/// Whether a p-value, one of a family of `test_count`, is too small for chance.
inline bool is_significant(double p_value, int test_count) {
    return p_value < -std::expm1(std::log1p(-kFalseAlarm) / test_count);
}

/// Probability that a standard normal variable is at least |z| away from 0.
inline double p_value_of_z(double z) {
    return std::erfc(std::abs(z) / std::sqrt(2.0));
}

/// Probability that a chi-square variable is at least `statistic`: the upper incomplete gamma function, regularised, by
/// its series or by Lentz's continued fraction, whichever converges fast.
inline double p_value_of_chi_square(double statistic, double degrees_of_freedom) {
    const double a = degrees_of_freedom / 2;
    const double x = statistic / 2;
    if (x <= 0) return 1;
    const double factor = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a;
        double sum = term;
        for (double n = a + 1; term > sum * 1e-16; ++n) sum += term *= x / n;
        return 1 - factor * sum;
    }
    double b = x + 1 - a;
    double c = std::numeric_limits<double>::max();
    double d = 1 / b;
    double h = d;
    for (int i = 1; i < 100'000; ++i) {
        const double an = -i * (i - a);
        b += 2;
        d = 1 / (an * d + b);
        c = b + an / c;
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return factor * h;
}

/// p-value of counts against equally likely cells; every cell should expect at least five.
inline double p_value_of_uniform_counts(std::span<const std::int64_t> counts) {
    double total = 0;
    for (const std::int64_t count : counts) total += static_cast<double>(count);
    const double expected = total / static_cast<double>(counts.size());
    double statistic = 0;
    for (const std::int64_t count : counts) {
        const double difference = static_cast<double>(count) - expected;
        statistic += difference * difference / expected;
    }
    return p_value_of_chi_square(statistic, static_cast<double>(counts.size()) - 1);
}

/// Counts pairs of numbers in [0, 1] in a grid of equal cells.
class Grid {
  public:
    void add(double u, double v) { ++counts_[cell(u) * kEdge + cell(v)]; }
    [[nodiscard]] double p_value() const { return p_value_of_uniform_counts(counts_); }

  private:
    static constexpr std::size_t kEdge = 24;
    static std::size_t cell(double u) {
        return std::min(static_cast<std::size_t>(u * static_cast<double>(kEdge)), kEdge - 1);
    }
    std::vector<std::int64_t> counts_ = std::vector<std::int64_t>(kEdge * kEdge);
};

/// Pearson's correlation of pairs, and its p-value where the two are independent.
class Correlation {
  public:
    void add(double x, double y) {
        ++count_;
        sum_x_ += x, sum_y_ += y;
        sum_xx_ += x * x, sum_xy_ += x * y, sum_yy_ += y * y;
    }
    [[nodiscard]] double value() const {
        const double n = static_cast<double>(count_);
        const double xy = sum_xy_ - sum_x_ * sum_y_ / n;
        return xy / std::sqrt((sum_xx_ - sum_x_ * sum_x_ / n) * (sum_yy_ - sum_y_ * sum_y_ / n));
    }
    [[nodiscard]] double p_value() const { return p_value_of_z(value() * std::sqrt(static_cast<double>(count_))); }

  private:
    std::int64_t count_ = 0;
    double sum_x_ = 0, sum_y_ = 0, sum_xx_ = 0, sum_xy_ = 0, sum_yy_ = 0;
};

}  // namespace raypool::test
