/// How many lanes of a GPU's warps, and records of its pool, have a path in each round: from the lengths of paths alone,
/// so that no GPU is needed.
///
/// A warp is 32 threads that go through a round together, a segment each, in step with all other warps. What is counted
/// is exact for that; a GPU runs warps in any order, so of the forms whose threads take paths in turn
/// (MegaRegenerate) it is what happens if all are equally fast.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gpu/settings.h"

namespace raypool::studies {

struct GpuRound {
    std::int64_t live = 0;   ///< paths that trace a segment
    std::int64_t lanes = 0;  ///< of the warps that have such a path
};

/// `segments` of each path, none of them 0, in the order in which paths are begun. `room`: threads that the device holds
/// at once (Form::MegaRegenerate), or records of the pool (Form::Wave); Form::Mega has a thread for every path.
std::vector<GpuRound> gpu_rounds(gpu::Form form, std::span<const std::uint32_t> segments, std::int64_t room);

}  // namespace raypool::studies
