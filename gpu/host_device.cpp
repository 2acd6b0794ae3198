#include "gpu/host_device.h"

#include <array>
#include <cstring>
#include <new>

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/math/flush_denormals.h"

namespace raypool::gpu {

namespace {

using Body = void (*)(const Launch&, const HostThread&);

template <std::size_t features, std::size_t kernel>
void body(const Launch& launch, const HostThread& thread) {
    run_kernel<static_cast<Kernel>(kernel), kCompiledFeatures[kFirstFeatures + features]>(launch, thread);
}

template <std::size_t features, std::size_t... kernels>
constexpr std::array<Body, kKernelCount> bodies_of(std::index_sequence<kernels...>) {
    return {&body<features, kernels>...};
}
template <std::size_t... features>
constexpr std::array<std::array<Body, kKernelCount>, kFeatureSets> all_bodies(std::index_sequence<features...>) {
    return {bodies_of<features>(std::make_index_sequence<kKernelCount>())...};
}
constexpr auto kBodies = all_bodies(std::make_index_sequence<kFeatureSets>());

class HostDevice : public Device {
  public:
    explicit HostDevice(int threads) : threads_(threads) {}

    [[nodiscard]] std::string name() const override { return "the host"; }
    [[nodiscard]] std::size_t free_bytes() const override { return available_memory(); }
    void make_ready(std::span<const Kernel>, std::size_t) override {}
    [[nodiscard]] void* allocate(std::size_t bytes) override { return ::operator new(bytes, kAlign); }
    void release(void* memory) override { ::operator delete(memory, kAlign); }
    void copy_in(void* to, const void* from, std::size_t bytes) override { std::memcpy(to, from, bytes); }
    void copy_out(void* to, const void* from, std::size_t bytes) override { std::memcpy(to, from, bytes); }

    void launch(Kernel kernel, std::size_t features, const Launch& launch, std::int64_t) override {
        const double begin = wall_seconds();
        const Body run = kBodies[features][static_cast<std::size_t>(kernel)];
#pragma omp parallel num_threads(threads_)
        {
            const FlushDenormals flush;
#pragma omp for schedule(static)
            for (int i = 0; i < kShares * threads_; ++i) run(launch, {i, std::int64_t{kShares} * threads_});
        }
        seconds_ += wall_seconds() - begin;
    }
    [[nodiscard]] double kernel_seconds() override {
        return std::exchange(seconds_, 0);
    }

    void begin_fetch(int place, const Counters* counters) override {
        fetched_[place] = *counters;
    }
    [[nodiscard]] Counters fetched(int place) override {
        return fetched_[place];
    }

  private:
    static constexpr std::align_val_t kAlign{64};
    static constexpr int kShares = 32;  ///< of a kernel's work, for each thread

    int threads_;
    double seconds_ = 0;
    std::array<Counters, 2> fetched_;
};

}  // namespace

std::unique_ptr<Device> host_device(int threads) {
    return std::make_unique<HostDevice>(threads);
}

}  // namespace raypool::gpu
