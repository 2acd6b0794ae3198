/// What the data of the study `scene-size` say: its tables, findings and pictures.
#pragma once

#include "bench/studies/study.h"

namespace raypool::studies {

/// Ways that are no number of records.
inline constexpr const char* kRecursion = "recursion";
inline constexpr const char* kAutomatic = "automatic";
/// Before the name of a way, and a comma: what was counted of it.
inline constexpr const char* kCounted = "cache misses";
inline constexpr const char* kLists = "lists";

Summary summarise_scene_size(const Table& data);

}  // namespace raypool::studies
