/// One number, or a register of them: `float` and Wide under the same operators, so that the peer's two tracers share
/// their arithmetic.
///
/// Wide is a vector of g++ and clang++: arithmetic and comparisons work lane by lane, and a comparison gives -1 or 0 a
/// lane. What operators do not offer is here. A scalar must be a float to meet a Wide in an expression. A packet of
/// Embree's is one Wide: 16 rays with AVX-512, else 8, the widths that Embree has traversals for.
#pragma once

#include <immintrin.h>

#include <bit>
#include <cstdint>

#define RAYPOOL_PEER_INLINE [[gnu::always_inline]] inline

namespace raypool::peers {

#ifdef __AVX512F__
inline constexpr int kPacket = 16;
#else
inline constexpr int kPacket = 8;
#endif
using Wide [[gnu::vector_size(4 * kPacket)]] = float;
using WideInt [[gnu::vector_size(4 * kPacket)]] = std::int32_t;
using WideUint [[gnu::vector_size(4 * kPacket)]] = std::uint32_t;

/// The integers and masks beside a float type.
template <class F>
struct Beside;
template <>
struct Beside<float> {
    using Int = std::int32_t;
    using Uint = std::uint32_t;
    using Mask = bool;
};
template <>
struct Beside<Wide> {
    using Int = WideInt;
    using Uint = WideUint;
    using Mask = WideInt;
};
template <class F>
using IntOf = typename Beside<F>::Int;
template <class F>
using UintOf = typename Beside<F>::Uint;
template <class F>
using MaskOf = typename Beside<F>::Mask;

/// A field of an Embree ray, whether of one or of a packet, as what the arithmetic takes.
RAYPOOL_PEER_INLINE float& lanes(float& field) {
    return field;
}
RAYPOOL_PEER_INLINE std::uint32_t& lanes(std::uint32_t& field) {
    return field;
}
RAYPOOL_PEER_INLINE Wide& lanes(float (&field)[kPacket]) {
    return reinterpret_cast<Wide&>(field);
}
RAYPOOL_PEER_INLINE WideUint& lanes(std::uint32_t (&field)[kPacket]) {
    return reinterpret_cast<WideUint&>(field);
}

template <class F>
RAYPOOL_PEER_INLINE F all_lanes(float value) {
    return F{} + value;
}

template <class T>
RAYPOOL_PEER_INLINE T select(bool mask, T yes, T no) {
    return mask ? yes : no;
}
template <class T>
RAYPOOL_PEER_INLINE T select(WideInt mask, T yes, T no) {
    return mask ? yes : no;
}
RAYPOOL_PEER_INLINE bool any(bool mask) {
    return mask;
}
RAYPOOL_PEER_INLINE bool any(WideInt mask) {
#ifdef __AVX512F__
    const auto bits = std::bit_cast<__m512i>(mask);
    return _mm512_test_epi32_mask(bits, bits) != 0;
#else
    return _mm256_movemask_ps(std::bit_cast<__m256>(mask)) != 0;
#endif
}

/// Square root; of what is negative, 0.
RAYPOOL_PEER_INLINE float root(float a) {
    return __builtin_sqrtf(a > 0 ? a : 0.0F);
}
RAYPOOL_PEER_INLINE Wide root(Wide a) {
    const Wide least{};
    a = a > least ? a : least;
#ifdef __AVX512F__
    return std::bit_cast<Wide>(_mm512_sqrt_ps(std::bit_cast<__m512>(a)));
#else
    return std::bit_cast<Wide>(_mm256_sqrt_ps(std::bit_cast<__m256>(a)));
#endif
}

/// To the nearest whole number below, of what an int32 can hold.
RAYPOOL_PEER_INLINE float floor(float a) {
    return __builtin_floorf(a);
}
RAYPOOL_PEER_INLINE Wide floor(Wide a) {
    const Wide toward_zero = __builtin_convertvector(__builtin_convertvector(a, WideInt), Wide);
    return toward_zero > a ? toward_zero - 1.0F : toward_zero;
}

RAYPOOL_PEER_INLINE float to_float(std::uint32_t a) {
    return static_cast<float>(static_cast<std::int32_t>(a));
}
RAYPOOL_PEER_INLINE Wide to_float(WideUint a) {
    return __builtin_convertvector(std::bit_cast<WideInt>(a), Wide);
}

/// table[at], lane by lane.
RAYPOOL_PEER_INLINE float gather(const float* table, std::int32_t at) {
    return table[at];
}
RAYPOOL_PEER_INLINE Wide gather(const float* table, WideInt at) {
#ifdef __AVX512F__
    return std::bit_cast<Wide>(_mm512_i32gather_ps(std::bit_cast<__m512i>(at), table, sizeof(float)));
#else
    return std::bit_cast<Wide>(_mm256_i32gather_ps(table, std::bit_cast<__m256i>(at), sizeof(float)));
#endif
}

}  // namespace raypool::peers
