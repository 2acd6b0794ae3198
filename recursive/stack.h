/// How much stack a thread has left: what decides how deep a recursion it can hold.
#pragma once

#include <cstddef>
#include <cstdint>

namespace raypool::recursive {

/// The calling thread's stack pointer. Stacks grow downward.
[[gnu::always_inline]] inline std::uintptr_t stack_pointer() {
    std::uintptr_t pointer;
    __asm__ volatile("mov %%rsp, %0" : "=r"(pointer));
    return pointer;
}

/// Bytes between the calling thread's stack pointer and the end of its stack.
std::size_t stack_bytes_left();

}  // namespace raypool::recursive
