// What compilers make of the loop: clang++ 14 turned it into registers of 16, with every branch a mask and the rows of
// surfaces gathered, until shading learnt of Sobol samples, a call that it cannot mask; now it says so (-Wpass-failed)
// and leaves the loop scalar. So does g++ 12: it wants the loops over the terms of a sine unrolled first, and then does
// not turn glass, metal and checkers ("control flow in loop") into masks.
#include "bench/shade_loops.h"

namespace raypool {

void shade_omp_simd(const CompiledScene<float>& scene, const RandomSeed& seed, const ShadeColumns& columns) {
    const ShadeColumns local = columns;  // so that no store can change the pointers
#pragma omp simd
    for (std::size_t i = 0; i < local.count; ++i) shade_at<float>(scene, seed, local, i);
}

}  // namespace raypool
