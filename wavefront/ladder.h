/// The ladder from the paper's pool to the fastest: each rung differs from the one before in one named thing.
///
/// The rungs before these are the recursive and the iterative engine. `raypool compare`, the benchmarks and the
/// equivalence tests all climb this list.
#pragma once

#include <vector>

#include "wavefront/settings.h"

namespace raypool::wavefront {

struct Rung {
    const char* name;
    const char* step;  ///< what is different from the rung before
    PoolSettings pool;
};

/// For `threads` threads, which share out the rays of the shared pool when it is cut into one for each.
inline std::vector<Rung> ladder(int threads) {
    std::vector<Rung> rungs;
    PoolSettings pool{.scope = PoolScope::Shared,
                      .refill = Refill::Drain,
                      .width = StageWidth::Scalar,
                      .intersection = Intersection::Single,
                      .camera = CameraStage::Staged,
                      .sort = Sort::None,
                      .append = Append::InPlace,
                      .accumulator = Accumulator::AtomicInt64,
                      .capacity = PoolSettings::kSharedCapacity};
    const auto add = [&](const char* name, const char* step) { rungs.push_back({name, step, pool}); };
    add("shared", "a shared pool and rounds in place of the loop over bounces");
    pool.width = StageWidth::Simd;
    add("shared-simd", "stages treat a register of rays at a time");
    pool.intersection = Intersection::Stream;
    add("shared-stream", "streams instead of single rays against the tree");
    pool.scope = PoolScope::PerThread;
    pool.accumulator = Accumulator::OwnedInt64;
    pool.capacity = PoolSettings::kSharedCapacity / threads;
    add("thread", "a pool for each thread, which then owns its pixels");
    pool.capacity = PoolSettings::kThreadCapacity;
    add("thread-small", "a smaller pool, of 8192 records");
    pool.refill = Refill::Regenerate;
    add("regenerate", "camera rays enter as soon as there is room");
    pool.camera = CameraStage::Fused;
    add("fused", "camera rays do their first bounce in registers");
    pool.intersection = Intersection::Pairs;
    add("pairs", "of spheres and rays, those that may meet are tested in full registers");
    pool.camera = CameraStage::Beam;
    add("beam", "64 camera rays go down the tree as one");
    pool.sort = Sort::Material;
    add("sorted", "records are sorted by material before they are shaded");
    return rungs;
}

}  // namespace raypool::wavefront
