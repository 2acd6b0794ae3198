/// Vectors, random numbers and warps of the peer: plain floats, one lane at a time.
///
/// The peer shares no kernel with the engines, so that a mistake cannot hide in both; hence this second, smaller set.
/// Everything is inline and free of branches, because the packet tracer calls it inside `omp simd` loops.
#pragma once

#include <cmath>
#include <cstdint>

#define RAYPOOL_PEER_INLINE [[gnu::always_inline]] inline

namespace raypool::peers {

struct V3 {
    float x, y, z;
};

RAYPOOL_PEER_INLINE V3 operator+(V3 a, V3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
RAYPOOL_PEER_INLINE V3 operator-(V3 a, V3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
RAYPOOL_PEER_INLINE V3 operator*(float s, V3 a) {
    return {s * a.x, s * a.y, s * a.z};
}
RAYPOOL_PEER_INLINE V3 operator*(V3 a, V3 b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
RAYPOOL_PEER_INLINE float dot(V3 a, V3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
RAYPOOL_PEER_INLINE V3 choose(bool m, V3 yes, V3 no) {
    return {m ? yes.x : no.x, m ? yes.y : no.y, m ? yes.z : no.z};
}
RAYPOOL_PEER_INLINE float clip(float a) {  // to no less than 0
    return a > 0 ? a : 0.0F;
}
RAYPOOL_PEER_INLINE float root(float a) {
    return __builtin_sqrtf(clip(a));
}
/// Of length 1; `spare` where there is hardly anything to scale.
RAYPOOL_PEER_INLINE V3 unit_or(V3 a, V3 spare) {
    const float square = dot(a, a);
    const bool is_short = square < 1e-12F;
    return choose(is_short, spare, (1 / __builtin_sqrtf(is_short ? 1.0F : square)) * a);
}

/// xoshiro128+ (Blackman and Vigna, "Scrambled Linear Pseudorandom Number Generators", 2018).
struct Xoshiro {
    std::uint32_t s0, s1, s2, s3;

    /// In [0, 1), from the upper 24 bits.
    RAYPOOL_PEER_INLINE float next() {
        const std::uint32_t sum = s0 + s3;
        const std::uint32_t t = s1 << 9U;
        s2 ^= s0;
        s3 ^= s1;
        s1 ^= s2;
        s0 ^= s3;
        s2 ^= t;
        s3 = (s3 << 11U) | (s3 >> 21U);
        return static_cast<float>(static_cast<std::int32_t>(sum >> 8U)) * 0x1p-24F;
    }
};

/// Independent generators for each seed and stream, by splitmix64, as the authors of xoshiro advise.
inline Xoshiro seeded(std::uint64_t seed, std::uint64_t stream) {
    const auto mix = [](std::uint64_t z) {
        z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
        z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
        return z ^ (z >> 31U);
    };
    const std::uint64_t a = mix(mix(seed + 0x9E3779B97F4A7C15U) + stream);
    const std::uint64_t b = mix(a + 0x9E3779B97F4A7C15U);
    return {static_cast<std::uint32_t>(a) | 1U, static_cast<std::uint32_t>(a >> 32U), static_cast<std::uint32_t>(b),
            static_cast<std::uint32_t>(b >> 32U)};
}

struct Circle {
    float sin, cos;
};

/// A point of the unit circle for u in [0, 1): the series for half the angle, which is within a quarter turn of 0, and
/// the formulas for the double angle.
RAYPOOL_PEER_INLINE Circle on_circle(float u) {
    const float y = 3.14159265F * (u - 0.5F);
    const float q = y * y;
    const float s =
        y * (1 + q * (-1 / 6.0F + q * (1 / 120.0F + q * (-1 / 5040.0F + q * (1 / 362880.0F - q / 39916800.0F)))));
    const float c =
        1 +
        q * (-1 / 2.0F + q * (1 / 24.0F + q * (-1 / 720.0F + q * (1 / 40320.0F + q * (-1 / 3628800.0F + q / 479001600.0F)))));
    return {2 * s * c, 1 - 2 * s * s};
}

RAYPOOL_PEER_INLINE V3 on_sphere(float u, float v) {
    const float z = 1 - 2 * u;
    const float radius = root(1 - z * z);
    const Circle circle = on_circle(v);
    return {radius * circle.cos, radius * circle.sin, z};
}

}  // namespace raypool::peers
