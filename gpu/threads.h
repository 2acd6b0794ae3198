/// The threads that run a kernel's body: on the host one after the other or side by side, on a GPU in warps.
///
/// A body is written for either. It asks for its share of the work (for_each), and lets threads count together; what is
/// said to be for all threads of a warp must be called by all of them at once.
#pragma once

#include <atomic>
#include <cstdint>

#include "core/math/platform.h"

namespace raypool::gpu {

/// A thread of the host, which is a warp of its own.
struct HostThread {
    static constexpr std::int64_t kWarp = 1;
    std::int64_t index = 0;
    std::int64_t count = 1;

    /// Adds, and returns what was there.
    template <class T>
    T add(T* to, T value) const {
        return std::atomic_ref(*to).fetch_add(value, std::memory_order_relaxed);
    }
    /// For all threads of a warp: a place of its own for each that wants one, by one addition to the counter.
    template <class T>
    T append(T* counter, bool is_wanted) const {
        return is_wanted ? add(counter, T(1)) : T(0);
    }
    /// For all threads of a warp: whether it is so for any of them.
    [[nodiscard]] bool any(bool is_so) const { return is_so; }
    /// For all threads of a warp: adds what all of them bring, at once.
    void add_all(std::uint64_t* to, std::uint64_t value) const {
        if (value != 0) add(to, value);
    }
};

#ifdef __CUDACC__
/// A thread of a GPU.
struct DeviceThread {
    static constexpr std::int64_t kWarp = 32;
    std::int64_t index;
    std::int64_t count;  ///< a multiple of a warp

    __device__ DeviceThread()
        : index(std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x), count(std::int64_t{gridDim.x} * blockDim.x) {}

    __device__ double add(double* to, double value) const { return atomicAdd(to, value); }
    __device__ std::uint32_t add(std::uint32_t* to, std::uint32_t value) const { return atomicAdd(to, value); }
    template <class T>
    __device__ T add(T* to, T value) const {
        static_assert(sizeof(T) == sizeof(unsigned long long));
        return static_cast<T>(
            atomicAdd(reinterpret_cast<unsigned long long*>(to), static_cast<unsigned long long>(value)));
    }
    template <class T>
    __device__ T append(T* counter, bool is_wanted) const {
        const unsigned wanted = __ballot_sync(kAll, is_wanted);
        if (wanted == 0) return 0;
        const unsigned lane = threadIdx.x % kWarp;
        const int leader = __ffs(static_cast<int>(wanted)) - 1;
        T first = 0;
        if (lane == static_cast<unsigned>(leader)) first = add(counter, static_cast<T>(__popc(wanted)));
        first = __shfl_sync(kAll, first, leader);
        return first + static_cast<T>(__popc(wanted & ((1U << lane) - 1)));
    }
    [[nodiscard]] __device__ bool any(bool is_so) const { return __any_sync(kAll, is_so) != 0; }
    __device__ void add_all(std::uint64_t* to, std::uint64_t value) const {
        for (int apart = kWarp / 2; apart > 0; apart /= 2) value += __shfl_xor_sync(kAll, value, apart);
        if (threadIdx.x % kWarp == 0 && value != 0) add(to, value);
    }

  private:
    static constexpr unsigned kAll = 0xffffffffU;
};
#endif

/// Calls visit(i, is_there) so that each i below n is there in one thread; threads of a warp stay together.
template <class Thread, class Visit>
RAYPOOL_INLINE void for_each(const Thread& thread, std::int64_t n, Visit visit) {
    const std::int64_t end = (n + Thread::kWarp - 1) / Thread::kWarp * Thread::kWarp;
    for (std::int64_t i = thread.index; i < end; i += thread.count) visit(i, i < n);
}

}  // namespace raypool::gpu
