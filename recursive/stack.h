/// How much stack a thread has left: what decides how deep a recursion it can hold.
#pragma once

#include <cstddef>

namespace raypool::recursive {

/// Bytes between the calling thread's stack pointer and the end of its stack.
std::size_t stack_bytes_left();

}  // namespace raypool::recursive
