/// The few statistics that a run takes of its own clocks. Medians, since a shared machine makes outliers, never means.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/runtime/engine.h"

namespace raypool::studies {

/// Of at least one value.
struct Spread {
    double median, low, high;
};

inline Spread spread(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back()};
}

inline double median(std::vector<double> values) {
    return spread(std::move(values)).median;
}

/// Largest over mean: 1 is perfect balance, the number of threads is one thread doing it all.
inline double max_over_mean(const std::vector<double>& load) {
    const double sum = std::accumulate(load.begin(), load.end(), 0.0);
    return sum == 0 ? 1 : *std::max_element(load.begin(), load.end()) * static_cast<double>(load.size()) / sum;
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

/// Nanoseconds of a thread for a segment.
inline double ns_per_segment(const RenderReport& report, int threads) {
    return 1e9 * report.seconds * threads / static_cast<double>(report.segments());
}

}  // namespace raypool::studies
