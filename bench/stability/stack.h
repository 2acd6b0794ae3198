/// What becomes of a process that traces one endless path by recursion: for row 5a.
#pragma once

#include <cstdint>

namespace raypool::stability {

enum class Deep : std::uint8_t {
    Recursion,  ///< the recursive tracer, without the check that the stack holds it
    Checked,    ///< the recursive engine, which refuses what the stack cannot hold
    Loop        ///< the iterative engine
};

/// Whether a process of its own, on a stack of 8 MB, ends by itself: it renders one pixel from within a closed white
/// sphere to that depth, or refuses to. It is killed by its stack otherwise.
bool survives(Deep how, std::int64_t depth);

}  // namespace raypool::stability
