/// The engines of this program.
#pragma once

#include "core/runtime/registry.h"

namespace raypool::cli {

/// The fastest first.
const EngineRegistry& engines();

}  // namespace raypool::cli
