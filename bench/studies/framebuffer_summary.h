/// What the data of the study `framebuffer` say: its tables, findings and picture.
#pragma once

#include "bench/studies/study.h"

namespace raypool::studies {

inline constexpr const char* kInterleaved = "interleaved";
inline constexpr const char* kPlanar = "planar";
/// The pool that the paper's claims are held against.
inline constexpr const char* kSharedPool = "the paper's pool, shared";

Summary summarise_framebuffer(const Table& data);

}  // namespace raypool::studies
