#include "bench/studies/gpu_occupancy.h"

#include <algorithm>

#include "core/base/error.h"

namespace raypool::studies {

namespace {

constexpr std::int64_t kWarp = 32;

/// A thread a path: the k-th round of a warp is the k-th segment of its paths.
std::vector<GpuRound> rounds_of_mega(std::span<const std::uint32_t> segments) {
    std::vector<GpuRound> rounds(segments.empty() ? 0 : *std::max_element(segments.begin(), segments.end()));
    for (std::size_t first = 0; first < segments.size(); first += kWarp) {
        const auto warp = segments.subspan(first, std::min<std::size_t>(kWarp, segments.size() - first));
        for (const std::uint32_t count : warp)
            for (std::uint32_t round = 0; round < count; ++round) ++rounds[round].live;
        const std::uint32_t longest = *std::max_element(warp.begin(), warp.end());
        for (std::uint32_t round = 0; round < longest; ++round) rounds[round].lanes += kWarp;
    }
    return rounds;
}

/// `threads` that take the next path when theirs has ended.
std::vector<GpuRound> rounds_of_regeneration(std::span<const std::uint32_t> segments, std::int64_t threads) {
    const auto used = std::min(static_cast<std::size_t>(threads), segments.size());
    std::vector<std::uint32_t> left(used);  // segments of each thread's path
    std::size_t next = 0;
    std::vector<GpuRound> rounds;
    for (;;) {
        GpuRound round;
        for (std::size_t first = 0; first < used; first += kWarp) {
            bool is_used = false;
            for (std::size_t i = first; i < std::min(first + kWarp, used); ++i) {
                if (left[i] == 0 && next < segments.size()) left[i] = segments[next++];
                if (left[i] == 0) continue;
                --left[i];
                ++round.live;
                is_used = true;
            }
            if (is_used) round.lanes += kWarp;
        }
        if (round.live == 0) return rounds;
        rounds.push_back(round);
    }
}

/// Records of one pool, which is filled up before every round; those that go on move together.
std::vector<GpuRound> rounds_of_wave(std::span<const std::uint32_t> segments, std::int64_t capacity) {
    std::vector<std::int64_t> ends;  // records whose last segment is so many rounds away
    std::size_t next = 0;
    std::int64_t live = 0;
    std::vector<GpuRound> rounds;
    for (std::size_t round = 0;; ++round) {
        for (; live < capacity && next < segments.size(); ++next, ++live) {
            const std::size_t last = round + segments[next] - 1;
            if (ends.size() <= last) ends.resize(last + 1);
            ++ends[last];
        }
        if (live == 0) return rounds;
        rounds.push_back({live, (live + kWarp - 1) / kWarp * kWarp});
        live -= ends[round];
    }
}

}  // namespace

std::vector<GpuRound> gpu_rounds(gpu::Form form, std::span<const std::uint32_t> segments, std::int64_t room) {
    RAYPOOL_CHECK(form == gpu::Form::Mega || room > 0, "a device has threads and a pool records");
    switch (form) {
        case gpu::Form::Mega:
            return rounds_of_mega(segments);
        case gpu::Form::MegaRegenerate:
            return rounds_of_regeneration(segments, room);
        case gpu::Form::Wave:
            break;
    }
    return rounds_of_wave(segments, room);
}

}  // namespace raypool::studies
