// The closest hits of frozen rays: each ray by itself, registers of rays as packets, and the whole batch as a stream.
// All three read the same columns and must find the same hits, bit by bit.

#include <memory>
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

/// A way to intersect a batch.
class Contestant {
  public:
    Contestant() = default;
    Contestant(const Contestant&) = delete;
    Contestant& operator=(const Contestant&) = delete;
    virtual ~Contestant() = default;
    virtual void intersect(const Records& records, std::size_t count) = 0;
    virtual Hits hits() = 0;
};

/// Ray by ray, or as a stream: the intersection stage of the pool.
class Staged : public Contestant {
  public:
    Staged(Intersection intersection, std::size_t count) : rig_({.intersection = intersection}, count) {}
    void intersect(const Records& records, std::size_t count) override { rig_.stages().intersect(records, 0, count); }
    Hits hits() override { return {rig_.stages().stream().distance(), rig_.stages().stream().primitive_id()}; }

  private:
    StageRig<Lanes> rig_;
};

/// Packets, as the fused camera stage makes them, of whatever rays are neighbours in the batch.
class Packets : public Contestant {
  public:
    explicit Packets(std::size_t count) : distance_(count), primitive_id_(count) {
        RAYPOOL_CHECK(count % kLanes<Lanes> == 0, "a batch is made of whole registers");
    }
    void intersect(const Records& records, std::size_t count) override {
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
    Hits hits() override { return {distance_.data(), primitive_id_.data()}; }

  private:
    FlushDenormals flush_;
    std::vector<float> distance_;
    std::vector<std::int32_t> primitive_id_;
};

enum class Method { Single, Packet, Stream, Pairs };
constexpr Method kMethods[] = {Method::Single, Method::Packet, Method::Stream, Method::Pairs};
constexpr const char* kMethodNames[] = {"single", "packet", "stream", "pairs"};

std::unique_ptr<Contestant> make(Method method, std::size_t count) {
    if (method == Method::Packet) return std::make_unique<Packets>(count);
    return std::make_unique<Staged>(method == Method::Single   ? Intersection::Single
                                    : method == Method::Stream ? Intersection::Stream
                                                               : Intersection::Pairs,
                                    count);
}

/// What holds a ray: its record and its hit; in a stream also the row that the traversal reads.
double bytes_per_ray(Method method) {
    const std::size_t hit = sizeof(float) + sizeof(std::int32_t);
    const std::size_t row = method == Method::Stream || method == Method::Pairs ? sizeof(RayRow<float>) : 0;
    return static_cast<double>(record_bytes<kPaper, float>() + hit + row);
}

void intersect(benchmark::State& state, Method method, const RayKind& kind, std::size_t count) {
    const Records& records = frozen_rays(kind, count);
    const auto single = make(Method::Single, count);
    const auto contestant = make(method, count);
    single->intersect(records, count);
    contestant->intersect(records, count);
    const Hits expected = single->hits();
    const Hits found = contestant->hits();
    if (!agree(state,
               same_bits(expected.distance, found.distance, count) &&
                   same_bits(expected.primitive_id, found.primitive_id, count),
               "the hits differ from those of single rays"))
        return;
    for (auto _ : state) {
        contestant->intersect(records, count);
        benchmark::ClobberMemory();
    }
    count_rays(state, static_cast<std::int64_t>(count), bytes_per_ray(method));
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
    using namespace raypool;
    if (!begin_benchmarks(argc, argv)) return 2;
    for (const Method method : kMethods) {
        for_each_frozen_batch([&](const RayKind& kind, std::size_t count, const std::string& batch) {
            add_row(std::string("intersect/") + kMethodNames[static_cast<int>(method)] + "/" + batch,
                    [=](benchmark::State& state) { intersect(state, method, kind, count); });
        });
    }
    benchmark::RunSpecifiedBenchmarks();
}
