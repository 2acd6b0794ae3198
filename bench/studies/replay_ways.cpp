#include "bench/studies/replay_ways.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include "core/runtime/balanced_items.h"
#include "wavefront/settings.h"

namespace raypool::studies {

namespace {

std::vector<double> item_costs(const PathCosts& costs, const Grain& grain, const CostModel& model) {
    std::vector<double> items;
    for (const Tally& tally : costs.items(grain)) items.push_back(model.seconds(tally));
    return items;
}

/// The segments of all paths, pixel by pixel, and the items that they are cut into for so many threads.
struct BalancedWork {
    const PathCosts* costs;
    std::vector<float> segments;

    [[nodiscard]] PoolItems items(int threads, std::size_t capacity) const {
        const BalancedItems balanced(costs->width * costs->height, costs->samples, threads);
        PoolItems items{{0}, {}};
        for (std::int64_t i = 0; i < balanced.count(); ++i) {
            items.first_path.push_back(static_cast<std::uint32_t>(balanced.range(i).end));
            items.most_held.push_back(std::min(capacity, static_cast<std::size_t>(balanced.most_held(i))));
        }
        return items;
    }
    [[nodiscard]] std::vector<double> seconds(int threads) const {
        const std::vector<std::uint32_t> first_path = items(threads, 1).first_path;
        std::vector<double> seconds(first_path.size() - 1);
        for (std::size_t i = 0; i < seconds.size(); ++i)
            seconds[i] = std::accumulate(segments.begin() + costs->first[first_path[i]],
                                         segments.begin() + costs->first[first_path[i + 1]], 0.0);
        return seconds;
    }
};

using Speeds = std::span<const double>;

PreparedWay prepare_balanced(const ReplayWay& way, const PathCosts& costs, const CostModel& model) {
    const auto work = std::make_shared<const BalancedWork>(BalancedWork{&costs, costs.segment_costs(model)});
    const auto bound = [=](int threads) { return makespan_bound(work->seconds(threads), threads); };
    const ReplaySchedule schedule = way.schedule;
    if (way.kind == ReplayWay::Kind::Loop)
        return {[=](int threads, const ReplayCosts& extra, Speeds speeds) {
                    return replay(work->seconds(threads), schedule, threads, extra, speeds);
                },
                bound};
    const std::size_t capacity = way.capacity;
    return {[=](int threads, const ReplayCosts& extra, Speeds speeds) {
                return replay_thread_pools({work->costs->first, work->segments}, work->items(threads, capacity),
                                           schedule, threads, extra, speeds);
            },
            bound};
}

}  // namespace

PreparedWay prepare(const ReplayWay& way, const PathCosts& costs, const CostModel& model) {
    const ReplaySchedule schedule = way.schedule;
    const std::size_t capacity = way.capacity != 0 ? way.capacity : costs.first.size();
    if (schedule.kind == ReplaySchedule::Kind::Balanced) return prepare_balanced(way, costs, model);
    switch (way.kind) {
        case ReplayWay::Kind::Loop: {
            const auto items = std::make_shared<const std::vector<double>>(item_costs(costs, way.grain, model));
            return {[=](int threads, const ReplayCosts& extra, Speeds speeds) {
                        return replay(*items, schedule, threads, extra, speeds);
                    },
                    [=](int threads) { return makespan_bound(*items, threads); }};
        }
        case ReplayWay::Kind::Drained: {
            const std::vector<float> segments = costs.segment_costs(model);
            const auto rounds = std::make_shared<const std::vector<std::vector<double>>>(drained_rounds(
                {costs.first, segments}, capacity, way.batch, way.batch == 1 ? Packing::Dense : Packing::InPlace));
            return {[=](int threads, const ReplayCosts& extra, Speeds) {
                        return replay_rounds(*rounds, schedule, threads, extra);
                    },
                    [=](int threads) { return makespan_bound(*rounds, threads); }};
        }
        case ReplayWay::Kind::Regenerated: {
            const auto segments = std::make_shared<const std::vector<float>>(costs.segment_costs(model));
            const double total = std::accumulate(segments->begin(), segments->end(), 0.0);
            return {[=, &costs](int threads, const ReplayCosts& extra, Speeds) {
                        const std::int64_t records = wavefront::shared_capacity(threads);
                        const std::int64_t batch = wavefront::shared_batch(records, threads);
                        return replay_shared_pool({costs.first, *segments}, static_cast<std::size_t>(records),
                                                  static_cast<std::size_t>(batch), threads, extra);
                    },
                    [=](int threads) { return total / threads; }};
        }
        case ReplayWay::Kind::ThreadPools: {
            const auto order = std::make_shared<const ItemOrder>(in_order(costs, way.grain, model, capacity));
            const auto items = std::make_shared<const std::vector<double>>(item_costs(costs, way.grain, model));
            return {[=](int threads, const ReplayCosts& extra, Speeds speeds) {
                        return replay_thread_pools(order->segments(), order->items, schedule, threads, extra, speeds);
                    },
                    [=](int threads) { return makespan_bound(*items, threads); }};
        }
    }
    return {};
}

}  // namespace raypool::studies
