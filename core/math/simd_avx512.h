/// Operations on registers of 512 bits, and those on 256 bits that AVX-512 does by masks of a bit a lane (x86-64-v4).
/// What they do is said in simd_avx2.h.
#pragma once

#include "core/math/simd_avx2.h"

#if !defined(__AVX512VL__) || !defined(__AVX512DQ__)
#error "of AVX-512, raypool takes F, VL and DQ or none: build with RAYPOOL_ARCH=x86-64-v3"
#endif

namespace raypool::isa {

template <>
struct Registers<float, 64> {
    using Real = __m512;
    using Integer = __m512i;
};
template <>
struct Registers<double, 64> {
    using Real = __m512d;
    using Integer = __m512i;
};

/// Masks are bits here, of registers of 256 bits too.
template <int lanes>
RAYPOOL_INLINE unsigned mask_bits(std::uint8_t mask) {
    return mask;
}
template <int lanes>
RAYPOOL_INLINE unsigned mask_bits(std::uint16_t mask) {
    return mask;
}

RAYPOOL_INLINE __m512 fmadd(__m512 a, __m512 b, __m512 c) {
    return _mm512_fmadd_ps(a, b, c);
}
RAYPOOL_INLINE __m512d fmadd(__m512d a, __m512d b, __m512d c) {
    return _mm512_fmadd_pd(a, b, c);
}
RAYPOOL_INLINE __m512 fnmadd(__m512 a, __m512 b, __m512 c) {
    return _mm512_fnmadd_ps(a, b, c);
}
RAYPOOL_INLINE __m512d fnmadd(__m512d a, __m512d b, __m512d c) {
    return _mm512_fnmadd_pd(a, b, c);
}
RAYPOOL_INLINE __m512 min(__m512 a, __m512 b) {
    return _mm512_min_ps(a, b);
}
RAYPOOL_INLINE __m512d min(__m512d a, __m512d b) {
    return _mm512_min_pd(a, b);
}
RAYPOOL_INLINE __m512 max(__m512 a, __m512 b) {
    return _mm512_max_ps(a, b);
}
RAYPOOL_INLINE __m512d max(__m512d a, __m512d b) {
    return _mm512_max_pd(a, b);
}
RAYPOOL_INLINE __m512 sqrt(__m512 a) {
    return _mm512_sqrt_ps(a);
}
RAYPOOL_INLINE __m512d sqrt(__m512d a) {
    return _mm512_sqrt_pd(a);
}
RAYPOOL_INLINE __m512 floor(__m512 a) {
    return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}
RAYPOOL_INLINE __m512d floor(__m512d a) {
    return _mm512_roundscale_pd(a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}

/// Lanes of `element_size` bytes: `yes` where the mask is set, else `no`.
template <std::size_t element_size>
RAYPOOL_INLINE __m256i blend(std::uint8_t mask, __m256i yes, __m256i no) {
    if constexpr (element_size == 4) return _mm256_mask_blend_epi32(mask, no, yes);
    if constexpr (element_size == 8) return _mm256_mask_blend_epi64(mask, no, yes);
}
template <std::size_t element_size>
RAYPOOL_INLINE __m512i blend(std::uint16_t mask, __m512i yes, __m512i no) {
    return _mm512_mask_blend_epi32(mask, no, yes);
}
template <std::size_t element_size>
RAYPOOL_INLINE __m512i blend(std::uint8_t mask, __m512i yes, __m512i no) {
    return _mm512_mask_blend_epi64(mask, no, yes);
}

RAYPOOL_INLINE void transpose_rows(const float* const (&row)[16], __m512 (&column)[4]) {
    const auto quad = [](const float* a, const float* b, const float* c, const float* d) {
        __m512 r = _mm512_castps128_ps512(_mm_loadu_ps(a));
        r = _mm512_insertf32x4(r, _mm_loadu_ps(b), 1);
        r = _mm512_insertf32x4(r, _mm_loadu_ps(c), 2);
        return _mm512_insertf32x4(r, _mm_loadu_ps(d), 3);
    };
    const __m512 r0 = quad(row[0], row[4], row[8], row[12]), r1 = quad(row[1], row[5], row[9], row[13]);
    const __m512 r2 = quad(row[2], row[6], row[10], row[14]), r3 = quad(row[3], row[7], row[11], row[15]);
    const __m512 t0 = _mm512_unpacklo_ps(r0, r1), t1 = _mm512_unpackhi_ps(r0, r1);
    const __m512 t2 = _mm512_unpacklo_ps(r2, r3), t3 = _mm512_unpackhi_ps(r2, r3);
    column[0] = _mm512_shuffle_ps(t0, t2, 0x44);
    column[1] = _mm512_shuffle_ps(t0, t2, 0xee);
    column[2] = _mm512_shuffle_ps(t1, t3, 0x44);
    column[3] = _mm512_shuffle_ps(t1, t3, 0xee);
}

/// The same of eight consecutive floats: half as many loads and a third of the inserts of four and four. (For eight
/// rows nothing is gained by it.)
RAYPOOL_INLINE void transpose_rows(const float* const (&row)[16], __m512 (&column)[8]) {
    __m512 mixed[2][4];  // of eight rows each: columns k and k + 4 of four rows, then of the other four
    for (int half = 0; half < 2; ++half) {
        const auto load = [&](int i) {
            const float* const* from = row + 8 * half + i;
            const __m512d low = _mm512_castps_pd(_mm512_castps256_ps512(_mm256_loadu_ps(from[0])));
            return _mm512_castpd_ps(_mm512_insertf64x4(low, _mm256_castps_pd(_mm256_loadu_ps(from[4])), 1));
        };
        const __m512 r0 = load(0), r1 = load(1), r2 = load(2), r3 = load(3);
        const __m512 t0 = _mm512_unpacklo_ps(r0, r1), t1 = _mm512_unpackhi_ps(r0, r1);
        const __m512 t2 = _mm512_unpacklo_ps(r2, r3), t3 = _mm512_unpackhi_ps(r2, r3);
        mixed[half][0] = _mm512_shuffle_ps(t0, t2, 0x44);
        mixed[half][1] = _mm512_shuffle_ps(t0, t2, 0xee);
        mixed[half][2] = _mm512_shuffle_ps(t1, t3, 0x44);
        mixed[half][3] = _mm512_shuffle_ps(t1, t3, 0xee);
    }
    for (int k = 0; k < 4; ++k) {
        column[k] = _mm512_shuffle_f32x4(mixed[0][k], mixed[1][k], 0x88);
        column[k + 4] = _mm512_shuffle_f32x4(mixed[0][k], mixed[1][k], 0xdd);
    }
}

RAYPOOL_INLINE float greatest(__m512 v) {
    return greatest(
        _mm256_max_ps(_mm512_castps512_ps256(v), _mm256_castpd_ps(_mm512_extractf64x4_pd(_mm512_castps_pd(v), 1))));
}
RAYPOOL_INLINE double greatest(__m512d v) {
    return greatest(_mm256_max_pd(_mm512_castpd512_pd256(v), _mm512_extractf64x4_pd(v, 1)));
}

template <int size>
RAYPOOL_INLINE __m512 pick(const float* table, __m512i which) {
    static_assert(size == 8);
    return _mm512_permutexvar_ps(which, _mm512_castps256_ps512(_mm256_loadu_ps(table)));
}
template <int size>
RAYPOOL_INLINE __m512d pick(const double* table, __m256i which) {
    static_assert(size == 8);
    return _mm512_permutexvar_pd(_mm512_cvtepu32_epi64(which), _mm512_loadu_pd(table));
}

RAYPOOL_INLINE void store_transposed(const __m512 (&column)[4], float* rows, int stride) {
    const __m512 t0 = _mm512_unpacklo_ps(column[0], column[1]), t1 = _mm512_unpackhi_ps(column[0], column[1]);
    const __m512 t2 = _mm512_unpacklo_ps(column[2], column[3]), t3 = _mm512_unpackhi_ps(column[2], column[3]);
    const __m512 row[4] = {_mm512_shuffle_ps(t0, t2, 0x44), _mm512_shuffle_ps(t0, t2, 0xee),
                           _mm512_shuffle_ps(t1, t3, 0x44), _mm512_shuffle_ps(t1, t3, 0xee)};
    for (int i = 0; i < 4; ++i) {
        _mm_storeu_ps(rows + i * stride, _mm512_castps512_ps128(row[i]));
        _mm_storeu_ps(rows + (i + 4) * stride, _mm512_extractf32x4_ps(row[i], 1));
        _mm_storeu_ps(rows + (i + 8) * stride, _mm512_extractf32x4_ps(row[i], 2));
        _mm_storeu_ps(rows + (i + 12) * stride, _mm512_extractf32x4_ps(row[i], 3));
    }
}

/// Rounds values[i] * scale of eight floats, in double, to the nearest integers. False, and nothing is done, where one
/// of the values is not within [0, limit].
RAYPOOL_INLINE bool round_eight(const float* values, double scale, double limit, std::int64_t* rounded) {
    const __m512d value = _mm512_cvtps_pd(_mm256_loadu_ps(values));
    const __mmask8 is_good = _mm512_mask_cmp_pd_mask(_mm512_cmp_pd_mask(value, _mm512_setzero_pd(), _CMP_GE_OQ), value,
                                                     _mm512_set1_pd(limit), _CMP_LE_OQ);
    if (is_good != 0xff) return false;
    _mm512_storeu_si512(rounded, _mm512_cvtpd_epi64(_mm512_mul_pd(value, _mm512_set1_pd(scale))));
    return true;
}
inline constexpr bool kRoundsEight = true;

/// The lanes whose bit is set in `mask`, moved to the front; what follows them is unspecified.
RAYPOOL_INLINE __m512i compress32(__m512i v, unsigned mask) {
    return _mm512_maskz_compress_epi32(static_cast<__mmask16>(mask), v);
}
RAYPOOL_INLINE __m256i compress32(__m256i v, unsigned mask) {
    return _mm256_maskz_compress_epi32(static_cast<__mmask8>(mask), v);
}
RAYPOOL_INLINE __m512i compress64(__m512i v, unsigned mask) {
    return _mm512_maskz_compress_epi64(static_cast<__mmask8>(mask), v);
}

RAYPOOL_INLINE __m512i permute32(__m512i v, __m512i order) {
    return _mm512_permutexvar_epi32(order, v);
}

}  // namespace raypool::isa
