#include "gpu/cuda_device.h"

#include <cuda_runtime_api.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "core/base/error.h"
#include "gpu/device_kernels.h"

namespace raypool::gpu {

namespace {

void check(cudaError_t status, const char* what) {
    if (status == cudaSuccess) return;
    throw std::runtime_error(fmt::format("--engine gpu: {}: {}", what, cudaGetErrorString(status)));
}

int device_count() {
    int count = 0;
    const cudaError_t status = cudaGetDeviceCount(&count);
    if (status == cudaErrorInsufficientDriver || status == cudaErrorStubLibrary)
        throw InputError("--engine gpu: no NVIDIA driver here, or one that is older than this program's CUDA");
    if (status == cudaErrorNoDevice || (status == cudaSuccess && count == 0))
        throw InputError("--engine gpu: no NVIDIA GPU here");
    check(status, "cannot count the devices");
    return count;
}

/// Of this process among those that a launcher started on this machine.
int local_rank() {
    for (const char* name : {"OMPI_COMM_WORLD_LOCAL_RANK", "MPI_LOCALRANKID", "SLURM_LOCALID"})
        if (const char* value = std::getenv(name)) return std::atoi(value);
    return 0;
}

class CudaDevice : public Device {
  public:
    CudaDevice() {
        const int device = local_rank() % device_count();
        check(cudaSetDevice(device), "cannot take the device");
        cudaDeviceProp properties{};
        check(cudaGetDeviceProperties(&properties, device), "cannot ask the device");
        name_ = properties.name;
        processors_ = properties.multiProcessorCount;
        check(cudaEventCreate(&begin_), "no event");
        check(cudaEventCreate(&end_), "no event");
        for (Fetch& fetch : fetches_) {
            check(cudaEventCreateWithFlags(&fetch.is_here, cudaEventDisableTiming), "no event");
            void* memory = nullptr;
            check(cudaMallocHost(&memory, sizeof(Counters)), "no memory of the host for its counters");
            fetch.counters = static_cast<Counters*>(memory);
        }
    }
    ~CudaDevice() override {
        for (Fetch& fetch : fetches_) {
            cudaFreeHost(fetch.counters);
            cudaEventDestroy(fetch.is_here);
        }
        cudaEventDestroy(begin_);
        cudaEventDestroy(end_);
    }

    [[nodiscard]] std::string name() const override { return name_; }
    [[nodiscard]] std::size_t free_bytes() const override {
        std::size_t free = 0;
        std::size_t total = 0;
        check(cudaMemGetInfo(&free, &total), "cannot ask for the free memory");
        return free;
    }
    /// A launch without work: no path is left, no record lives.
    void make_ready(std::span<const Kernel> kernels, std::size_t features) override {
        Counters* counters = nullptr;
        check(cudaMalloc(reinterpret_cast<void**>(&counters), sizeof(Counters)), "cannot take memory");
        check(cudaMemset(counters, 0, sizeof(Counters)), "cannot clear memory");
        Launch nothing;
        nothing.counters = counters;
        for (const Kernel kernel : kernels) launch(kernel, features, nothing, 0);
        (void)kernel_seconds();
        check(cudaFree(counters), "cannot release memory");
    }
    [[nodiscard]] void* allocate(std::size_t bytes) override {
        void* memory = nullptr;
        check(cudaMalloc(&memory, bytes), "cannot take memory");
        return memory;
    }
    void release(void* memory) override { cudaFree(memory); }
    void copy_in(void* to, const void* from, std::size_t bytes) override {
        check(cudaMemcpy(to, from, bytes, cudaMemcpyHostToDevice), "cannot copy to the device");
    }
    void copy_out(void* to, const void* from, std::size_t bytes) override {
        check(cudaMemcpy(to, from, bytes, cudaMemcpyDeviceToHost), "a kernel, or the copy of what it made");
    }

    void launch(Kernel kernel, std::size_t features, const Launch& launch, std::int64_t items) override {
        const void* code = device_kernel(kernel, features);
        const unsigned block_count = blocks(kernel, features, items);
        if (!is_timed_) check(cudaEventRecord(begin_), "cannot begin");
        is_timed_ = true;
        std::array<void*, 1> arguments{const_cast<Launch*>(&launch)};
        check(cudaLaunchKernel(code, dim3(block_count), dim3(kBlockThreads), arguments.data(), 0, nullptr),
              "cannot launch a kernel");
    }
    [[nodiscard]] double kernel_seconds() override {
        if (!is_timed_) return 0;
        is_timed_ = false;
        check(cudaEventRecord(end_), "cannot end");
        check(cudaEventSynchronize(end_), "a kernel");
        float milliseconds = 0;
        check(cudaEventElapsedTime(&milliseconds, begin_, end_), "cannot tell the time");
        return 1e-3 * double{milliseconds};
    }

    void begin_fetch(int place, const Counters* counters) override {
        Fetch& fetch = fetches_[static_cast<std::size_t>(place)];
        check(cudaMemcpyAsync(fetch.counters, counters, sizeof(Counters), cudaMemcpyDeviceToHost), "cannot fetch");
        check(cudaEventRecord(fetch.is_here), "cannot fetch");
    }
    [[nodiscard]] Counters fetched(int place) override {
        const Fetch& fetch = fetches_[static_cast<std::size_t>(place)];
        check(cudaEventSynchronize(fetch.is_here), "a kernel");
        return *fetch.counters;
    }

  private:
    struct Fetch {
        cudaEvent_t is_here = nullptr;
        Counters* counters = nullptr;  ///< in memory that the device can copy to by itself
    };

    /// As many blocks as the items fill, or as the device holds at a time.
    unsigned blocks(Kernel kernel, std::size_t features, std::int64_t items) {
        if (items > 0) {
            constexpr std::int64_t kMostBlocks = (std::int64_t{1} << 31) - 1;
            return static_cast<unsigned>(std::min((items + kBlockThreads - 1) / kBlockThreads, kMostBlocks));
        }
        int& held = held_[features][static_cast<std::size_t>(kernel)];
        if (held == 0) {
            check(
                cudaOccupancyMaxActiveBlocksPerMultiprocessor(&held, device_kernel(kernel, features), kBlockThreads, 0),
                "cannot ask what the device holds");
            held = std::max(1, held) * processors_;
        }
        return static_cast<unsigned>(held);
    }

    std::string name_;
    int processors_ = 1;
    cudaEvent_t begin_ = nullptr;
    cudaEvent_t end_ = nullptr;
    bool is_timed_ = false;
    std::array<Fetch, 2> fetches_;
    std::array<std::array<int, kKernelCount>, kFeatureSets> held_{};  ///< blocks; 0: not asked yet
};

}  // namespace

bool has_cuda_device() {
    int count = 0;
    return cudaGetDeviceCount(&count) == cudaSuccess && count > 0;
}

std::unique_ptr<Device> cuda_device() {
    return std::make_unique<CudaDevice>();
}

}  // namespace raypool::gpu
