/// Vectors, random numbers and warps of the peer, for a float or a Wide.
///
/// The peer shares no kernel with the engines, so that a mistake cannot hide in both; hence this second, smaller set.
/// All is free of branches, for the packet's sake.
#pragma once

#include <cstdint>

#include "bench/peers/lanes.h"
#include "core/scene/scene.h"

namespace raypool::peers {

template <class F>
struct V3 {
    F x, y, z;
};

inline V3<float> to_v3(const Vector3d& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
template <class F>
RAYPOOL_PEER_INLINE V3<F> all_lanes(V3<float> v) {
    return {all_lanes<F>(v.x), all_lanes<F>(v.y), all_lanes<F>(v.z)};
}
template <class F>
RAYPOOL_PEER_INLINE V3<F> operator+(V3<F> a, V3<F> b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class F>
RAYPOOL_PEER_INLINE V3<F> operator-(V3<F> a, V3<F> b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class F>
RAYPOOL_PEER_INLINE V3<F> operator-(V3<F> a) {
    return {-a.x, -a.y, -a.z};
}
template <class F>
RAYPOOL_PEER_INLINE V3<F> operator*(F s, V3<F> a) {
    return {s * a.x, s * a.y, s * a.z};
}
template <class F>
RAYPOOL_PEER_INLINE V3<F> operator*(V3<F> a, V3<F> b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <class F>
RAYPOOL_PEER_INLINE F dot(V3<F> a, V3<F> b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class F>
RAYPOOL_PEER_INLINE V3<F> choose(MaskOf<F> mask, V3<F> yes, V3<F> no) {
    return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
/// Of length 1; `spare` where there is hardly anything to scale.
template <class F>
RAYPOOL_PEER_INLINE V3<F> unit_or(V3<F> a, V3<F> spare) {
    const F square = dot(a, a);
    const MaskOf<F> is_short = square < 1e-12F;
    return choose(is_short, spare, (1.0F / root(select(is_short, all_lanes<F>(1), square))) * a);
}

/// xoshiro128+ (Blackman and Vigna, "Scrambled Linear Pseudorandom Number Generators", 2018).
template <class F>
struct Xoshiro {
    UintOf<F> s0, s1, s2, s3;

    /// In [0, 1), from the upper 24 bits.
    RAYPOOL_PEER_INLINE F next() {
        const UintOf<F> sum = s0 + s3;
        const UintOf<F> t = s1 << 9U;
        s2 ^= s0;
        s3 ^= s1;
        s1 ^= s2;
        s0 ^= s3;
        s2 ^= t;
        s3 = (s3 << 11U) | (s3 >> 21U);
        return to_float(sum >> 8U) * 0x1p-24F;
    }
};

/// Independent generators for each seed and stream, by splitmix64, as the authors of xoshiro advise.
inline Xoshiro<float> seeded(std::uint64_t seed, std::uint64_t stream) {
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

template <class F>
struct Circle {
    F sin, cos;
};

/// A point of the unit circle for u in [0, 1): the series for half the angle, which is within a quarter turn of 0, and
/// the formulas for the double angle.
template <class F>
RAYPOOL_PEER_INLINE Circle<F> on_circle(F u) {
    const F y = 3.14159265F * (u - 0.5F);
    const F q = y * y;
    F s = all_lanes<F>(-1 / 39916800.0F);
    for (const float term : {1 / 362880.0F, -1 / 5040.0F, 1 / 120.0F, -1 / 6.0F, 1.0F}) s = s * q + term;
    F c = all_lanes<F>(1 / 479001600.0F);
    for (const float term : {-1 / 3628800.0F, 1 / 40320.0F, -1 / 720.0F, 1 / 24.0F, -1 / 2.0F, 1.0F}) c = c * q + term;
    s = s * y;
    return {2.0F * s * c, 1.0F - 2.0F * s * s};
}

template <class F>
RAYPOOL_PEER_INLINE V3<F> on_sphere(F u, F v) {
    const F z = 1.0F - 2.0F * u;
    const F radius = root(1.0F - z * z);
    const Circle<F> circle = on_circle(v);
    return {radius * circle.cos, radius * circle.sin, z};
}

}  // namespace raypool::peers
