/// What the data of the study `replay` say: its tables, findings and pictures.
#pragma once

#include "bench/studies/study.h"

namespace raypool::studies {

/// Ways that findings speak of.
inline constexpr const char* kDefaultPool = "a pool each, balanced (default)";
inline constexpr const char* kThreadPools = "a pool for each thread";  ///< a group of ways

Summary summarise_replay(const Table& data);

}  // namespace raypool::studies
