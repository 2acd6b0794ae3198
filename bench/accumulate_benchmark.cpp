// How radiance reaches the framebuffer.
//   accumulate/...   every kind of accumulator, where threads have pixels of their own and where all add to the same
//   few framebuffer/...  the contributions of a real render, to sums that lie side by side (r, g, b, r, g, b, ...) or
//   in
//                    three planes, in the order of the pixels and in the order in which a shared pool ends its paths

#include <algorithm>
#include <functional>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "bench/bench_support.h"
#include "bench/frozen_rays.h"
#include "wavefront/rounds.h"
#include "wavefront/stages.h"

namespace raypool {
namespace {

using namespace wavefront;
using AnyAccumulator = AccumulatorBase<float>;

constexpr std::size_t kContributionBytes = 3 * sizeof(float) + sizeof(std::uint32_t);
constexpr std::size_t kSumBytes = 3 * sizeof(std::int64_t);

struct Kind {
    const char* name;
    Accumulator accumulator;
    bool is_exact;   ///< adds integers: the same sums in any order
    bool may_share;  ///< threads may add to one pixel
};
constexpr Kind kKinds[] = {
    {"owned", Accumulator::OwnedInt64, true, false},
    {"atomic", Accumulator::AtomicInt64, true, true},
    {"private", Accumulator::PrivateInt64, true, true},
    {"owned_planar", Accumulator::OwnedPlanarInt64, true, false},
    {"atomic_planar", Accumulator::AtomicPlanarInt64, true, true},
    {"atomic_float", Accumulator::AtomicFloat, false, true},
    {"atomic_double", Accumulator::AtomicDouble, false, true},
};

Framebuffer empty_framebuffer() {
    return {paper_scene().width, paper_scene().height, StageRig<float>::roomy()};
}

/// A sample that ended.
struct Contribution {
    std::uint32_t pixel;
    Vec3<float> radiance;
};

/// Contributions in the batches in which stages hand them on.
using Batches = std::vector<Contributions<float>>;
Batches batches(const std::vector<Contribution>& contributions) {
    constexpr std::size_t kBatch = 1024;
    Batches all((contributions.size() + kBatch - 1) / kBatch);
    for (Contributions<float>& batch : all) batch.reserve(kBatch);
    for (std::size_t i = 0; i < contributions.size(); ++i)
        all[i / kBatch].put<float>(contributions[i].pixel, contributions[i].radiance, 1);
    return all;
}
std::int64_t count_of(const Batches& batches) {
    std::size_t count = 0;
    for (const Contributions<float>& batch : batches) count += batch.count();
    return static_cast<std::int64_t>(count);
}
void add_all(AnyAccumulator& accumulator, const Batches& batches, const FixedPoint& fixed, int thread) {
    SampleConverter converter(fixed);
    for (const Contributions<float>& batch : batches) accumulator.add(batch, converter, thread);
}

// Accumulators, by themselves.

enum class Pixels { Own, Same };

/// What each of `threads` threads adds: anywhere in its part of the image, or to the same eight pixels.
std::vector<Batches> contributions_of_threads(Pixels pixels, int threads) {
    constexpr std::size_t kContributions = 65536;
    const auto image = static_cast<std::uint32_t>(paper_scene().pixel_count());
    const std::uint32_t part = pixels == Pixels::Own ? image / static_cast<std::uint32_t>(threads) : 8;
    std::vector<Batches> all;
    for (int thread = 0; thread < threads; ++thread) {
        std::mt19937 random(static_cast<unsigned>(thread));
        std::uniform_real_distribution<float> unit(0, 1);
        const std::uint32_t first = pixels == Pixels::Own ? static_cast<std::uint32_t>(thread) * part : image / 2;
        std::vector<Contribution> contributions(kContributions);
        for (Contribution& contribution : contributions)
            contribution = {first + static_cast<std::uint32_t>(random() % part),
                            vec3<float>(unit(random), unit(random), unit(random))};
        all.push_back(batches(contributions));
    }
    return all;
}

void add_all(AnyAccumulator& accumulator, const std::vector<Batches>& contributions, const FixedPoint& fixed) {
#pragma omp parallel for num_threads(static_cast <int>(contributions.size())) schedule(static, 1)
    for (std::size_t thread = 0; thread < contributions.size(); ++thread)
        add_all(accumulator, contributions[thread], fixed, static_cast<int>(thread));
}

/// The same sums as when one thread adds one contribution after the other; where they round, within one in a hundred.
bool sums_agree(const Framebuffer& sums, const Framebuffer& expected, bool is_exact) {
    if (is_exact) return sums.hash() == expected.hash();
    return std::equal(sums.sums().begin(), sums.sums().end(), expected.sums().begin(),
                      [](std::int64_t a, std::int64_t b) { return std::abs(a - b) <= b / 100; });
}

void accumulate(benchmark::State& state, const Kind& kind, Pixels pixels) {
    const auto threads = static_cast<int>(state.range(0));
    const auto contributions = contributions_of_threads(pixels, threads);
    Framebuffer framebuffer = empty_framebuffer();
    Framebuffer expected = empty_framebuffer();
    auto accumulator = make_accumulator<float>(kind.accumulator, framebuffer, threads);
    add_all(*accumulator, contributions, framebuffer.fixed_point());
    merge_all(*accumulator);
    for (const auto& of_thread : contributions) {
        SampleConverter converter(expected.fixed_point());
        for (const Contributions<float>& batch : of_thread)
            for (std::size_t i = 0; i < batch.count(); ++i)
                expected.add(batch.pixel(i), converter.convert<float>(batch.radiance(i)));
    }
    if (!agree(state, sums_agree(framebuffer, expected, kind.is_exact), "the sums are wrong")) return;

    // What merge() does once at the end of a render is not timed.
    accumulator = make_accumulator<float>(kind.accumulator, framebuffer, threads);
    for (auto _ : state) add_all(*accumulator, contributions, framebuffer.fixed_point());
    std::int64_t count = 0;
    for (const Batches& of_thread : contributions) count += count_of(of_thread);
    const double own_bytes = static_cast<double>(accumulator_bytes(kind.accumulator, framebuffer, threads)) /
                             static_cast<double>(paper_scene().pixel_count());
    count_rays(state, count, kContributionBytes + (own_bytes > 0 ? own_bytes : kSumBytes));
}

// Layouts of the framebuffer.

/// Writes down the contributions in their order.
class Recorder : public AnyAccumulator {
  public:
    void add(const Contributions<float>& contributions, SampleConverter&, int) override {
        for (std::size_t i = 0; i < contributions.count(); ++i)
            all_.push_back({contributions.pixel(i), contributions.radiance(i)});
    }
    std::vector<Contribution>& all() { return all_; }

  private:
    std::vector<Contribution> all_;
};

/// The samples of an image in the order in which the paper's pool ends them.
std::vector<Contribution> pool_order() {
    constexpr PoolSettings kPool{.scope = PoolScope::Shared, .refill = Refill::Drain, .camera = CameraStage::Staged};
    Recorder recorder;
    InPlacePool<kPaper, float> pool(PoolSettings::kSharedCapacity, static_cast<std::size_t>(kPool.batch), 0);
    StageRig<Lanes> rig(kPool, pool.batch(), &recorder);
    auto& stages = rig.stages();
    const CameraPaths image(RenderUnit{0, 4, nullptr}, paper_scene().width, paper_scene().height);
    PathCounter camera(image.left());
    do {  // the rounds of SharedPoolSession, in one thread
        const bool takes_camera = pool.is_empty();
        for (std::int64_t b = 0; b < pool.batch_count(); ++b) {
            const std::size_t survivors = stages.advance(pool.records(), pool.first(b), pool.count(b));
            std::size_t end = stages.enqueue(pool, b, pool.first(b), survivors);
            for (std::size_t free_slots = takes_camera ? pool.free_slots(b) : 0; free_slots > 0;) {
                const PathCounter::Part part = camera.take(std::min(free_slots, kCameraChunk));
                if (part.count == 0) break;
                free_slots -= static_cast<std::size_t>(part.count);
                end = stages.enqueue(pool, b, end,
                                     stages.generate(pool.records(), end, image.part(part.begin, part.count)));
            }
        }
        pool.end_round([] {});
    } while (!pool.is_empty() || !camera.is_done());
    return std::move(recorder.all());
}

enum class Order { Pixels, Pool };

const Batches& contributions_in(Order order) {
    const auto make = [](bool is_sorted) {
        std::vector<Contribution> contributions = pool_order();
        if (is_sorted)
            std::stable_sort(contributions.begin(), contributions.end(),
                             [](const Contribution& a, const Contribution& b) { return a.pixel < b.pixel; });
        return batches(contributions);
    };
    static const Batches in_order[] = {make(true), make(false)};
    return in_order[static_cast<std::size_t>(order)];
}

struct Layout {
    const char* name;
    Accumulator accumulator;
};
constexpr Layout kLayouts[] = {{"interleaved", Accumulator::OwnedInt64}, {"planar", Accumulator::OwnedPlanarInt64}};

std::string hash_of(const Layout& layout, const Batches& contributions) {
    Framebuffer framebuffer = empty_framebuffer();
    const auto accumulator = make_accumulator<float>(layout.accumulator, framebuffer, 1);
    add_all(*accumulator, contributions, framebuffer.fixed_point(), 0);
    merge_all(*accumulator);
    return framebuffer.hash();
}

void fill_framebuffer(benchmark::State& state, const Layout& layout, Order order) {
    const Batches& contributions = contributions_in(order);
    if (!agree(state, hash_of(layout, contributions) == hash_of(kLayouts[0], contributions_in(Order::Pixels)),
               "the sums differ from the interleaved ones in pixel order"))
        return;
    Framebuffer framebuffer = empty_framebuffer();
    const auto accumulator = make_accumulator<float>(layout.accumulator, framebuffer, 1);
    for (auto _ : state) add_all(*accumulator, contributions, framebuffer.fixed_point(), 0);
    count_rays(state, count_of(contributions), kContributionBytes + kSumBytes);
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
    using namespace raypool;
    if (!begin_benchmarks(argc, argv)) return 2;
    omp_set_dynamic(0);
    for (const Kind& kind : kKinds) {
        for (const Pixels pixels : {Pixels::Own, Pixels::Same}) {
            auto* row = add_row(std::string("accumulate/") + kind.name + (pixels == Pixels::Own ? "/own" : "/same"),
                                [&kind, pixels](benchmark::State& state) { accumulate(state, kind, pixels); });
            row->ArgName("threads")->Arg(1);
            if (pixels == Pixels::Own || kind.may_share) row->Arg(2);
        }
    }
    for (const Layout& layout : kLayouts) {
        for (const Order order : {Order::Pixels, Order::Pool}) {
            add_row(
                std::string("framebuffer/") + layout.name + (order == Order::Pixels ? "/pixel_order" : "/pool_order"),
                [&layout, order](benchmark::State& state) { fill_framebuffer(state, layout, order); });
        }
    }
    benchmark::RunSpecifiedBenchmarks();
}
