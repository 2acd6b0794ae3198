#include "bench/studies/replay_model.h"

#include <algorithm>
#include <numeric>
#include <queue>
#include <tuple>

namespace raypool::studies {

namespace {

using Kind = ReplaySchedule::Kind;

/// A range of iterations; an empty one says that there are no more.
struct Chunk {
    std::int64_t begin = 0;
    std::int64_t end = 0;
};

/// Hands out iterations 0 .. count - 1, as the runtime of OpenMP does.
class Dispenser {
  public:
    Dispenser(std::int64_t count, const ReplaySchedule& schedule, int threads)
        : count_(count), schedule_(schedule), threads_(threads), turn_(static_cast<std::size_t>(threads)) {}

    [[nodiscard]] bool is_fetching() const { return schedule_.kind != Kind::Static; }

    Chunk next(int thread) {
        if (schedule_.kind == Kind::Static) return next_static(thread);
        const std::int64_t left = count_ - next_;
        const std::int64_t size = std::min(left, fetched_size(left));
        next_ += size;
        return {next_ - size, next_};
    }

  private:
    Chunk next_static(int thread) {
        const std::int64_t turn = turn_[static_cast<std::size_t>(thread)]++;
        if (schedule_.chunk == 0) {  // one block each; the first ones are longer by one
            if (turn > 0) return {};
            const std::int64_t share = count_ / threads_;
            const std::int64_t longer = count_ % threads_;
            const std::int64_t begin = thread * share + std::min<std::int64_t>(thread, longer);
            return {begin, begin + share + (thread < longer ? 1 : 0)};
        }
        const std::int64_t begin = std::min(count_, (turn * threads_ + thread) * schedule_.chunk);
        return {begin, std::min(count_, begin + schedule_.chunk)};
    }
    std::int64_t fetched_size(std::int64_t left) {
        const std::int64_t least = std::max<std::int64_t>(schedule_.chunk, 1);
        switch (schedule_.kind) {
            case Kind::Guided:
                return std::max(least, (left + threads_ - 1) / threads_);
            case Kind::Factoring:
                if (batch_left_ == 0) {
                    batch_left_ = threads_;
                    batch_size_ = (left + 2 * threads_ - 1) / (2 * threads_);
                }
                --batch_left_;
                return batch_size_;
            default:
                return least;
        }
    }

    std::int64_t count_;
    ReplaySchedule schedule_;
    std::int64_t threads_;
    std::vector<std::int64_t> turn_;  // chunks that each thread has had, of a static schedule
    std::int64_t next_ = 0;
    std::int64_t batch_left_ = 0;  // of factoring: chunks of the batch under way
    std::int64_t batch_size_ = 0;
};

/// Threads by the time at which they want their next chunk. Of threads that come at once, `first` is the first.
class Clocks {
  public:
    Clocks(int threads, int first) {
        for (int i = 0; i < threads; ++i) queue_.emplace(0.0, i, (first + i) % threads);
    }
    [[nodiscard]] bool is_empty() const { return queue_.empty(); }
    std::tuple<double, int, int> take() {
        const auto top = queue_.top();
        queue_.pop();
        return top;
    }
    void put(double time, int rank, int thread) { queue_.emplace(time, rank, thread); }

  private:
    using Entry = std::tuple<double, int, int>;  // time, rank, thread
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

/// The order in which a schedule takes items.
std::vector<std::int32_t> order_of(std::span<const double> items, const ReplaySchedule& schedule) {
    std::vector<std::int32_t> order(items.size());
    std::iota(order.begin(), order.end(), 0);
    if (schedule.kind == Kind::LongestFirst)
        std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
            return items[static_cast<std::size_t>(a)] > items[static_cast<std::size_t>(b)];
        });
    return order;
}

Replayed replay_from(std::span<const double> items, const ReplaySchedule& schedule, int threads,
                     const ReplayCosts& costs, int first, std::span<const double> speeds = {}) {
    const std::vector<std::int32_t> order = order_of(items, schedule);
    Dispenser dispenser(static_cast<std::int64_t>(items.size()), schedule, threads);
    Replayed result{std::vector<double>(static_cast<std::size_t>(threads)), std::vector<std::int32_t>(items.size()), 0};
    double start = 0;  // of the latest chunk: nobody is served before it
    for (Clocks clocks(threads, first); !clocks.is_empty();) {
        const auto [asked, rank, thread] = clocks.take();
        const Chunk chunk = dispenser.next(thread);
        if (chunk.begin == chunk.end) continue;
        start = std::max(asked, start) + (dispenser.is_fetching() ? costs.serve : 0);
        double work = 0;
        for (std::int64_t i = chunk.begin; i < chunk.end; ++i) {
            const auto item = static_cast<std::size_t>(order[static_cast<std::size_t>(i)]);
            work += items[item];
            result.owner[item] = thread;
        }
        result.work[static_cast<std::size_t>(thread)] += work;
        const double speed = speeds.empty() ? 1 : speeds[static_cast<std::size_t>(thread)];
        const double end = start + work / speed + (dispenser.is_fetching() ? costs.fetch : 0);
        result.makespan = std::max(result.makespan, end);
        clocks.put(end, rank, thread);
    }
    return result;
}

/// The pool of one thread of replay_thread_pools().
class PathPool {
  public:
    PathPool(const SegmentCosts& segments, std::size_t capacity) : segments_(segments), capacity_(capacity) {}

    /// Brings in paths [begin, end), and makes room for them by rounds. Returns the work that was done.
    double add(std::uint32_t begin, std::uint32_t end) {
        double work = 0;
        while (begin < end) {
            const std::size_t wanted = std::min({kChunk, capacity_, static_cast<std::size_t>(end - begin)});
            if (live_.size() + wanted > capacity_) {
                work += round();
                continue;
            }
            for (const std::uint32_t last = begin + static_cast<std::uint32_t>(wanted); begin < last; ++begin) {
                const Live path{segments_.first[begin], segments_.first[begin + 1]};
                work += segments_.cost[path.next];
                if (path.next + 1 < path.end) live_.push_back({path.next + 1, path.end});
            }
        }
        return work;
    }
    double drain() {
        double work = 0;
        while (!live_.empty()) work += round();
        return work;
    }

  private:
    static constexpr std::size_t kChunk = 64;  // camera paths at a time, as the engine (wavefront/rounds.h)
    struct Live {
        std::uint32_t next;
        std::uint32_t end;
    };
    double round() {
        double work = 0;
        std::size_t alive = 0;
        for (const Live& path : live_) {
            work += segments_.cost[path.next];
            if (path.next + 1 < path.end) live_[alive++] = {path.next + 1, path.end};
        }
        live_.resize(alive);
        return work;
    }

    SegmentCosts segments_;
    std::size_t capacity_;
    std::vector<Live> live_;
};

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

Replayed replay_thread_pools(const SegmentCosts& segments, std::span<const std::uint32_t> first_path,
                             std::size_t capacity, const ReplaySchedule& schedule, int threads,
                             const ReplayCosts& costs) {
    const std::size_t item_count = first_path.size() - 1;
    std::vector<double> items(item_count);
    for (std::size_t i = 0; i < item_count; ++i)
        for (std::uint32_t s = segments.first[first_path[i]]; s < segments.first[first_path[i + 1]]; ++s)
            items[i] += segments.cost[s];
    const std::vector<std::int32_t> order = order_of(items, schedule);

    Dispenser dispenser(static_cast<std::int64_t>(item_count), schedule, threads);
    std::vector<PathPool> pools(static_cast<std::size_t>(threads), PathPool(segments, capacity));
    Replayed result{std::vector<double>(pools.size()), std::vector<std::int32_t>(item_count), 0};
    for (Clocks clocks(threads, 0); !clocks.is_empty();) {
        const auto [start, rank, thread] = clocks.take();
        PathPool& pool = pools[static_cast<std::size_t>(thread)];
        const Chunk chunk = dispenser.next(thread);
        const bool is_last = chunk.begin == chunk.end;
        double work = is_last ? pool.drain() : 0;
        for (std::int64_t i = chunk.begin; i < chunk.end; ++i) {
            const auto item = static_cast<std::size_t>(order[static_cast<std::size_t>(i)]);
            work += pool.add(first_path[item], first_path[item + 1]);
            result.owner[item] = thread;
        }
        result.work[static_cast<std::size_t>(thread)] += work;
        const double end = start + work + (dispenser.is_fetching() && !is_last ? costs.fetch : 0);
        result.makespan = std::max(result.makespan, end);
        if (!is_last) clocks.put(end, rank, thread);
    }
    return result;
}

}  // namespace raypool::studies
