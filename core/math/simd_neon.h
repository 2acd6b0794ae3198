/// Operations on registers of 64 and 128 bits: NEON of 64-bit ARM (aarch64). What they do is said in simd_avx2.h.
#pragma once

#include <arm_neon.h>

#include <cstddef>
#include <cstdint>

#include "core/math/platform.h"

namespace raypool::isa {

template <class Scalar, std::size_t bytes>
struct Registers;
template <>
struct Registers<float, 8> {  // two 32-bit integers, beside two doubles
    using Integer = uint32x2_t;
};
template <>
struct Registers<float, 16> {
    using Real = float32x4_t;
    using Integer = uint32x4_t;
};
template <>
struct Registers<double, 16> {
    using Real = float64x2_t;
    using Integer = uint32x4_t;
};

template <int lanes>
RAYPOOL_INLINE unsigned mask_bits(uint32x4_t mask) {
    constexpr std::uint32_t kBits[4] = {1, lanes == 4 ? 2 : 0, lanes == 4 ? 4 : 2, lanes == 4 ? 8 : 0};
    return vaddvq_u32(vandq_u32(mask, vld1q_u32(kBits)));
}

RAYPOOL_INLINE float32x4_t fmadd(float32x4_t a, float32x4_t b, float32x4_t c) {
    return vfmaq_f32(c, a, b);
}
RAYPOOL_INLINE float64x2_t fmadd(float64x2_t a, float64x2_t b, float64x2_t c) {
    return vfmaq_f64(c, a, b);
}
RAYPOOL_INLINE float32x4_t fnmadd(float32x4_t a, float32x4_t b, float32x4_t c) {
    return vfmsq_f32(c, a, b);
}
RAYPOOL_INLINE float64x2_t fnmadd(float64x2_t a, float64x2_t b, float64x2_t c) {
    return vfmsq_f64(c, a, b);
}
RAYPOOL_INLINE float32x4_t min(float32x4_t a, float32x4_t b) {
    return vbslq_f32(vcltq_f32(a, b), a, b);
}
RAYPOOL_INLINE float64x2_t min(float64x2_t a, float64x2_t b) {
    return vbslq_f64(vcltq_f64(a, b), a, b);
}
RAYPOOL_INLINE float32x4_t max(float32x4_t a, float32x4_t b) {
    return vbslq_f32(vcgtq_f32(a, b), a, b);
}
RAYPOOL_INLINE float64x2_t max(float64x2_t a, float64x2_t b) {
    return vbslq_f64(vcgtq_f64(a, b), a, b);
}
RAYPOOL_INLINE float32x4_t sqrt(float32x4_t a) {
    return vsqrtq_f32(a);
}
RAYPOOL_INLINE float64x2_t sqrt(float64x2_t a) {
    return vsqrtq_f64(a);
}
RAYPOOL_INLINE float32x4_t floor(float32x4_t a) {
    return vrndmq_f32(a);
}
RAYPOOL_INLINE float64x2_t floor(float64x2_t a) {
    return vrndmq_f64(a);
}

template <std::size_t element_size>
RAYPOOL_INLINE uint32x4_t blend(uint32x4_t mask, uint32x4_t yes, uint32x4_t no) {
    return vbslq_u32(mask, yes, no);
}
template <std::size_t element_size>
RAYPOOL_INLINE uint32x2_t blend(uint32x2_t mask, uint32x2_t yes, uint32x2_t no) {
    return vbsl_u32(mask, yes, no);
}

/// Column k of the result holds the k-th lane of every row.
RAYPOOL_INLINE void transpose(const float32x4_t (&row)[4], float32x4_t (&column)[4]) {
    const float32x4x2_t t01 = vtrnq_f32(row[0], row[1]);
    const float32x4x2_t t23 = vtrnq_f32(row[2], row[3]);
    for (int k = 0; k < 2; ++k) {
        const auto low = vreinterpretq_f64_f32(t01.val[k]);
        const auto high = vreinterpretq_f64_f32(t23.val[k]);
        column[k] = vreinterpretq_f32_f64(vtrn1q_f64(low, high));
        column[k + 2] = vreinterpretq_f32_f64(vtrn2q_f64(low, high));
    }
}
RAYPOOL_INLINE void transpose_rows(const float* const (&row)[4], float32x4_t (&column)[4]) {
    const float32x4_t rows[4] = {vld1q_f32(row[0]), vld1q_f32(row[1]), vld1q_f32(row[2]), vld1q_f32(row[3])};
    transpose(rows, column);
}
RAYPOOL_INLINE void store_transposed(const float32x4_t (&column)[4], float* rows, int stride) {
    float32x4_t row[4];
    transpose(column, row);
    for (int i = 0; i < 4; ++i) vst1q_f32(rows + i * stride, row[i]);
}

RAYPOOL_INLINE float greatest(float32x4_t v) {
    return vmaxvq_f32(v);
}
RAYPOOL_INLINE double greatest(float64x2_t v) {
    return vmaxvq_f64(v);
}

/// Lane i of the result is lane order[i].
RAYPOOL_INLINE uint32x4_t permute32(uint32x4_t v, uint32x4_t order) {
    const uint32x4_t bytes = vmlaq_n_u32(vdupq_n_u32(0x03020100), order, 0x04040404);
    return vreinterpretq_u32_u8(vqtbl1q_u8(vreinterpretq_u8_u32(v), vreinterpretq_u8_u32(bytes)));
}

template <int size>
RAYPOOL_INLINE float32x4_t pick(const float* table, uint32x4_t which) {
    static_assert(size == 4);
    return vreinterpretq_f32_u32(permute32(vreinterpretq_u32_f32(vld1q_f32(table)), which));
}
template <int size>
RAYPOOL_INLINE float64x2_t pick(const double* table, uint32x2_t which) {
    static_assert(size == 2);
    const uint64x2_t is_second = vtstq_u64(vmovl_u32(which), vdupq_n_u64(1));
    return vbslq_f64(is_second, vdupq_n_f64(table[1]), vdupq_n_f64(table[0]));
}

/// Whether round_eight() can: not here.
inline constexpr bool kRoundsEight = false;
inline bool round_eight(const float*, double, double, std::int64_t*) {
    return false;
}

/// For every mask of 4 lanes, the lanes to take.
struct CompressTable {
    alignas(16) std::uint32_t lanes[16][4];
    constexpr CompressTable() : lanes() {
        for (unsigned mask = 0; mask < 16; ++mask) {
            unsigned filled = 0;
            for (std::uint32_t lane = 0; lane < 4; ++lane)
                if ((mask >> lane & 1U) != 0) lanes[mask][filled++] = lane;
        }
    }
};
inline constexpr CompressTable kCompressTable;
RAYPOOL_INLINE uint32x4_t compress32(uint32x4_t v, unsigned mask) {
    return permute32(v, vld1q_u32(kCompressTable.lanes[mask]));
}
RAYPOOL_INLINE uint32x2_t compress32(uint32x2_t v, unsigned mask) {
    return mask == 2 ? vdup_lane_u32(v, 1) : v;
}
RAYPOOL_INLINE uint32x4_t compress64(uint32x4_t v, unsigned mask) {
    return mask == 2 ? vcombine_u32(vget_high_u32(v), vget_high_u32(v)) : v;
}

}  // namespace raypool::isa
