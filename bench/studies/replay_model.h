/// What a schedule makes of work whose costs are known, for any number of threads: balance without a machine.
///
/// Costs may have any unit, and all results have it. Iterations are handed out as OpenMP's runtime does (GNU's for
/// guided, where runtimes differ), threads run at one speed unless it is said otherwise, and nothing is known of
/// memory: a replay is what the balance of work, the fetching of chunks and the barriers allow, and no more. Pure
/// functions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace raypool::studies {

struct ReplaySchedule {
    enum class Kind : std::uint8_t {
        Static,
        Dynamic,
        Guided,
        /// Dynamic, the dearest item first (Graham, "Bounds on Multiprocessing Timing Anomalies", 1969).
        LongestFirst,
        /// Half of what is left in equal chunks, one for each thread, again and again (Hummel, Schonberg and Flynn,
        /// "Factoring", 1992).
        Factoring,
        /// Dynamic, one by one, of items that are cut for so many threads (core/runtime/balanced_items.h).
        Balanced
    };
    Kind kind = Kind::Static;
    std::int64_t chunk = 0;  ///< 0: OpenMP's default for the kind; of no meaning to the last three kinds
};

/// What running in parallel costs by itself.
struct ReplayCosts {
    double fetch = 0;    ///< of a chunk, to the thread that fetches it; static schedules fetch none
    double barrier = 0;  ///< of the end of a round
    double serve = 0;    ///< of a chunk, a time in which others that ask wait
};

struct Replayed {
    std::vector<double> work;         ///< of each thread, without the costs of running in parallel
    std::vector<std::int32_t> owner;  ///< of each item; empty for rounds
    double makespan = 0;              ///< until the last thread is done, all costs included

    [[nodiscard]] double total() const;
    /// Work over the time of all threads: 1 is perfect.
    [[nodiscard]] double efficiency() const;
};

/// A loop over items. There is at least one thread. `speeds` are of the threads: an item takes a thread its cost over
/// the speed; none means 1 for all.
Replayed replay(std::span<const double> items, const ReplaySchedule& schedule, int threads,
                const ReplayCosts& costs = {}, std::span<const double> speeds = {});

/// The shortest time that any schedule can reach: an equal share, or the dearest item.
double makespan_bound(std::span<const double> items, int threads);

/// The segments of paths: those of path i are cost[first[i]] ... cost[first[i + 1] - 1], and there is at least one.
struct SegmentCosts {
    std::span<const std::uint32_t> first;
    std::span<const float> cost;

    [[nodiscard]] std::size_t path_count() const { return first.size() - 1; }
};

/// Where a path that is alive finds its place in the next round: in the batch that it was in, as the engine's pool has
/// it unless it is told otherwise, or behind the path before it.
enum class Packing : std::uint8_t { InPlace, Dense };

/// The rounds of a shared pool that is filled with `capacity` paths in order, and drained: in each, the next segment of
/// every path that is alive, in order, summed up in batches of `batch`. A round without work, in which camera rays are
/// made, comes before those of each filling.
std::vector<std::vector<double>> drained_rounds(const SegmentCosts& segments, std::size_t capacity, std::size_t batch,
                                                Packing packing);

/// Rounds with a barrier after each. Threads come to a round in another order each time.
Replayed replay_rounds(std::span<const std::vector<double>> rounds, const ReplaySchedule& schedule, int threads,
                       const ReplayCosts& costs = {});
/// A shared pool in batches that threads take as they come, refilled as soon as there is room, in rounds with a barrier
/// after each: every path of a batch by one segment, and then the first segments of camera paths, a few at a time,
/// until the batch is full. Once there are no camera paths left, each batch is finished by the thread that takes it.
Replayed replay_shared_pool(const SegmentCosts& segments, std::size_t capacity, std::size_t batch, int threads,
                            const ReplayCosts& costs = {});
/// The bound of every round, added up.
double makespan_bound(std::span<const std::vector<double>> rounds, int threads);

/// Items of the pools of threads: ranges of paths, and how many paths a pool holds at most once it has the item.
struct PoolItems {
    std::vector<std::uint32_t> first_path;  ///< of each item, and the end
    std::vector<std::size_t> most_held;     ///< by item
};

/// What each item costs.
std::vector<double> item_costs(const SegmentCosts& segments, const PoolItems& items);

/// A pool for each thread, refilled as soon as there is room: a thread fetches the next item while its pool has room,
/// and then takes every path of the pool through a segment. So many paths are in threads' hands before anybody knows
/// what they cost. `speeds` as in replay().
Replayed replay_thread_pools(const SegmentCosts& segments, const PoolItems& items, const ReplaySchedule& schedule,
                             int threads, const ReplayCosts& costs = {}, std::span<const double> speeds = {});

}  // namespace raypool::studies
