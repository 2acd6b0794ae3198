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
    ShadeBatch(const RayKind& kind, std::size_t count) : rays_(count), distance_(count), primitive_id_(count) {
        StageRig<Lanes> rig({}, count);
        const Records& frozen = frozen_rays(kind, count);
        rig.stages().intersect(frozen, 0, count);
        auto& stream = rig.stages().stream();
        std::vector<std::size_t> hits;
        for (std::size_t i = 0; i < count; ++i)
            if (stream.primitive_id()[i] != kNoPrimitive) hits.push_back(i);
        RAYPOOL_CHECK(!hits.empty(), "no ray hits anything");
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t from = hits[i % hits.size()];
            frozen.copy_to(rays_, i, from, 1);
            distance_[i] = stream.distance()[from];
            primitive_id_[i] = stream.primitive_id()[from];
        }
    }
    /// With the results in `results`.
    ShadeColumns columns(std::vector<float>& results) const {
        results.resize(ShadeColumns::kResults * distance_.size());
        return {&rays_, distance_.data(), primitive_id_.data(), results.data(), distance_.size()};
    }

  private:
    Records rays_;
    std::vector<float> distance_;
    std::vector<std::int32_t> primitive_id_;
};

using Loop = void (*)(const CompiledScene<float>& scene, const RandomSeed& seed, const ShadeColumns& columns);

template <class Real>
void shade_loop(const CompiledScene<float>& scene, const RandomSeed& seed, const ShadeColumns& columns) {
    for (std::size_t i = 0; i < columns.count; i += kLanes<Real>) shade_at<Real>(scene, seed, columns, i);
}

void shade(benchmark::State& state, Loop loop, const RayKind& kind, std::size_t count) {
    const FlushDenormals flush;
    const RandomSeed seed = random_seed(0);
    const ShadeBatch batch(kind, count);
    std::vector<float> out;
    std::vector<float> expected;
    shade_loop<float>(paper_scene(), seed, batch.columns(expected));
    const ShadeColumns columns = batch.columns(out);
    loop(paper_scene(), seed, columns);
    if (!agree(state, same_bits(out.data(), expected.data(), out.size()), "the loop differs from the scalar one"))
        return;
    for (auto _ : state) {
        loop(paper_scene(), seed, columns);
        benchmark::ClobberMemory();
    }
    constexpr std::size_t kHitAndResults = (2 + ShadeColumns::kResults) * sizeof(float);
    count_rays(state, static_cast<std::int64_t>(count), record_bytes<kPaper, float>() + kHitAndResults);
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
