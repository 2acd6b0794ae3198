/// Ways of handing out the image that studies replay, and how recorded costs become what a replay wants.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "bench/studies/path_costs.h"
#include "bench/studies/replay_model.h"
#include "core/runtime/settings_text.h"
#include "wavefront/settings.h"

namespace raypool::studies {

/// The schedules of a tracer that takes one path at a time, or the pools.
struct ReplayWay {
    enum class Kind : std::uint8_t {
        Loop,         ///< over the items of a grain
        Drained,      ///< a shared pool in batches, drained, a barrier after each round
        Regenerated,  ///< a shared pool that takes camera paths in every round; its sizes follow the number of threads
        ThreadPools   ///< a pool for each thread, over the items of a grain
    };
    std::string name;
    Kind kind = Kind::Loop;
    Grain grain;               ///< of a loop and of thread pools; pixels for balanced items
    ReplaySchedule schedule;   ///< of loops and of drained rounds
    std::size_t capacity = 0;  ///< of a pool; 0: all paths of the image
    std::size_t batch = 0;     ///< of a drained pool; 1 with a static schedule: equal contiguous shares
};

/// Tasks are taken to be handed out as chunks are.
inline ReplaySchedule to_replay(const LoopSchedule& schedule) {
    using Kind = ReplaySchedule::Kind;
    constexpr Kind kKinds[] = {Kind::Static, Kind::Dynamic, Kind::Guided, Kind::Dynamic, Kind::Balanced};
    return {kKinds[static_cast<int>(schedule.kind)], schedule.chunk};
}

/// A way of the real engines.
inline ReplayWay loop_way(const LoopWay& way) {
    return {way.name, ReplayWay::Kind::Loop, parse_grain(way.grain), to_replay(parse_schedule(way.schedule)), 0, 0};
}
inline ReplayWay thread_pool_way(const LoopWay& way) {
    ReplayWay pools = loop_way(way);
    pools.kind = ReplayWay::Kind::ThreadPools;
    pools.capacity = static_cast<std::size_t>(wavefront::PoolSettings::kThreadCapacity);
    return pools;
}

/// A way with everything about the work prepared, so that thread counts are cheap.
struct PreparedWay {
    /// The speeds as in raypool::studies::replay(); rounds know none.
    std::function<Replayed(int threads, const ReplayCosts& costs, std::span<const double> speeds)> replay;
    std::function<double(int threads)> bound;  ///< the shortest makespan
};
/// The costs outlive it.
PreparedWay prepare(const ReplayWay& way, const PathCosts& costs, const CostModel& model);

}  // namespace raypool::studies
