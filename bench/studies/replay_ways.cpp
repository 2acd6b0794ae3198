#include "bench/studies/replay_ways.h"

#include <algorithm>
#include <memory>

#include "core/error.h"

namespace raypool::studies {

namespace {

std::vector<double> item_costs(const PathCosts& costs, const Grain& grain, const CostModel& model) {
    std::vector<double> items;
    for (const Tally& tally : costs.items(grain)) items.push_back(model.seconds(tally));
    return items;
}

}  // namespace

PreparedWay prepare(const ReplayWay& way, const PathCosts& costs, const CostModel& model) {
    const ReplaySchedule schedule = way.schedule;
    const std::size_t capacity = way.capacity != 0 ? way.capacity : costs.first.size();
    switch (way.kind) {
        case ReplayWay::Kind::Loop: {
            const auto items = std::make_shared<const std::vector<double>>(item_costs(costs, way.grain, model));
            return {[=](int threads, const ReplayCosts& extra) { return replay(*items, schedule, threads, extra); },
                    [=](int threads) { return makespan_bound(*items, threads); }};
        }
        case ReplayWay::Kind::Drained: {
            const std::vector<float> segments = costs.segment_costs(model);
            const auto rounds = std::make_shared<const std::vector<std::vector<double>>>(drained_rounds(
                {costs.first, segments}, capacity, way.batch, way.batch == 1 ? Packing::Dense : Packing::InPlace));
            return {
                [=](int threads, const ReplayCosts& extra) { return replay_rounds(*rounds, schedule, threads, extra); },
                [=](int threads) { return makespan_bound(*rounds, threads); }};
        }
        case ReplayWay::Kind::ThreadPools: {
            const auto order = std::make_shared<const ItemOrder>(in_order(costs, way.grain, model));
            const auto items = std::make_shared<const std::vector<double>>(item_costs(costs, way.grain, model));
            return {[=](int threads, const ReplayCosts& extra) {
                        return replay_thread_pools(order->segments(), order->first_path, capacity, schedule, threads,
                                                   extra);
                    },
                    [=](int threads) { return makespan_bound(*items, threads); }};
        }
    }
    return {};
}

Row sparse_row(const std::vector<Column>& columns, const std::vector<std::pair<std::string_view, Value>>& values) {
    Row row;
    std::size_t found = 0;
    for (const Column& column : columns) {
        const auto value =
            std::find_if(values.begin(), values.end(), [&](const auto& v) { return v.first == column.name; });
        row.push_back(value == values.end() ? Value() : value->second);
        if (value != values.end()) ++found;
    }
    RAYPOOL_CHECK(found == values.size(), "a study knows its columns");
    return row;
}

}  // namespace raypool::studies
