#include "bench/studies/replay_ways.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include "core/runtime/balanced_items.h"

namespace raypool::studies {

namespace {

using Kind = ReplayWay::Kind;
using Speeds = std::span<const double>;

/// Of all paths, pixel by pixel, for so many threads.
PoolItems balanced_items(std::int64_t pixels, std::int64_t samples, std::size_t capacity, int threads) {
    const BalancedItems balanced(pixels, samples, threads);
    PoolItems items{{0}, {}};
    for (std::int64_t i = 0; i < balanced.count(); ++i) {
        items.first_path.push_back(static_cast<std::uint32_t>(balanced.range(i).end));
        items.most_held.push_back(std::min(capacity, static_cast<std::size_t>(balanced.most_held(i))));
    }
    return items;
}

}  // namespace

PreparedWay prepare(const ReplayWay& way, const PathCosts& costs, const CostModel& model) {
    const ReplaySchedule schedule = way.schedule;
    const std::size_t capacity = way.capacity != 0 ? way.capacity : costs.first.size();
    if (way.kind == Kind::Loop || way.kind == Kind::ThreadPools) {
        const auto order = std::make_shared<const ItemOrder>(in_order(costs, way.grain, model, capacity));
        const auto items = [=, pixels = costs.width * costs.height, samples = costs.samples](int threads) {
            return schedule.kind == ReplaySchedule::Kind::Balanced ? balanced_items(pixels, samples, capacity, threads)
                                                                   : order->items;
        };
        const auto item_seconds = [=](int threads) { return item_costs(order->segments(), items(threads)); };
        const bool has_pools = way.kind == Kind::ThreadPools;
        return {[=](int threads, const ReplayCosts& extra, Speeds speeds) {
                    if (!has_pools) return replay(item_seconds(threads), schedule, threads, extra, speeds);
                    return replay_thread_pools(order->segments(), items(threads), schedule, threads, extra, speeds);
                },
                [=](int threads) { return makespan_bound(item_seconds(threads), threads); }};
    }
    const auto segments = std::make_shared<const std::vector<float>>(costs.segment_costs(model));
    if (way.kind == Kind::Drained) {
        const auto rounds = std::make_shared<const std::vector<std::vector<double>>>(drained_rounds(
            {costs.first, *segments}, capacity, way.batch, way.batch == 1 ? Packing::Dense : Packing::InPlace));
        return {[=](int threads, const ReplayCosts& extra, Speeds) {
                    return replay_rounds(*rounds, schedule, threads, extra);
                },
                [=](int threads) { return makespan_bound(*rounds, threads); }};
    }
    const double total = std::accumulate(segments->begin(), segments->end(), 0.0);
    return {[=, &costs](int threads, const ReplayCosts& extra, Speeds) {
                const std::int64_t records = wavefront::shared_capacity(threads);
                const std::int64_t batch = wavefront::shared_batch(records, threads);
                return replay_shared_pool({costs.first, *segments}, static_cast<std::size_t>(records),
                                          static_cast<std::size_t>(batch), threads, extra);
            },
            [=](int threads) { return total / threads; }};
}

}  // namespace raypool::studies
