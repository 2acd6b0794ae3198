// The operations that kernels are made of, on a GPU.

#include "tests/core/math/operations.h"

namespace raypool::gpu {

/// Of pairs first, first + 1, ...: kOperations numbers each.
__global__ void run_operations(std::uint32_t first, std::uint32_t count, std::uint32_t* out) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) return;
    float a;
    float b;
    pair_of(first + i, a, b);
    std::uint32_t bits[kOperations];
    operate(a, b, bits);
    for (int k = 0; k < kOperations; ++k) out[i * kOperations + k] = bits[k];
}

/// For a test of the GPU: out is in its memory.
int launch_operations(std::uint32_t first, std::uint32_t count, std::uint32_t* out) {
    run_operations<<<(count + 127) / 128, 128>>>(first, count, out);
    return cudaDeviceSynchronize();
}

}  // namespace raypool::gpu
