/// A device that runs the PTX of the kernels, translated: all of a GPU but its driver and its chip.
#pragma once

#include <array>
#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "gpu/device.h"
#include "tests/gpu/ptx/machine.h"

namespace raypool::gpu {

class PtxDevice : public Device {
  public:
    [[nodiscard]] std::string name() const override { return "translated PTX"; }
    [[nodiscard]] std::size_t free_bytes() const override { return std::size_t{1} << 32; }
    void make_ready(std::span<const Kernel>, std::size_t) override {}
    [[nodiscard]] void* allocate(std::size_t bytes) override { return ::operator new(bytes, std::align_val_t(64)); }
    void release(void* memory) override { ::operator delete(memory, std::align_val_t(64)); }
    void copy_in(void* to, const void* from, std::size_t bytes) override { std::memcpy(to, from, bytes); }
    void copy_out(void* to, const void* from, std::size_t bytes) override { std::memcpy(to, from, bytes); }
    void launch(Kernel kernel, std::size_t features, const Launch& launch, std::int64_t items) override {
        const bool is_single = items == 1;
        void* parameters[] = {const_cast<Launch*>(&launch)};
        ptx::run_grid(ptx::find_kernel(fmt::format("runILm{}ELm{}E", features, static_cast<int>(kernel))), parameters,
                      is_single ? 1 : kBlocks, is_single ? 32 : kThreads);
    }
    [[nodiscard]] double kernel_seconds() override { return 0; }
    void begin_fetch(int place, const Counters* counters) override {
        fetched_[static_cast<std::size_t>(place)] = *counters;
    }
    [[nodiscard]] Counters fetched(int place) override { return fetched_[static_cast<std::size_t>(place)]; }

  private:
    static constexpr std::uint32_t kBlocks = 2;
    static constexpr std::uint32_t kThreads = 64;
    std::array<Counters, 2> fetched_;
};

}  // namespace raypool::gpu
