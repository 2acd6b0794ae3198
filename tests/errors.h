/// Errors of a method against an oracle: their greatest and their quantiles. A not-a-number counts as infinite.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace raypool::test {

class Errors {
  public:
    template <class Number>
    void add(Number error) {
        const double e = std::abs(static_cast<double>(error));
        errors_.push_back(std::isnan(e) ? std::numeric_limits<double>::infinity() : e);
    }
    [[nodiscard]] std::size_t count() const { return errors_.size(); }
    [[nodiscard]] double max() const { return quantile(1); }
    /// The error that a part `p` of all errors does not exceed.
    [[nodiscard]] double quantile(double p) const {
        std::vector<double> sorted = errors_;
        const auto rank = static_cast<std::ptrdiff_t>(p * static_cast<double>(sorted.size() - 1));
        std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
        return sorted[static_cast<std::size_t>(rank)];
    }

  private:
    std::vector<double> errors_;
};

}  // namespace raypool::test
