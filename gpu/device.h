/// What the engine asks of a device: memory, copies, kernels. Launches are in order, and need not have ended when
/// launch() returns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "gpu/kernels.h"

namespace raypool::gpu {

/// Kernels are compiled for the sets of kCompiledFeatures from this one on.
inline constexpr std::size_t kFirstFeatures = kFirstCompiledFeatures<float> < 1 ? 1 : kFirstCompiledFeatures<float>;
inline constexpr std::size_t kFeatureSets = kCompiledFeatures.size() - kFirstFeatures;

/// Not synchronised.
class Device {
  public:
    Device() = default;
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    virtual ~Device() = default;

    [[nodiscard]] virtual std::string name() const = 0;
    /// Of its memory.
    [[nodiscard]] virtual std::size_t free_bytes() const = 0;

    /// Loads kernels of a feature set, with what memory they take for themselves, so that no launch is the first.
    virtual void make_ready(std::span<const Kernel> kernels, std::size_t features) = 0;

    /// Throws where there is not as much.
    [[nodiscard]] virtual void* allocate(std::size_t bytes) = 0;
    virtual void release(void* memory) = 0;
    virtual void copy_in(void* to, const void* from, std::size_t bytes) = 0;
    /// Waits for all that was launched.
    virtual void copy_out(void* to, const void* from, std::size_t bytes) = 0;

    /// Runs a kernel of feature set kFirstFeatures + features. As many threads as `items` where each is to take one;
    /// 0: as many as the device holds.
    virtual void launch(Kernel kernel, std::size_t features, const Launch& launch, std::int64_t items) = 0;
    /// Seconds that kernels took since the last call. Waits for all that was launched.
    [[nodiscard]] virtual double kernel_seconds() = 0;

    /// Begins to fetch the counters of what was launched so far, into one of two places; and waits for them.
    virtual void begin_fetch(int place, const Counters* counters) = 0;
    [[nodiscard]] virtual Counters fetched(int place) = 0;
};

/// Memory of a device. `T` is moved bit by bit.
template <class T>
class DeviceArray {
  public:
    DeviceArray() = default;
    DeviceArray(Device& device, std::size_t count)
        : device_(&device), count_(count), data_(count == 0 ? nullptr : device.allocate(count * sizeof(T))) {}
    DeviceArray(Device& device, std::span<const T> from) : DeviceArray(device, from.size()) { copy_in(from); }
    DeviceArray(DeviceArray&& other) noexcept
        : device_(other.device_), count_(std::exchange(other.count_, 0)), data_(std::exchange(other.data_, nullptr)) {}
    DeviceArray& operator=(DeviceArray&& other) noexcept {
        std::swap(device_, other.device_);
        std::swap(count_, other.count_);
        std::swap(data_, other.data_);
        return *this;
    }
    ~DeviceArray() {
        if (data_ != nullptr) device_->release(data_);
    }

    [[nodiscard]] T* data() const { return static_cast<T*>(data_); }
    [[nodiscard]] std::size_t size() const { return count_; }
    void copy_in(std::span<const T> from) {
        if (!from.empty()) device_->copy_in(data_, from.data(), from.size_bytes());
    }
    void copy_out(std::span<T> to) const {
        if (!to.empty()) device_->copy_out(to.data(), data_, to.size_bytes());
    }

  private:
    Device* device_ = nullptr;
    std::size_t count_ = 0;
    void* data_ = nullptr;
};

}  // namespace raypool::gpu
