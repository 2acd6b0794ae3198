/// What replays are made of: what hands out the iterations of a loop, which thread comes next, and the loop over items.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <numeric>
#include <queue>
#include <span>
#include <tuple>
#include <vector>

#include "bench/studies/replay_model.h"

namespace raypool::studies {

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

    [[nodiscard]] bool is_fetching() const { return schedule_.kind != ReplaySchedule::Kind::Static; }

    Chunk next(int thread) {
        if (schedule_.kind == ReplaySchedule::Kind::Static) return next_static(thread);
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
        using Kind = ReplaySchedule::Kind;
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

/// Threads by the time at which they want their next chunk. Of threads that come at once, the lower rank is the first.
class Clocks {
  public:
    /// All at time 0, from thread `first` on.
    Clocks(int threads, int first) {
        for (int i = 0; i < threads; ++i) put(0, i, (first + i) % threads);
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
inline std::vector<std::int32_t> order_of(std::span<const double> items, const ReplaySchedule& schedule) {
    std::vector<std::int32_t> order(items.size());
    std::iota(order.begin(), order.end(), 0);
    if (schedule.kind == ReplaySchedule::Kind::LongestFirst)
        std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
            return items[static_cast<std::size_t>(a)] > items[static_cast<std::size_t>(b)];
        });
    return order;
}

/// A loop over the items of `order`: work(thread, item) is what an item takes, finish(thread) what a thread still has
/// to do once there are no more. Of threads that come at once, `first` is the first.
template <class Work, class Finish>
Replayed replay_items(const std::vector<std::int32_t>& order, const ReplaySchedule& schedule, int threads,
                      const ReplayCosts& costs, std::span<const double> speeds, int first, Work work, Finish finish) {
    Dispenser dispenser(static_cast<std::int64_t>(order.size()), schedule, threads);
    Replayed result{std::vector<double>(static_cast<std::size_t>(threads)), std::vector<std::int32_t>(order.size()), 0};
    double start = 0;  // of the latest chunk: no thread is served before it
    for (Clocks clocks(threads, first); !clocks.is_empty();) {
        const auto [asked, rank, thread] = clocks.take();
        const Chunk chunk = dispenser.next(thread);
        const bool is_last = chunk.begin == chunk.end;
        const ReplayCosts extra = dispenser.is_fetching() && !is_last ? costs : ReplayCosts{};
        start = std::max(asked, start) + extra.serve;
        double done = is_last ? finish(thread) : 0;
        for (std::int64_t i = chunk.begin; i < chunk.end; ++i) {
            const auto item = static_cast<std::size_t>(order[static_cast<std::size_t>(i)]);
            done += work(thread, item);
            result.owner[item] = thread;
        }
        result.work[static_cast<std::size_t>(thread)] += done;
        const double speed = speeds.empty() ? 1 : speeds[static_cast<std::size_t>(thread)];
        const double end = start + done / speed + extra.fetch;
        result.makespan = std::max(result.makespan, end);
        if (!is_last) clocks.put(end, rank, thread);
    }
    return result;
}

}  // namespace raypool::studies
