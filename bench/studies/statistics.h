/// The few statistics that every table here uses. Medians, since a shared machine makes outliers, never means.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/runtime/engine.h"

namespace raypool::studies {

/// Of at least one value.
struct Spread {
    double median, low, high;
    std::size_t runs = 1;
};

inline Spread spread(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back(), n};
}

inline double median(std::vector<double> values) {
    return spread(std::move(values)).median;
}

/// "1.52 (1.40 to 1.61)"
inline std::string to_text(const Spread& s, int digits = 2) {
    return fmt::format("{:.{}f} ({:.{}f} to {:.{}f})", s.median, digits, s.low, digits, s.high, digits);
}

/// Element by element: of measurements that were taken side by side.
inline std::vector<double> ratios(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> quotients;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) quotients.push_back(a[i] / b[i]);
    return quotients;
}

/// Largest over mean: 1 is perfect balance, the number of threads is one thread doing it all.
inline double max_over_mean(const std::vector<double>& load) {
    const double sum = std::accumulate(load.begin(), load.end(), 0.0);
    return sum == 0 ? 1 : *std::max_element(load.begin(), load.end()) * static_cast<double>(load.size()) / sum;
}

/// Standard deviation over mean.
inline double coefficient_of_variation(const std::vector<double>& load) {
    const double mean = std::accumulate(load.begin(), load.end(), 0.0) / static_cast<double>(load.size());
    double squares = 0;
    for (const double value : load) squares += (value - mean) * (value - mean);
    return mean == 0 ? 0 : std::sqrt(squares / static_cast<double>(load.size())) / mean;
}

/// A figure of each thread, as numbers.
template <class T>
std::vector<double> by_thread(const RenderReport& report, T ThreadReport::*figure) {
    std::vector<double> values;
    for (const ThreadReport& thread : report.threads) values.push_back(static_cast<double>(thread.*figure));
    return values;
}

/// Part of the threads' time that was spent waiting for other threads.
inline double waiting(const RenderReport& report) {
    const std::vector<double> waits = by_thread(report, &ThreadReport::wait_s);
    return std::accumulate(waits.begin(), waits.end(), 0.0) /
           (report.seconds * static_cast<double>(report.threads.size()));
}

}  // namespace raypool::studies
