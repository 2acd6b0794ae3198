/// What the source knows of processors, beside the instructions on their registers (simd_*.h): how wide a register is,
/// the modes of floating-point arithmetic, where the stack is, and the names of what code is compiled for.
#pragma once

#include <cstdint>
#if defined(__x86_64__)
#include <xmmintrin.h>
#elif !defined(__aarch64__)
#error "raypool knows x86-64 with AVX2 and FMA, and 64-bit ARM"
#endif

namespace raypool {

#if defined(__x86_64__)

/// Of the registers that code is compiled for.
#ifdef __AVX512F__
inline constexpr int kRegisterBytes = 64;
inline constexpr bool kIsKnownToValgrind = false;
#else
inline constexpr int kRegisterBytes = 32;
inline constexpr bool kIsKnownToValgrind = true;
#endif

namespace detail {
/// MXCSR holds modes, and below them what has happened since it was cleared.
inline constexpr std::uint32_t kHappened = 0x3f;
}  // namespace detail

/// The calling thread's modes of floating-point arithmetic, as the processor keeps them.
inline std::uint64_t floating_point_modes() {
    return _mm_getcsr() & ~detail::kHappened;
}
inline void set_floating_point_modes(std::uint64_t modes) {
    _mm_setcsr(static_cast<std::uint32_t>(modes) | (_mm_getcsr() & detail::kHappened));
}
/// Denormal numbers are zero where these are set: as results (FZ) and as operands (DAZ).
inline constexpr std::uint64_t kFlushDenormals = 0x8000 | 0x0040;
/// Whether a result is taken for denormal by its exact value, or by that rounded to 24 bits: where one is a little
/// below 2^-126 it is flushed, or is 2^-126.
inline constexpr bool kJudgesBeforeRounding = false;

/// The calling thread's stack pointer. Stacks grow downward.
[[gnu::always_inline]] inline std::uintptr_t stack_pointer() {
    std::uintptr_t pointer;
    __asm__ volatile("mov %%rsp, %0" : "=r"(pointer));
    return pointer;
}

/// As gcc names them, and those of ARM as Linux does, from the oldest on.
inline constexpr const char* kInstructionSets[] = {
    "sse2",
#ifdef __SSE3__
    "sse3",
#endif
#ifdef __SSSE3__
    "ssse3",
#endif
#ifdef __SSE4_1__
    "sse4.1",
#endif
#ifdef __SSE4_2__
    "sse4.2",
#endif
#ifdef __AVX__
    "avx",
#endif
#ifdef __F16C__
    "f16c",
#endif
#ifdef __FMA__
    "fma",
#endif
#ifdef __AVX2__
    "avx2",
#endif
#ifdef __AVX512F__
    "avx512f",
#endif
#ifdef __AVX512CD__
    "avx512cd",
#endif
#ifdef __AVX512BW__
    "avx512bw",
#endif
#ifdef __AVX512DQ__
    "avx512dq",
#endif
#ifdef __AVX512VL__
    "avx512vl",
#endif
};

#else                     // aarch64

inline constexpr int kRegisterBytes = 16;
#ifdef __ARM_FEATURE_SVE  // which a compiler may use for loops of its own
inline constexpr bool kIsKnownToValgrind = false;
#else
inline constexpr bool kIsKnownToValgrind = true;
#endif

inline std::uint64_t floating_point_modes() {
    std::uint64_t modes;
    __asm__ volatile("mrs %0, fpcr" : "=r"(modes));
    return modes;
}
inline void set_floating_point_modes(std::uint64_t modes) {
    __asm__ volatile("msr fpcr, %0" : : "r"(modes) : "memory");
}
inline constexpr std::uint64_t kFlushDenormals = 1U << 24U;  // FZ: results and operands
inline constexpr bool kJudgesBeforeRounding = true;

[[gnu::always_inline]] inline std::uintptr_t stack_pointer() {
    std::uintptr_t pointer;
    __asm__ volatile("mov %0, sp" : "=r"(pointer));
    return pointer;
}

inline constexpr const char* kInstructionSets[] = {
    "asimd",
#ifdef __ARM_FEATURE_DOTPROD
    "asimddp",
#endif
#ifdef __ARM_FEATURE_FP16_VECTOR_ARITHMETIC
    "asimdhp",
#endif
#ifdef __ARM_FEATURE_SVE
    "sve",
#endif
#ifdef __ARM_FEATURE_SVE2
    "sve2",
#endif
};

#endif

}  // namespace raypool
