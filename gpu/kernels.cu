// All kernels, compiled for a GPU.

#include "gpu/device_kernels.h"

namespace raypool::gpu {

namespace {

template <std::size_t features, std::size_t kernel>
__global__ void __launch_bounds__(kBlockThreads) run(const __grid_constant__ Launch launch) {
    run_kernel<static_cast<Kernel>(kernel), kCompiledFeatures[kFirstFeatures + features]>(launch, DeviceThread());
}

/// Apart, since nvcc does not expand a pack within the name of a kernel.
template <std::size_t features, std::size_t kernel>
const void* address() {
    return reinterpret_cast<const void*>(&run<features, kernel>);
}
template <std::size_t features, std::size_t... kernels>
std::array<const void*, kKernelCount> addresses(std::index_sequence<kernels...>) {
    return {address<features, kernels>()...};
}
template <std::size_t... sets>
std::array<std::array<const void*, kKernelCount>, kFeatureSets> all_addresses(std::index_sequence<sets...>) {
    return {addresses<sets>(std::make_index_sequence<kKernelCount>())...};
}

}  // namespace

const void* device_kernel(Kernel kernel, std::size_t features) {
    static const auto kAll = all_addresses(std::make_index_sequence<kFeatureSets>());
    return kAll[features][static_cast<std::size_t>(kernel)];
}

}  // namespace raypool::gpu
