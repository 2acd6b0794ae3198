/// Operations on registers of 128 and 256 bits: AVX2 with FMA (x86-64-v3).
///
/// Each of the headers simd_*.h has the same names in the namespace isa, one overload a register type; only
/// core/math/real_wide.h and the framebuffer call them. Minimum and maximum are
/// those of the hardware, `a < b ? a : b` and `a > b ? a : b`, so that a scalar comparison gives the same bits, NaN and
/// signed zeros included. blend() takes `yes` where the mask is set. std::experimental's own where(), fma, min and max
/// are not used: they are miscompiled by clang 14 with AVX-512, fall apart into scalar calls, or differ from the scalar
/// operation.
#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "core/math/platform.h"

#if !defined(__AVX2__) || !defined(__FMA__)
#error "raypool needs AVX2 and FMA: build with RAYPOOL_ARCH=native or x86-64-v3"
#endif

namespace raypool::isa {

/// The registers of so many bytes: of reals, and of what lies beside them, integers and masks.
template <class Scalar, std::size_t bytes>
struct Registers;
template <>
struct Registers<float, 16> {  // four 32-bit integers, beside four doubles
    using Integer = __m128i;
};
template <>
struct Registers<float, 32> {
    using Real = __m256;
    using Integer = __m256i;
};
template <>
struct Registers<double, 32> {
    using Real = __m256d;
    using Integer = __m256i;
};

/// A bit a lane, lane 0 lowest, of a mask as the instruction set keeps it: here ones or zeros in every lane.
template <int lanes>
RAYPOOL_INLINE unsigned mask_bits(__m256i mask) {
    if constexpr (lanes == 8) return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(mask)));
    if constexpr (lanes == 4) return static_cast<unsigned>(_mm256_movemask_pd(_mm256_castsi256_pd(mask)));
}

RAYPOOL_INLINE __m256 fmadd(__m256 a, __m256 b, __m256 c) {
    return _mm256_fmadd_ps(a, b, c);
}
RAYPOOL_INLINE __m256d fmadd(__m256d a, __m256d b, __m256d c) {
    return _mm256_fmadd_pd(a, b, c);
}
RAYPOOL_INLINE __m256 fnmadd(__m256 a, __m256 b, __m256 c) {
    return _mm256_fnmadd_ps(a, b, c);
}
RAYPOOL_INLINE __m256d fnmadd(__m256d a, __m256d b, __m256d c) {
    return _mm256_fnmadd_pd(a, b, c);
}
RAYPOOL_INLINE __m256 min(__m256 a, __m256 b) {
    return _mm256_min_ps(a, b);
}
RAYPOOL_INLINE __m256d min(__m256d a, __m256d b) {
    return _mm256_min_pd(a, b);
}
RAYPOOL_INLINE __m256 max(__m256 a, __m256 b) {
    return _mm256_max_ps(a, b);
}
RAYPOOL_INLINE __m256d max(__m256d a, __m256d b) {
    return _mm256_max_pd(a, b);
}
RAYPOOL_INLINE __m256 sqrt(__m256 a) {
    return _mm256_sqrt_ps(a);
}
RAYPOOL_INLINE __m256d sqrt(__m256d a) {
    return _mm256_sqrt_pd(a);
}
RAYPOOL_INLINE __m256 floor(__m256 a) {
    return _mm256_floor_ps(a);
}
RAYPOOL_INLINE __m256d floor(__m256d a) {
    return _mm256_floor_pd(a);
}

/// Lanes of `element_size` bytes: `yes` where the mask is set, else `no`.
template <std::size_t element_size>
RAYPOOL_INLINE __m256i blend(__m256i mask, __m256i yes, __m256i no) {
    return _mm256_blendv_epi8(no, yes, mask);
}

/// Four consecutive floats from each of 8 or 16 places: column k of the result holds the k-th float of every place.
RAYPOOL_INLINE void transpose_rows(const float* const (&row)[8], __m256 (&column)[4]) {
    const auto pair = [](const float* low, const float* high) {
        return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(low)), _mm_loadu_ps(high), 1);
    };
    const __m256 r0 = pair(row[0], row[4]), r1 = pair(row[1], row[5]);
    const __m256 r2 = pair(row[2], row[6]), r3 = pair(row[3], row[7]);
    const __m256 t0 = _mm256_unpacklo_ps(r0, r1), t1 = _mm256_unpackhi_ps(r0, r1);
    const __m256 t2 = _mm256_unpacklo_ps(r2, r3), t3 = _mm256_unpackhi_ps(r2, r3);
    column[0] = _mm256_shuffle_ps(t0, t2, 0x44);
    column[1] = _mm256_shuffle_ps(t0, t2, 0xee);
    column[2] = _mm256_shuffle_ps(t1, t3, 0x44);
    column[3] = _mm256_shuffle_ps(t1, t3, 0xee);
}

/// The greatest lane; none is NaN.
RAYPOOL_INLINE float greatest(__m256 v) {
    __m128 m = _mm_max_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1));
    m = _mm_max_ps(m, _mm_movehl_ps(m, m));
    return _mm_cvtss_f32(_mm_max_ss(m, _mm_movehdup_ps(m)));
}
RAYPOOL_INLINE double greatest(__m256d v) {
    const __m128d m = _mm_max_pd(_mm256_castpd256_pd128(v), _mm256_extractf128_pd(v, 1));
    return _mm_cvtsd_f64(_mm_max_sd(m, _mm_unpackhi_pd(m, m)));
}

/// table[which[lane]] of a table of `size` floats or doubles, which are as many as fill a register or half of one.
template <int size>
RAYPOOL_INLINE __m256 pick(const float* table, __m256i which) {
    static_assert(size == 8);
    return _mm256_permutevar8x32_ps(_mm256_loadu_ps(table), which);
}
template <int size>
RAYPOOL_INLINE __m256d pick(const double* table, __m128i which) {
    return _mm256_i32gather_pd(table, which, 8);
}

/// The inverse: lane i of the four columns goes to rows[i * stride .. + 3].
RAYPOOL_INLINE void store_transposed(const __m256 (&column)[4], float* rows, int stride) {
    const __m256 t0 = _mm256_unpacklo_ps(column[0], column[1]), t1 = _mm256_unpackhi_ps(column[0], column[1]);
    const __m256 t2 = _mm256_unpacklo_ps(column[2], column[3]), t3 = _mm256_unpackhi_ps(column[2], column[3]);
    const __m256 row[4] = {_mm256_shuffle_ps(t0, t2, 0x44), _mm256_shuffle_ps(t0, t2, 0xee),
                           _mm256_shuffle_ps(t1, t3, 0x44), _mm256_shuffle_ps(t1, t3, 0xee)};
    for (int i = 0; i < 4; ++i) {
        _mm_storeu_ps(rows + i * stride, _mm256_castps256_ps128(row[i]));
        _mm_storeu_ps(rows + (i + 4) * stride, _mm256_extractf128_ps(row[i], 1));
    }
}

#ifndef __AVX512F__  // simd_avx512.h has these, for registers of 256 bits too

/// Rounds values[i] * scale of eight floats, in double, to the nearest integers. False, and nothing is done, where one
/// of the values is not within [0, limit].
inline bool round_eight(const float*, double, double, std::int64_t*) {
    return false;
}
inline constexpr bool kRoundsEight = false;

/// For every mask of 8 lanes, the lanes to take, a byte each.
struct CompressTable {
    alignas(64) std::uint64_t lanes[256];
    constexpr CompressTable() : lanes() {
        for (unsigned mask = 0; mask < 256; ++mask) {
            unsigned filled = 0;
            for (std::uint64_t lane = 0; lane < 8; ++lane)
                if ((mask >> lane & 1U) != 0) lanes[mask] |= lane << (8 * filled++);
        }
    }
};
inline constexpr CompressTable kCompressTable;
/// The lanes whose bit is set in `mask`, moved to the front; what follows them is unspecified.
RAYPOOL_INLINE __m256i compress32(__m256i v, unsigned mask) {
    const __m128i lanes = _mm_cvtsi64_si128(static_cast<long long>(kCompressTable.lanes[mask]));
    return _mm256_permutevar8x32_epi32(v, _mm256_cvtepu8_epi32(lanes));
}
RAYPOOL_INLINE __m128i compress32(__m128i v, unsigned mask) {
    const __m128i lanes = _mm_cvtsi64_si128(static_cast<long long>(kCompressTable.lanes[mask]));
    return _mm_castps_si128(_mm_permutevar_ps(_mm_castsi128_ps(v), _mm_cvtepu8_epi32(lanes)));
}
/// Four 64-bit lanes as pairs of 32-bit ones.
RAYPOOL_INLINE __m256i compress64(__m256i v, unsigned mask) {
    constexpr std::uint8_t kPairs[16] = {0x00, 0x03, 0x0c, 0x0f, 0x30, 0x33, 0x3c, 0x3f,
                                         0xc0, 0xc3, 0xcc, 0xcf, 0xf0, 0xf3, 0xfc, 0xff};
    return compress32(v, kPairs[mask]);
}

#endif

/// Lane i of the result is lane order[i].
RAYPOOL_INLINE __m256i permute32(__m256i v, __m256i order) {
    return _mm256_permutevar8x32_epi32(v, order);
}

}  // namespace raypool::isa
