// Shading alone, on frozen rays that hit something: the scalar kernel in a loop, the same under `omp simd`, and the
// kernel in explicit registers. The three must agree bit by bit.

#include <vector>

#include "bench/bench_support.h"
#include "bench/frozen_rays.h"
#include "bench/shade_loops.h"

namespace raypool {
namespace {

/// The memory behind ShadeColumns: a frozen batch without the rays that miss, repeated to fill it up.
class ShadeBatch {
  public:
    ShadeBatch(const RayKind& kind, std::size_t count) {
        for (auto& column : reals_) column.resize(count);
        for (auto& column : numbers_) column.resize(count);
        ids_.resize(count);
        StageRig<Lanes> rig({}, count);
        const Records& records = frozen_rays(kind, count);
        rig.stages().intersect(records, 0, count);
        std::vector<std::size_t> hits;
        for (std::size_t i = 0; i < count; ++i)
            if (rig.stages().stream().primitive_id()[i] != kNoPrimitive) hits.push_back(i);
        RAYPOOL_CHECK(!hits.empty(), "no ray hits anything");
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t from = hits[i % hits.size()];
            const auto record = records.load<float>(from);
            for (std::size_t k = 0; k < 3; ++k) {
                reals_[k][i] = record.ray.origin[static_cast<int>(k)];
                reals_[3 + k][i] = record.ray.direction[static_cast<int>(k)];
                reals_[6 + k][i] = record.throughput[static_cast<int>(k)];
            }
            reals_[9][i] = record.ray.time;
            reals_[10][i] = rig.stages().stream().distance()[from];
            numbers_[0][i] = record.key.pixel;
            numbers_[1][i] = record.key.sample;
            numbers_[2][i] = record.step;
            ids_[i] = rig.stages().stream().primitive_id()[from];
        }
    }
    [[nodiscard]] std::size_t count() const { return ids_.size(); }

    /// With the results in `out`, ten columns of count() each.
    ShadeColumns columns(std::vector<float>& out) const {
        out.resize(kResults * count());
        const auto in = [&](std::size_t k) { return reals_[k].data(); };
        const auto to = [&](std::size_t k) { return out.data() + k * count(); };
        return {.origin = {in(0), in(1), in(2)},
                .direction = {in(3), in(4), in(5)},
                .time = in(9),
                .throughput = {in(6), in(7), in(8)},
                .pixel = numbers_[0].data(),
                .sample = numbers_[1].data(),
                .step = numbers_[2].data(),
                .distance = in(10),
                .primitive_id = ids_.data(),
                .next_origin = {to(0), to(1), to(2)},
                .next_direction = {to(3), to(4), to(5)},
                .next_throughput = {to(6), to(7), to(8)},
                .is_alive = to(9)};
    }
    static constexpr std::size_t kResults = 10;
    static constexpr std::size_t kBytes = (11 + 3 + 1 + kResults) * sizeof(float);

  private:
    std::vector<float> reals_[11];
    std::vector<std::uint32_t> numbers_[3];
    std::vector<std::int32_t> ids_;
};

using Loop = void (*)(const CompiledScene<float>& scene, const RandomSeed& seed, const ShadeColumns& columns,
                      std::size_t count);

template <class Real>
void shade_loop(const CompiledScene<float>& scene, const RandomSeed& seed, const ShadeColumns& columns,
                std::size_t count) {
    for (std::size_t i = 0; i < count; i += kLanes<Real>) shade_at<Real>(scene, seed, columns, i);
}

void shade(benchmark::State& state, Loop loop, const RayKind& kind, std::size_t count) {
    const FlushDenormals flush;
    const RandomSeed seed = random_seed(0);
    const ShadeBatch batch(kind, count);
    std::vector<float> out;
    std::vector<float> expected;
    shade_loop<float>(paper_scene(), seed, batch.columns(expected), count);
    const ShadeColumns columns = batch.columns(out);
    loop(paper_scene(), seed, columns, count);
    if (!agree(state, same_bits(out.data(), expected.data(), out.size()), "the loop differs from the scalar one"))
        return;
    for (auto _ : state) {
        loop(paper_scene(), seed, columns, count);
        benchmark::ClobberMemory();
    }
    count_rays(state, static_cast<std::int64_t>(count), ShadeBatch::kBytes);
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
    using namespace raypool;
    if (!begin_benchmarks(argc, argv)) return 2;
    const struct {
        const char* name;
        Loop loop;
    } loops[] = {{"scalar", shade_loop<float>}, {"omp_simd", shade_omp_simd}, {"simd", shade_loop<Lanes>}};
    for (const auto& contestant : loops) {
        for_each_frozen_batch([&](const RayKind& kind, std::size_t count, const std::string& batch) {
            add_row(std::string("shade/") + contestant.name + "/" + batch,
                    [=](benchmark::State& state) { shade(state, contestant.loop, kind, count); });
        });
    }
    benchmark::RunSpecifiedBenchmarks();
}
