/// The knobs of the pool. Each is one experiment's axis (docs/pool.md has the measurement behind every default).
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/runtime/engine.h"

namespace raypool::wavefront {

/// Who owns a pool: one for all threads, with a barrier after every round, or one for each.
enum class PoolScope : std::uint8_t { Shared, PerThread };

/// When camera rays enter: once the pool is empty (the paper's), or as soon as there is room.
enum class Refill : std::uint8_t { Drain, Regenerate };

/// How many rays a stage treats at a time.
enum class StageWidth : std::uint8_t { Scalar, Simd };

/// How the closest hits of a batch are found: ray by ray; as a stream, a register of rays against one shape; or as a
/// stream that collects the pairs of rays and spheres which may meet, and tests registers full of them.
enum class Intersection : std::uint8_t { Single, Stream, Pairs };

/// How camera rays enter: written to the pool as they are; or traced and shaded in registers first, survivors only, a
/// register of them at a time or in beams of some registers.
enum class CameraStage : std::uint8_t { Staged, Fused, Beam };

/// Order of the records before they are shaded.
enum class Sort : std::uint8_t { None, Material };

/// How survivors of a shared pool reach the next round: they stay in the batch they were in; they are moved to places
/// taken from one atomic counter; or they are collected by each
/// thread, and moved to places found by a prefix sum over the threads.
enum class Append : std::uint8_t { InPlace, Atomic, PrefixSum };

/// How radiance reaches the framebuffer. The planar ones add to three planes in place of one interleaved framebuffer;
/// AtomicFloat and AtomicDouble round, so their image depends on the order of additions: baselines to measure.
enum class Accumulator : std::uint8_t {
    OwnedInt64,
    AtomicInt64,
    PrivateInt64,
    OwnedPlanarInt64,
    AtomicPlanarInt64,
    AtomicFloat,
    AtomicDouble
};

/// Whether it adds floating-point numbers, so that the image depends on their order.
constexpr bool adds_reals(Accumulator accumulator) {
    return accumulator == Accumulator::AtomicFloat || accumulator == Accumulator::AtomicDouble;
}

/// Whether it needs pixels that belong to one thread, so a per-thread pool.
constexpr bool needs_owned_pixels(Accumulator accumulator) {
    return accumulator == Accumulator::OwnedInt64 || accumulator == Accumulator::OwnedPlanarInt64;
}

struct PoolSettings {
    PoolScope scope = PoolScope::PerThread;
    Refill refill = Refill::Regenerate;
    StageWidth width = StageWidth::Simd;
    Intersection intersection = Intersection::Pairs;
    CameraStage camera = CameraStage::Beam;
    Sort sort = Sort::None;
    Append append = Append::InPlace;
    Accumulator accumulator = Accumulator::OwnedInt64;
    std::int64_t capacity = kAutomatic;  ///< records, of each pool; >= 1, or as capacity.h has it
    std::int64_t batch = 4096;           ///< records that a thread takes at a time from a shared pool
    /// How the batches of a shared pool are handed out. They are few, so that a schedule meant for lines would fit ill.
    LoopSchedule batch_schedule{LoopSchedule::Kind::Dynamic, 0};

    static constexpr std::int64_t kAutomatic = 0;
    /// Of a thread's pool where the trees are small: larger pools were slower (docs/pool.md).
    static constexpr std::int64_t kThreadCapacity = 8192;
    /// Of a shared pool, whose rounds end in barriers.
    static constexpr std::int64_t kSharedCapacity = 65536;
};

/// Records of a shared pool for so many threads: a thread's part of a round must take much longer than a barrier.
constexpr std::int64_t shared_capacity(int threads) {
    constexpr std::int64_t kLeastShare = 16384;
    return std::max(PoolSettings::kSharedCapacity, kLeastShare * threads);
}

/// Records that a thread takes at a time from a shared pool of `capacity`: a thread's part is several batches, so that
/// dear ones even out, and a batch many registers.
constexpr std::int64_t shared_batch(std::int64_t capacity, int threads) {
    constexpr std::int64_t kBatchesAShare = 8;
    constexpr std::int64_t kLeastBatch = 64;
    return std::clamp(capacity / (kBatchesAShare * threads), std::min(kLeastBatch, capacity), PoolSettings{}.batch);
}

/// Whether threads get parts of the image, and not batches of a pool that all share.
constexpr bool loops_over_image(const PoolSettings& pool) {
    return pool.scope == PoolScope::PerThread;
}

}  // namespace raypool::wavefront
