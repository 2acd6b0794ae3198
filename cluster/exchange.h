/// What ranks tell each other of a render: sums, what a checkpoint holds, and what each of them did. All of it is
/// collective but clear().
#pragma once

#include <cstdint>
#include <vector>

#include "cluster/ranks.h"
#include "core/film/checkpoint.h"
#include "core/runtime/engine.h"

namespace raypool::cluster {

/// Rank 0's framebuffer becomes the sum of all, and those of the others zero: what is added later is added once.
/// Nothing to do for one with second moments (rank_engine.h).
void gather(Ranks& ranks, Framebuffer& framebuffer);

/// Sets chosen pixels to zero.
void clear(Framebuffer& framebuffer, const std::vector<std::uint32_t>& pixels);
/// Everybody's chosen pixels, the same on all ranks, become the sum of all.
void sum_everywhere(Ranks& ranks, Framebuffer& framebuffer, const std::vector<std::uint32_t>& pixels);

/// Tells what rank 0 has read from a checkpoint: all but the sums, which one rank must hold and no other, unless they
/// have second moments.
void broadcast(Ranks& ranks, Checkpoint& sums);

/// What each rank did, at rank 0; nothing elsewhere. Without rounds.
std::vector<RenderReport> gather(Ranks& ranks, const RenderReport& own);

/// The reports of all ranks as one: the threads of each, one rank behind the other, which wait for each other.
RenderReport joined(const std::vector<RenderReport>& ranks);

}  // namespace raypool::cluster
