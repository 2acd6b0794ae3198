#include "bench/studies/replay_model.h"

#include <algorithm>
#include <numeric>

#include "bench/studies/replay_clocks.h"

namespace raypool::studies {

namespace {

Replayed replay_from(std::span<const double> items, const ReplaySchedule& schedule, int threads,
                     const ReplayCosts& costs, int first, std::span<const double> speeds = {}) {
    return replay_items(
        order_of(items, schedule), schedule, threads, costs, speeds, first,
        [&](int, std::size_t item) { return items[item]; }, [](int) { return 0.0; });
}

}  // namespace

double Replayed::total() const {
    return std::accumulate(work.begin(), work.end(), 0.0);
}

double Replayed::efficiency() const {
    return makespan == 0 ? 1 : total() / (makespan * static_cast<double>(work.size()));
}

Replayed replay(std::span<const double> items, const ReplaySchedule& schedule, int threads, const ReplayCosts& costs,
                std::span<const double> speeds) {
    return replay_from(items, schedule, threads, costs, 0, speeds);
}

double makespan_bound(std::span<const double> items, int threads) {
    const double total = std::accumulate(items.begin(), items.end(), 0.0);
    const double dearest = items.empty() ? 0 : *std::max_element(items.begin(), items.end());
    return std::max(total / threads, dearest);
}

std::vector<std::vector<double>> drained_rounds(const SegmentCosts& segments, std::size_t capacity, std::size_t batch,
                                                Packing packing) {
    std::vector<std::vector<double>> rounds;
    std::vector<std::size_t> alive;
    for (std::size_t filled = 0; filled < segments.path_count(); filled += capacity) {
        alive.resize(std::min(capacity, segments.path_count() - filled));
        std::iota(alive.begin(), alive.end(), filled);
        const std::size_t size = alive.size();
        rounds.emplace_back((size + batch - 1) / batch);
        for (std::uint32_t depth = 0; !alive.empty(); ++depth) {
            const std::size_t places = packing == Packing::InPlace ? size : alive.size();
            std::vector<double> batches((places + batch - 1) / batch);
            std::size_t survivors = 0;
            for (std::size_t i = 0; i < alive.size(); ++i) {
                const std::uint32_t segment = segments.first[alive[i]] + depth;
                batches[(packing == Packing::InPlace ? alive[i] - filled : i) / batch] += segments.cost[segment];
                if (segment + 1 < segments.first[alive[i] + 1]) alive[survivors++] = alive[i];
            }
            alive.resize(survivors);
            rounds.push_back(std::move(batches));
        }
    }
    return rounds;
}

Replayed replay_rounds(std::span<const std::vector<double>> rounds, const ReplaySchedule& schedule, int threads,
                       const ReplayCosts& costs) {
    Replayed result{std::vector<double>(static_cast<std::size_t>(threads)), {}, 0};
    int first = 0;
    for (const std::vector<double>& round : rounds) {
        const Replayed one = replay_from(round, schedule, threads, costs, first++ % threads);
        for (std::size_t i = 0; i < one.work.size(); ++i) result.work[i] += one.work[i];
        result.makespan += one.makespan + costs.barrier;
    }
    return result;
}

double makespan_bound(std::span<const std::vector<double>> rounds, int threads) {
    double bound = 0;
    for (const std::vector<double>& round : rounds) bound += makespan_bound(round, threads);
    return bound;
}

}  // namespace raypool::studies
