#include "cluster/exchange.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace raypool::cluster {

namespace {

constexpr std::size_t kChunkPixels = std::size_t{1} << 18;

template <class T>
void broadcast(Ranks& ranks, std::vector<T>& values) {
    values.resize(static_cast<std::size_t>(ranks.greatest(ranks.is_first() ? std::ssize(values) : 0)));
    ranks.broadcast(std::as_writable_bytes(std::span(values)));
}

/// What of a report has a fixed size, and goes ahead of its threads.
struct ReportHead {
    double seconds;
    double setup_s;
    SampleStatistics statistics;
    std::size_t memory_bytes;
};
static_assert(std::is_trivially_copyable_v<ReportHead> && std::is_trivially_copyable_v<ThreadReport>);

/// All that a pixel has.
std::span<std::int64_t> sums_of(Framebuffer& framebuffer, std::uint32_t pixel) {
    const std::size_t count = framebuffer.has_halves() ? 6 : 3;
    return framebuffer.sums().subspan(count * pixel, count);
}

}  // namespace

void gather(Ranks& ranks, Framebuffer& framebuffer) {
    if (!framebuffer.has_halves()) ranks.sum_at_first(framebuffer.sums());
}

void clear(Framebuffer& framebuffer, const std::vector<std::uint32_t>& pixels) {
    for (const std::uint32_t pixel : pixels) std::ranges::fill(sums_of(framebuffer, pixel), 0);
}

void sum_everywhere(Ranks& ranks, Framebuffer& framebuffer, const std::vector<std::uint32_t>& pixels) {
    const std::size_t count = pixels.size();
    for (std::size_t begin = 0; begin < count; begin += kChunkPixels) {
        const std::size_t end = std::min(begin + kChunkPixels, count);
        std::vector<std::int64_t> packed;
        for (std::size_t i = begin; i < end; ++i) {
            const std::span<const std::int64_t> sums = sums_of(framebuffer, pixels[i]);
            packed.insert(packed.end(), sums.begin(), sums.end());
        }
        ranks.sum_everywhere(packed);
        auto from = packed.cbegin();
        for (std::size_t i = begin; i < end; ++i)
            for (std::int64_t& sum : sums_of(framebuffer, pixels[i])) sum = *from++;
    }
}

void broadcast(Ranks& ranks, Checkpoint& sums) {
    broadcast(ranks, sums.ranges);
    broadcast(ranks, sums.sample_counts);
    sums.rounds = static_cast<int>(ranks.greatest(sums.rounds));
    if (sums.framebuffer.has_halves()) ranks.broadcast(std::as_writable_bytes(sums.framebuffer.sums()));
}

std::vector<RenderReport> gather(Ranks& ranks, const RenderReport& own) {
    const ReportHead head{own.seconds, own.setup_s, own.statistics, own.memory_bytes};
    std::vector<std::byte> bytes(sizeof(head) + own.threads.size() * sizeof(ThreadReport));
    std::memcpy(bytes.data(), &head, sizeof(head));
    std::memcpy(bytes.data() + sizeof(head), own.threads.data(), bytes.size() - sizeof(head));
    std::vector<RenderReport> reports;
    for (const std::vector<std::byte>& told : ranks.gather(bytes)) {
        ReportHead other;
        std::memcpy(&other, told.data(), sizeof(other));
        RenderReport& report = reports.emplace_back();
        report.seconds = other.seconds;
        report.setup_s = other.setup_s;
        report.statistics = other.statistics;
        report.memory_bytes = other.memory_bytes;
        report.threads.resize((told.size() - sizeof(other)) / sizeof(ThreadReport));
        std::memcpy(report.threads.data(), told.data() + sizeof(other), told.size() - sizeof(other));
    }
    if (!reports.empty()) reports.front().engine = own.engine;  // the first rank's, which alone is told
    return reports;
}

RenderReport joined(const std::vector<RenderReport>& ranks) {
    RenderReport all;
    for (const RenderReport& rank : ranks) {
        all.seconds = std::max(all.seconds, rank.seconds);
        all.setup_s = std::max(all.setup_s, rank.setup_s);
        all.statistics.add(rank.statistics);
        all.memory_bytes += rank.memory_bytes;
        if (all.engine == nullptr) all.engine = rank.engine;
        all.threads.insert(all.threads.end(), rank.threads.begin(), rank.threads.end());
    }
    for (ThreadReport& thread : all.threads) thread.wait_s = std::max(0.0, all.seconds - all.setup_s - thread.busy_s);
    return all;
}

}  // namespace raypool::cluster
