#include "bench/shade_loops.h"

namespace raypool {

void shade_omp_simd(const CompiledScene<float>& scene, const RandomSeed& seed, const ShadeColumns& columns,
                    std::size_t count) {
    const ShadeColumns local = columns;
#pragma omp simd
    for (std::size_t i = 0; i < count; ++i) shade_at<float>(scene, seed, local, i);
}

}  // namespace raypool
