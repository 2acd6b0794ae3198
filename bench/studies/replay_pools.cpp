#include <algorithm>
#include <numeric>
#include <utility>

#include "bench/studies/replay_clocks.h"
#include "bench/studies/replay_model.h"

namespace raypool::studies {

namespace {

constexpr std::size_t kCameraChunk = 64;  // camera paths at a time, as the engine (wavefront/rounds.h)

/// The pool of a thread, or a batch of a shared pool.
class PathPool {
  public:
    explicit PathPool(const SegmentCosts& segments) : segments_(segments) {}

    [[nodiscard]] std::size_t size() const { return live_.size(); }

    /// Brings in paths [begin, end), and makes room for them, `most` in all, by rounds. Returns the work that was done.
    double add(std::uint32_t begin, std::uint32_t end, std::size_t most) {
        double work = 0;
        while (begin < end) {
            const std::size_t wanted = std::min({kCameraChunk, most, static_cast<std::size_t>(end - begin)});
            if (live_.size() + wanted > most) {
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
    /// Takes every path by one segment.
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
    double drain() {
        double work = 0;
        while (!live_.empty()) work += round();
        return work;
    }

  private:
    struct Live {
        std::uint32_t next;
        std::uint32_t end;
    };

    SegmentCosts segments_;
    std::vector<Live> live_;
};

}  // namespace

std::vector<double> item_costs(const SegmentCosts& segments, const PoolItems& items) {
    std::vector<double> costs(items.most_held.size());
    const auto segment_of = [&](std::size_t item) {
        return segments.cost.begin() + segments.first[items.first_path[item]];
    };
    for (std::size_t i = 0; i < costs.size(); ++i) costs[i] = std::accumulate(segment_of(i), segment_of(i + 1), 0.0);
    return costs;
}

Replayed replay_thread_pools(const SegmentCosts& segments, const PoolItems& items, const ReplaySchedule& schedule,
                             int threads, const ReplayCosts& costs, std::span<const double> speeds) {
    std::vector<PathPool> pools(static_cast<std::size_t>(threads), PathPool(segments));
    const auto add = [&](int thread, std::size_t item) {
        return pools[static_cast<std::size_t>(thread)].add(items.first_path[item], items.first_path[item + 1],
                                                           items.most_held[item]);
    };
    const auto drain = [&](int thread) { return pools[static_cast<std::size_t>(thread)].drain(); };
    return replay_items(order_of(item_costs(segments, items), schedule), schedule, threads, costs, speeds, 0, add,
                        drain);
}

Replayed replay_shared_pool(const SegmentCosts& segments, std::size_t capacity, std::size_t batch, int threads,
                            const ReplayCosts& costs) {
    const std::size_t batch_count = (capacity + batch - 1) / batch;
    std::vector<PathPool> batches(batch_count, PathPool(segments));
    Replayed result{std::vector<double>(static_cast<std::size_t>(threads)), {}, 0};
    const auto path_count = static_cast<std::uint32_t>(segments.path_count());
    std::uint32_t next_path = 0;
    for (int first = 0;; first = (first + 1) % threads) {
        const bool is_last = next_path == path_count;  // batches are then finished, each by one thread
        std::size_t next_batch = 0;
        std::vector<std::size_t> batch_of(static_cast<std::size_t>(threads), batch_count);  // that a thread fills up
        double end = 0;
        for (Clocks clocks(threads, first); !clocks.is_empty();) {
            const auto [start, rank, thread] = clocks.take();
            std::size_t& b = batch_of[static_cast<std::size_t>(thread)];
            const std::size_t size = b == batch_count ? batch : batches[b].size();
            double work = 0;
            if (size < batch && next_path < path_count) {
                const auto taken =
                    std::min({batch - size, kCameraChunk, static_cast<std::size_t>(path_count - next_path)});
                const std::uint32_t begin = std::exchange(next_path, next_path + static_cast<std::uint32_t>(taken));
                work = batches[b].add(begin, next_path, batch);
            } else if (next_batch < batch_count) {
                b = next_batch++;
                work = is_last ? batches[b].drain() : batches[b].round();
            } else {
                continue;
            }
            result.work[static_cast<std::size_t>(thread)] += work;
            const double now = start + work + costs.fetch;
            end = std::max(end, now);
            clocks.put(now, rank, thread);
        }
        result.makespan += end + costs.barrier;
        if (is_last) return result;
    }
}

}  // namespace raypool::studies
