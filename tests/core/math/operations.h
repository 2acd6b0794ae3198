/// The operations that kernels are made of, on two numbers: what every processor must do alike, bit by bit.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/math/real.h"

namespace raypool {

inline constexpr int kOperations = 20;
inline constexpr int kRoundedOperations = 8;  ///< the first of them
inline constexpr const char* kOperationNames[kOperations] = {"a + b",
                                                             "a - b",
                                                             "a * b",
                                                             "a / b",
                                                             "mad(a, b, a)",
                                                             "nmad(a, b, b)",
                                                             "sqrt(a)",
                                                             "1 / a",
                                                             "floor(a)",
                                                             "min(a, b)",
                                                             "max(a, b)",
                                                             "abs(a)",
                                                             "-a",
                                                             "copysign(a, b)",
                                                             "comparisons",
                                                             "to_int(a)",
                                                             "b * to_real",
                                                             "from_uint32",
                                                             "a in fixed point",
                                                             "select(a < b, -a, b)"};

/// A denormal number and the zero of its sign are one: what is computed with either is the same.
RAYPOOL_INLINE std::uint32_t flushed_bits(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return (bits & 0x7f800000U) == 0 ? bits & 0x80000000U : bits;
}
/// NaNs are one.
RAYPOOL_INLINE std::uint32_t result_bits(float value) {
    const std::uint32_t bits = flushed_bits(value);
    return (bits & 0x7fffffffU) > 0x7f800000U ? 0x7fc00000U : bits;
}

/// Whether one is the least normal number and the other the zero of its sign: of what is less by up to half a step of
/// denormal numbers, 2^-150, processors make one or the other (docs/architecture.md, "One image"; docs/gpu.md).
RAYPOOL_INLINE bool is_rounding_to_normal(std::uint32_t a, std::uint32_t b) {
    constexpr std::uint32_t kLeastNormal = 0x00800000U;
    return (a ^ b) == kLeastNormal && ((a | b) & 0x7fffffffU) == kLeastNormal;
}

/// As kernels do: numbers are within range before they are made whole.
RAYPOOL_INLINE void operate(float a, float b, std::uint32_t (&out)[kOperations]) {
    int i = 0;
    const auto put = [&](float value) { out[i++] = result_bits(value); };
    put(a + b);
    put(a - b);
    put(a * b);
    put(a / b);
    put(mad<float>(a, b, a));
    put(nmad<float>(a, b, b));
    put(sqrt(a));
    put(1.0F / a);
    put(floor(a));
    put(min(a, b));
    put(max(a, b));
    put(abs(a));
    put(-a);
    put(copysign(a, b));
    out[i++] = (a < b ? 1U : 0U) | (a <= b ? 2U : 0U) | (a == b ? 4U : 0U) | (a != b ? 8U : 0U) | (!(a > b) ? 16U : 0U);
    const float clamped = max(min(a, 2147483520.0F), -2147483648.0F);
    const Int<float> whole = to_int<float>(clamped);
    out[i++] = static_cast<std::uint32_t>(whole);
    put(b * to_real<float>(whole));
    put(from_uint32<float>(std::bit_cast<std::uint32_t>(a) >> 1U));
    const double wide = static_cast<double>(max(min(a, 1e6F), 0.0F));
    const auto fixed = static_cast<std::uint64_t>(std::llrint(wide * 0x1p38));
    out[i++] = static_cast<std::uint32_t>(fixed ^ fixed >> 32U);
    put(select(a < b, -a, b));
}

/// Pairs of every kind of number beside every other: zeros, denormal numbers, the least normal one and its neighbours,
/// halves, whole numbers at the ends of what fits, infinities and NaN, of either sign; and behind these, numbers of
/// random bits.
RAYPOOL_INLINE std::uint32_t boundary(std::uint32_t i) {
    constexpr std::uint32_t kBits[32] = {
        0x00000000U, 0x00000001U, 0x007fffffU, 0x00400000U, 0x00800000U, 0x00800001U, 0x00ffffffU, 0x01000000U,
        0x3effffffU, 0x3f000000U, 0x3f000001U, 0x3f7fffffU, 0x3f800000U, 0x3f800001U, 0x3fc00000U, 0x40000000U,
        0x40200000U, 0x4affffffU, 0x4b000000U, 0x4b000001U, 0x4b7fffffU, 0x4b800000U, 0x4effffffU, 0x4f000000U,
        0x4f7fffffU, 0x5f000000U, 0x7f7fffffU, 0x7f800000U, 0x7fc00000U, 0x20000000U, 0x1f800001U, 0x60000001U};
    return kBits[i % 32] | (i / 32 % 2 != 0 ? 0x80000000U : 0U);
}
inline constexpr std::uint32_t kBoundaries = 64;

RAYPOOL_INLINE void pair_of(std::uint32_t i, float& a, float& b) {
    std::uint32_t x = boundary(i % kBoundaries);
    std::uint32_t y = boundary(i / kBoundaries);
    if (i >= kBoundaries * kBoundaries) {  // splitmix64 of the number
        std::uint64_t z = (std::uint64_t{i} + 1) * 0x9e3779b97f4a7c15U;
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        z ^= z >> 31U;
        x = static_cast<std::uint32_t>(z);
        y = static_cast<std::uint32_t>(z >> 32U);
        if (i % 2 == 0) y = (y & 0x807fffffU) | (x & 0x7f800000U);  // of one size, so that differences are small
        const std::uint32_t exponent = x >> 23U & 0xffU;
        if (i % 8 == 2 && exponent > 0 && exponent < 128)  // products near the least normal number, 2^-126
            y = (y & 0x807fffffU) | (128U - exponent) << 23U;
    }
    a = std::bit_cast<float>(x);
    b = std::bit_cast<float>(y);
}

}  // namespace raypool
