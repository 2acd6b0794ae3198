/// What the data of the study `pool` say: its tables, findings and pictures.
#pragma once

#include "bench/studies/study.h"

namespace raypool::studies {

/// Pools that findings speak of.
inline constexpr const char* kPaperPool = "the paper's pool";
inline constexpr const char* kWidePool = "shared, drain";
inline constexpr const char* kFastestPool = "thread, regenerate, beam";

Summary summarise_pool(const Table& data);

}  // namespace raypool::studies
