/// What processor_check.cpp asks of the processor before the command begins.
#pragma once

namespace raypool::cli {

struct NeededInstructionSets {
    const char* const* begin;
    const char* const* end;
};
/// kInstructionSets (core/math/processor.h) of what the command is compiled for. Defined in main.cpp, which is compiled
/// as all the rest is.
extern const NeededInstructionSets kNeededInstructionSets;

}  // namespace raypool::cli
