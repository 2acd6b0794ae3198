/// The kernels that nvcc compiled, for its runtime.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "gpu/device.h"

namespace raypool::gpu {

inline constexpr int kBlockThreads = 128;

/// For cudaLaunchKernel(): its argument is a Launch.
const void* device_kernel(Kernel kernel, std::size_t features);

}  // namespace raypool::gpu
