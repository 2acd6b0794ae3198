// How survivors of a shared pool reach the next round. One round over a full pool: every record is loaded, six in ten
// go on to the front of their batch, as in the shade stage, and the strategy passes them on. The pool is filled up
// again between rounds, outside the time.

#include <algorithm>
#include <numeric>
#include <vector>

#include "bench/bench_support.h"
#include "bench/frozen_rays.h"
#include "wavefront/append.h"

namespace raypool {
namespace {

using namespace wavefront;
using Pool = SharedPool<kPaper, float>;

constexpr std::size_t kBatch = 4096;
constexpr int kCapacities[] = {16384, 65536};
constexpr int kRays = kLanes<Lanes>;
/// For no splitting.
const Records kNoOverflow(0);

/// Records have serial numbers, and these decide: about 0.6 of them go on.
template <class Real>
unsigned survivors(const Uint32<Real>& serial) {
    const Uint32<Real> mixed = serial * Uint32<Real>(2654435769U) >> 16;
    return mask_bits(from_uint32<Real>(mixed) < Real(0.6F * 65536));
}

/// A record that can be told from all others in several fields.
RayRecord<float> numbered(std::uint32_t serial) {
    RayRecord<float> record{};
    record.key.pixel = serial;
    record.key.sample = ~serial;
    record.throughput = vec3<float>(1, 0.5F, static_cast<float>(serial % 1024));
    return record;
}

/// Calls visit(batch) for every batch, shared out among the threads, and ends the round.
template <class Visit>
void round(Pool& pool, int threads, Visit visit) {
#pragma omp parallel num_threads(threads)
    {
#pragma omp for schedule(dynamic)
        for (std::int64_t b = 0; b < pool.batch_count(); ++b) visit(b);
        pool.end_round([] {
#pragma omp barrier
        });
    }
}

/// Fills the free slots with new records.
void refill(Pool& pool, int threads, std::atomic<std::uint32_t>& next_serial) {
    round(pool, threads, [&](std::int64_t b) {
        std::size_t end = pool.enqueue(b, pool.first(b), pool.count(b), kNoOverflow, 0);
        const std::size_t free_slots = pool.free_slots(b);
        for (std::size_t i = 0; i < free_slots; ++i)
            pool.records().append<float>(end + i, numbered(next_serial++), 1, end + free_slots);
        pool.enqueue(b, end, free_slots, kNoOverflow, 0);
    });
}

/// What is timed: the survivors of every batch to its front, and on.
void survive(Pool& pool, int threads) {
    round(pool, threads, [&](std::int64_t b) {
        const std::size_t first = pool.first(b);
        const std::size_t count = pool.count(b);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count; i += kRays) {
            const RayRecord<Lanes> record = pool.records().load<Lanes>(first + i);
            const unsigned active = count - i >= kRays ? (1U << kRays) - 1 : (1U << (count - i)) - 1;
            const unsigned alive = survivors<Lanes>(record.key.pixel) & active;
            pool.records().append<Lanes>(first + kept, record, alive, first + count);
            kept += static_cast<std::size_t>(std::popcount(alive));
        }
        pool.enqueue(b, first, kept, kNoOverflow, 0);
    });
}

/// The serial numbers in the pool, sorted; of a damaged record a number that none has.
std::vector<std::uint32_t> serials(Pool& pool) {
    std::vector<std::uint32_t> all;
    for (std::int64_t b = 0; b < pool.batch_count(); ++b) {
        for (std::size_t i = 0; i < pool.count(b); ++i) {
            const RayRecord<float> record = pool.records().load<float>(pool.first(b) + i);
            const RayRecord<float> expected = numbered(record.key.pixel);
            const bool is_whole = record.key.sample == expected.key.sample && record.throughput == expected.throughput;
            all.push_back(is_whole ? record.key.pixel : ~0U);
        }
    }
    std::sort(all.begin(), all.end());
    return all;
}

/// Of a full pool, every survivor must arrive exactly once.
bool arrives_once(Pool& pool, std::size_t capacity, int threads) {
    std::atomic<std::uint32_t> next_serial = 0;
    refill(pool, threads, next_serial);
    std::vector<std::uint32_t> expected(capacity);
    std::iota(expected.begin(), expected.end(), 0U);
    if (serials(pool) != expected) return false;
    survive(pool, threads);
    std::erase_if(expected, [](std::uint32_t serial) { return survivors<float>(serial) == 0; });
    return serials(pool) == expected;
}

void append(benchmark::State& state, Append strategy, std::size_t capacity) {
    const auto threads = static_cast<int>(state.range(0));
    const auto make = [&] { return make_shared_pool<kPaper, float>(strategy, capacity, kBatch, 0, threads); };
    if (!agree(state, arrives_once(*make(), capacity, threads), "a survivor was lost, doubled or damaged")) return;

    const auto pool = make();
    std::atomic<std::uint32_t> next_serial = 0;
    time_prepared(
        state, [&] { refill(*pool, threads, next_serial); }, [&] { survive(*pool, threads); });
    count_rays(state, static_cast<std::int64_t>(capacity),
               static_cast<double>(shared_pool_bytes<kPaper, float>(strategy, {capacity, kBatch, 0}, threads)) /
                   static_cast<double>(capacity));
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
    using namespace raypool;
    if (!begin_benchmarks(argc, argv)) return 2;
    omp_set_dynamic(0);
    const struct {
        const char* name;
        Append append;
    } strategies[] = {
        {"in_place", Append::InPlace}, {"atomic_counter", Append::Atomic}, {"prefix_sum", Append::PrefixSum}};
    for (const auto& strategy : strategies) {
        for (const int capacity : kCapacities) {
            add_prepared_row(std::string("append/") + strategy.name + "/" + std::to_string(capacity),
                             [strategy, capacity](benchmark::State& state) {
                                 append(state, strategy.append, static_cast<std::size_t>(capacity));
                             })
                ->ArgName("threads")
                ->Arg(1)
                ->Arg(2);
        }
    }
    benchmark::RunSpecifiedBenchmarks();
}
