/// What it costs to move ray records, by a measurement of its own: within a stage no clock can tell it from shading.
#pragma once

#include <cstdint>

#include "core/scene/features.h"
#include "wavefront/settings.h"

namespace raypool::studies {

/// Seconds for each record of a pool of `capacity`, when all are loaded and a part of them, `survivors` in [0, 1], is
/// stored at the front of the pool, as the shade stage does, and nothing is computed. One thread; median of a few
/// passes.
double record_pass_s(Features features, wavefront::StageWidth width, std::int64_t capacity, double survivors);

}  // namespace raypool::studies
