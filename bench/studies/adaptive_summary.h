/// What the rows of the study of adaptive sampling say. Called by adaptive.cpp.
#pragma once

#include "bench/studies/study.h"

namespace raypool::studies {

Summary summarise_adaptive(const Table& data);

}  // namespace raypool::studies
