// The closest hits of frozen rays: each ray by itself, registers of rays as packets, and the whole batch as a stream.
// All three read the same columns and must find the same hits, bit by bit.

#include <vector>

#include "bench/bench_support.h"
#include "bench/frozen_rays.h"

namespace raypool {
namespace {

using namespace wavefront;

/// Where hits come to lie.
struct Hits {
    const float* distance;
    const std::int32_t* primitive_id;
};

/// Ray by ray, or as a stream: the intersection stage of the pool.
template <Intersection intersection>
class Staged {
  public:
    explicit Staged(std::size_t count) : rig_({.intersection = intersection}, count) {}
    void intersect(const Records& records, std::size_t count) { rig_.stages().intersect(records, 0, count); }
    Hits hits() { return {rig_.stages().stream().distance(), rig_.stages().stream().primitive_id()}; }

  private:
    StageRig<Lanes> rig_;
};

/// Packets, as the fused camera stage makes them, of whatever rays are neighbours in the batch.
class Packets {
  public:
    explicit Packets(std::size_t count) : distance_(count), primitive_id_(count) {
        RAYPOOL_CHECK(count % kLanes<Lanes> == 0, "a batch is made of whole registers");
    }
    void intersect(const Records& records, std::size_t count) {
        using Ids = stdx::rebind_simd_t<std::int32_t, Uint32<Lanes>>;
        NoTestCount work;
        for (std::size_t i = 0; i < count; i += kLanes<Lanes>) {
            const RayRecord<Lanes> record = records.load<Lanes>(i);
            const auto hit = closest_hits<kPaper, Lanes>(paper_scene(), wide_rays<Lanes>(record.ray, record.leaving_id),
                                                         Mask<Lanes>(true), work);
            hit.t.copy_to(&distance_[i], stdx::element_aligned);
            stdx::static_simd_cast<Ids>(hit.primitive_id).copy_to(&primitive_id_[i], stdx::element_aligned);
        }
    }
    [[nodiscard]] Hits hits() const { return {distance_.data(), primitive_id_.data()}; }

  private:
    FlushDenormals flush_;
    std::vector<float> distance_;
    std::vector<std::int32_t> primitive_id_;
};

/// The contestant is one of the classes above. A ray is held by its record and its hit, and by `row_bytes` more.
template <class Contestant, std::size_t row_bytes>
void intersect(benchmark::State& state, const RayKind& kind, std::size_t count) {
    const Records& records = frozen_rays(kind, count);
    Staged<Intersection::Single> single(count);
    Contestant contestant(count);
    single.intersect(records, count);
    contestant.intersect(records, count);
    const Hits expected = single.hits();
    const Hits found = contestant.hits();
    if (!agree(state,
               same_bits(expected.distance, found.distance, count) &&
                   same_bits(expected.primitive_id, found.primitive_id, count),
               "the hits differ from those of single rays"))
        return;
    for (auto _ : state) {
        contestant.intersect(records, count);
        benchmark::ClobberMemory();
    }
    const std::size_t bytes = record_bytes<kPaper, float>() + sizeof(float) + sizeof(std::int32_t) + row_bytes;
    count_rays(state, static_cast<std::int64_t>(count), static_cast<double>(bytes));
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
    using namespace raypool;
    if (!begin_benchmarks(argc, argv)) return 2;
    constexpr std::size_t kRow = sizeof(RayRow<float>);  // that the traversal of a stream reads
    const struct {
        const char* name;
        void (*run)(benchmark::State& state, const RayKind& kind, std::size_t count);
    } contestants[] = {{"single", intersect<Staged<Intersection::Single>, 0>},
                       {"packet", intersect<Packets, 0>},
                       {"stream", intersect<Staged<Intersection::Stream>, kRow>},
                       {"pairs", intersect<Staged<Intersection::Pairs>, kRow>}};
    for (const auto& contestant : contestants) {
        for_each_frozen_batch([&](const RayKind& kind, std::size_t count, const std::string& batch) {
            add_row(std::string("intersect/") + contestant.name + "/" + batch,
                    [=, run = contestant.run](benchmark::State& state) { run(state, kind, count); });
        });
    }
    benchmark::RunSpecifiedBenchmarks();
}
