/// What the data of the study `scene-size` say: its tables, findings and pictures.
#pragma once

#include "bench/studies/study.h"

namespace raypool::studies {

/// Ways that are no number of records.
inline constexpr const char* kRecursion = "recursion";
inline constexpr const char* kAutomatic = "automatic";
inline constexpr const char* kCounted = "cache misses";

Summary summarise_scene_size(const Table& data);

}  // namespace raypool::studies
