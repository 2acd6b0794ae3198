#include "bench/studies/openmp_costs.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
#include "core/base/clock.h"
#include "core/runtime/loop.h"

namespace raypool::studies {

namespace {

/// Arithmetic that no compiler can shorten: each step needs the one before.
std::uint64_t compute(std::int64_t steps) {
    std::uint64_t x = 0x9e3779b97f4a7c15U;
    for (std::int64_t i = 0; i < steps; ++i) x = (x ^ (x >> 29U)) * 0xbf58476d1ce4e5b9U + static_cast<std::uint64_t>(i);
    return x;
}

/// Has the compiler believe that the value is needed.
void keep(std::uint64_t value) {
    asm volatile("" : : "r"(value));
}

/// Short batches, so that a thread which is put to sleep spoils one of them.
template <class Function>
double median_of_batches(Function function) {
    constexpr int kBatches = 31;
    std::vector<double> seconds;
    for (int i = 0; i < kBatches; ++i) seconds.push_back(function());
    return median(seconds);
}

/// What a dynamic loop of short chunks takes more than a static one, for each chunk. The counter then comes from
/// another core's cache; in an empty loop one core would keep it.
double chunk_fetch_seconds(int threads) {
    constexpr std::int64_t kChunks = 5'000;
    constexpr std::int64_t kSteps = 1'000;  // a microsecond or two: the counter has gone to another core meanwhile
    const double seconds = median_of_batches([=] {
        double more = 0;
#pragma omp parallel num_threads(threads) reduction(+ : more)
        {
            const double start = processor_seconds();
#pragma omp for schedule(dynamic, 1) nowait
            for (std::int64_t i = 0; i < kChunks; ++i) keep(compute(kSteps));
            const double middle = processor_seconds();
#pragma omp for schedule(static, 1) nowait
            for (std::int64_t i = 0; i < kChunks; ++i) keep(compute(kSteps));
            more = middle - start - (processor_seconds() - middle);
        }
        return more / static_cast<double>(kChunks);
    });
    return std::max(0.0, seconds);
}

double barrier_seconds(int threads) {
    constexpr int kBarriers = 500;
    return median_of_batches([=] {
        double seconds = 0;
#pragma omp parallel num_threads(threads)
        {
#pragma omp barrier
            const double start = wall_seconds();
            for (int i = 0; i < kBarriers; ++i) {
#pragma omp barrier
            }
#pragma omp master
            seconds = wall_seconds() - start;
        }
        return seconds / kBarriers;
    });
}

}  // namespace

double compute_loop_seconds(int threads, double seconds) {
    constexpr double kStepsPerSecond = 5e8;  // roughly, of one core
    const auto steps = static_cast<std::int64_t>(seconds * kStepsPerSecond);
    const double start = wall_seconds();
#pragma omp parallel num_threads(threads)
    keep(compute(steps));
    return wall_seconds() - start;
}

ReplayCosts OpenMpCosts::at(int thread_count) const {
    constexpr double kBarriersOfARound = 3;
    for (std::size_t i = 0; i < threads.size(); ++i)
        if (threads[i] >= thread_count) return {fetch_s[i], kBarriersOfARound * barrier_s[i]};
    const double deeper = std::log2(thread_count) / std::max(1.0, std::log2(threads.back()));
    return {fetch_s.back(), kBarriersOfARound * barrier_s.back() * deeper};
}

OpenMpCosts measure_openmp_costs(int most_threads) {
    OpenMpCosts costs;
    for (const int threads : thread_counts(std::min(core_count(), most_threads))) {
        costs.threads.push_back(threads);
        costs.fetch_s.push_back(chunk_fetch_seconds(threads));
        costs.barrier_s.push_back(barrier_seconds(threads));
    }
    return costs;
}

}  // namespace raypool::studies
