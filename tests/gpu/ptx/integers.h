/// What the instructions of PTX do with whole numbers and predicates: a function for each, by its name.
#pragma once

#include <bit>
#include <cstdint>

namespace raypool::ptx {

namespace {

// Whole numbers, as unsigned ones: `S` is the signed type of the size.
// A line an instruction.
// clang-format off
#define RAYPOOL_PTX_INTEGER(bits, U, S) \
    inline U add_s##bits(U a, U b) { return U(a + b); } \
    inline U add_u##bits(U a, U b) { return U(a + b); } \
    inline U sub_s##bits(U a, U b) { return U(a - b); } \
    inline U sub_u##bits(U a, U b) { return U(a - b); } \
    inline U mul_lo_s##bits(U a, U b) { return U(std::uint64_t{a} * b); } \
    inline U mul_lo_u##bits(U a, U b) { return U(std::uint64_t{a} * b); } \
    inline U mad_lo_s##bits(U a, U b, U c) { return U(std::uint64_t{a} * b + c); } \
    inline U div_s##bits(U a, U b) { return U(S(a) / S(b)); } \
    inline U div_u##bits(U a, U b) { return U(a / b); } \
    inline U rem_s##bits(U a, U b) { return U(S(a) % S(b)); } \
    inline U rem_u##bits(U a, U b) { return U(a % b); } \
    inline U neg_s##bits(U a) { return U(0 - a); } \
    inline U min_s##bits(U a, U b) { return S(a) < S(b) ? a : b; } \
    inline U max_s##bits(U a, U b) { return S(a) > S(b) ? a : b; } \
    inline U min_u##bits(U a, U b) { return a < b ? a : b; } \
    inline U max_u##bits(U a, U b) { return a > b ? a : b; } \
    inline U and_b##bits(U a, U b) { return U(a & b); } \
    inline U or_b##bits(U a, U b) { return U(a | b); } \
    inline U xor_b##bits(U a, U b) { return U(a ^ b); } \
    inline U not_b##bits(U a) { return U(~a); } \
    inline U shl_b##bits(U a, std::uint32_t b) { return b >= bits ? U(0) : U(a << b); } \
    inline U shr_u##bits(U a, std::uint32_t b) { return b >= bits ? U(0) : U(a >> b); } \
    inline U shr_s##bits(U a, std::uint32_t b) { return U(S(a) >> (b >= bits ? bits - 1 : b)); } \
    inline U selp_b##bits(U a, U b, bool is_first) { return is_first ? a : b; } \
    inline U selp_u##bits(U a, U b, bool is_first) { return is_first ? a : b; } \
    inline U selp_s##bits(U a, U b, bool is_first) { return is_first ? a : b; } \
    inline bool setp_eq_b##bits(U a, U b) { return a == b; } \
    inline bool setp_eq_s##bits(U a, U b) { return a == b; } \
    inline bool setp_ne_s##bits(U a, U b) { return a != b; } \
    inline bool setp_lt_s##bits(U a, U b) { return S(a) < S(b); } \
    inline bool setp_le_s##bits(U a, U b) { return S(a) <= S(b); } \
    inline bool setp_gt_s##bits(U a, U b) { return S(a) > S(b); } \
    inline bool setp_ge_s##bits(U a, U b) { return S(a) >= S(b); } \
    inline bool setp_lt_u##bits(U a, U b) { return a < b; } \
    inline bool setp_le_u##bits(U a, U b) { return a <= b; } \
    inline bool setp_gt_u##bits(U a, U b) { return a > b; } \
    inline bool setp_ge_u##bits(U a, U b) { return a >= b; }
// clang-format on
RAYPOOL_PTX_INTEGER(16, std::uint16_t, std::int16_t)
RAYPOOL_PTX_INTEGER(32, std::uint32_t, std::int32_t)
RAYPOOL_PTX_INTEGER(64, std::uint64_t, std::int64_t)
#undef RAYPOOL_PTX_INTEGER
inline std::uint64_t mul_wide_s32(std::uint32_t a, std::uint32_t b) {
    return static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(a)} * static_cast<std::int32_t>(b));
}
inline std::uint64_t mul_wide_u32(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{a} * b;
}
inline std::uint32_t mul_wide_u16(std::uint16_t a, std::uint16_t b) {
    return std::uint32_t{a} * b;
}
inline std::uint32_t popc_b32(std::uint32_t a) {
    return static_cast<std::uint32_t>(std::popcount(a));
}
inline std::uint32_t clz_b32(std::uint32_t a) {
    return static_cast<std::uint32_t>(std::countl_zero(a));
}
inline std::uint32_t brev_b32(std::uint32_t a) {
    std::uint32_t turned = 0;
    for (int i = 0; i < 32; ++i) turned |= (a >> i & 1U) << (31 - i);
    return turned;
}
/// How far to shift left so that the highest bit that is set becomes the highest there is; all ones of 0.
inline std::uint32_t bfind_shiftamt_u32(std::uint32_t a) {
    return a == 0 ? ~0U : clz_b32(a);
}
inline float selp_f32(float a, float b, bool is_first) {
    return is_first ? a : b;
}
inline double selp_f64(double a, double b, bool is_first) {
    return is_first ? a : b;
}

inline bool and_pred(bool a, bool b) {
    return a && b;
}
inline bool or_pred(bool a, bool b) {
    return a || b;
}
inline bool xor_pred(bool a, bool b) {
    return a != b;
}
inline bool not_pred(bool a) {
    return !a;
}

}  // namespace

}  // namespace raypool::ptx
