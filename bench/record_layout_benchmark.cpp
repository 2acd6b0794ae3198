// Structure-of-arrays against array-of-structures for ray records: what the shade stage does to memory, and nothing
// else. Every record of a pool is loaded, its throughput is changed, and three in four go on to the front of the pool.

#include <cstring>
#include <random>
#include <vector>

#include "bench/bench_support.h"
#include "bench/paper_scene.h"

namespace raypool {
namespace {

using namespace wavefront;
using Real = Lanes;
constexpr int kRays = kLanes<Real>;

/// The twin of RayColumns: the same fields, a record after the other.
class RayRows {
  public:
    explicit RayRows(std::size_t capacity) : memory_((capacity + kPadding) * record_bytes<kPaper, float>()) {}

    template <class R>
    RayRecord<R> load(std::size_t first) const {
        RayRecord<R> record;
        std::size_t offset = 0;
        for_each_field<kPaper>(record, [&](auto& field) {
            using T = typename LaneOf<std::remove_cvref_t<decltype(field)>>::Type;
            const auto value = [&](std::size_t i) {
                T bits;
                std::memcpy(&bits, memory_.data() + (first + i) * record_bytes<kPaper, float>() + offset, sizeof(T));
                return bits;
            };
            if constexpr (Simd<R>) {
                field = std::remove_cvref_t<decltype(field)>(value);
            } else {
                field = value(0);
            }
            offset += sizeof(T);
        });
        return record;
    }
    template <class R>
    void append(std::size_t first, const RayRecord<R>& record, unsigned bits, std::size_t) {
        for (; bits != 0; bits &= bits - 1) {
            std::byte* to = memory_.data() + first++ * record_bytes<kPaper, float>();
            for_each_field<kPaper>(record, [&](const auto& field) {
                const auto value = lane(field, std::countr_zero(bits));
                std::memcpy(to, &value, sizeof(value));
                to += sizeof(value);
            });
        }
    }

  private:
    std::vector<std::byte> memory_;
};

std::vector<unsigned> survivor_masks(std::size_t count) {
    std::mt19937 random(1);
    std::vector<unsigned> masks(count);
    for (unsigned& mask : masks)
        for (int i = 0; i < kRays; ++i) mask |= (random() % 4 != 0 ? 1U : 0U) << static_cast<unsigned>(i);
    return masks;
}

template <class Layout>
std::size_t pass(Layout& records, std::size_t count, const std::vector<unsigned>& masks) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; i += kRays) {
        RayRecord<Real> record = records.template load<Real>(i);
        for (int k = 0; k < 3; ++k) record.throughput[k] = record.throughput[k] * Real(0.5F) + Real(0.25F);
        records.template append<Real>(kept, record, masks[i / kRays], count);
        kept += static_cast<std::size_t>(std::popcount(masks[i / kRays]));
    }
    return kept;
}

/// Both layouts must hold the same records afterwards.
bool layouts_agree() {
    constexpr std::size_t kCount = 1024;
    const std::vector<unsigned> masks = survivor_masks(kCount / kRays);
    Records columns(kCount);
    RayRows rows(kCount);
    for (std::uint32_t i = 0; i < kCount; ++i) {
        RayRecord<float> record{};
        record.key.pixel = i;
        record.throughput = vec3<float>(1, 0, static_cast<float>(i));
        columns.append<float>(i, record, 1, kCount);
        rows.append<float>(i, record, 1, kCount);
    }
    const std::size_t kept = pass(columns, kCount, masks);
    if (pass(rows, kCount, masks) != kept) return false;
    for (std::size_t i = 0; i < kept; ++i) {
        const auto a = columns.load<float>(i);
        const auto b = rows.load<float>(i);
        if (a.key.pixel != b.key.pixel || a.throughput != b.throughput) return false;
    }
    return true;
}

template <class Layout>
void shade_memory(benchmark::State& state) {
    if (!agree(state, layouts_agree(), "the layouts hold different records")) return;
    const auto count = static_cast<std::size_t>(state.range(0));
    const std::vector<unsigned> masks = survivor_masks(count / kRays);
    Layout records(count);
    for (auto _ : state) benchmark::DoNotOptimize(pass(records, count, masks));
    count_rays(state, state.range(0), static_cast<double>(record_bytes<kPaper, float>()));
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
    using namespace raypool;
    if (!begin_benchmarks(argc, argv)) return 2;
    add_row("record/layout/structure_of_arrays", shade_memory<Records>)->RangeMultiplier(8)->Range(1024, 65536);
    add_row("record/layout/array_of_structures", shade_memory<RayRows>)->RangeMultiplier(8)->Range(1024, 65536);
    benchmark::RunSpecifiedBenchmarks();
}
