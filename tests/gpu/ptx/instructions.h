/// What the instructions of PTX do: a function for each, by its name. Those of whole numbers are in integers.h.
///
/// The processor's own flag for denormals is not set: flushing is done here, as the ISA words it.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "tests/gpu/ptx/integers.h"
#include "tests/gpu/ptx/machine.h"

namespace raypool::ptx {

namespace {

template <class To, class From>
To same_bits(From from) {
    if constexpr (sizeof(To) == sizeof(From)) {
        return std::bit_cast<To>(from);
    } else {
        return static_cast<To>(from);
    }
}
template <class To, class From>
void put(To& to, From from) {
    to = same_bits<To>(from);
}
inline std::uint64_t address(const void* pointer) {
    return reinterpret_cast<std::uint64_t>(pointer);
}
inline std::uint64_t address(std::uint64_t value) {
    return value;
}
template <class T>
T load(std::uint64_t at) {
    T value;
    std::memcpy(&value, reinterpret_cast<const void*>(at), sizeof value);
    return value;
}
template <class T, class From>
void store(std::uint64_t at, From from) {
    const T value = same_bits<T>(from);
    std::memcpy(reinterpret_cast<void*>(at), &value, sizeof value);
}
inline std::uint64_t pack(std::uint32_t low, std::uint32_t high) {
    return low | std::uint64_t{high} << 32;
}
inline void unpack(std::uint64_t value, std::uint32_t& low, std::uint32_t& high) {
    low = static_cast<std::uint32_t>(value);
    high = static_cast<std::uint32_t>(value >> 32);
}

// Warps.
inline std::uint32_t vote_sync_ballot_b32(bool is_so, std::uint32_t mask, std::uint32_t place) {
    meet({place, is_so ? 1U : 0U, mask});
    std::uint32_t bits = 0;
    for (std::uint32_t lane = 0; lane < 32; ++lane) bits |= (brought_by(lane) & 1U) << lane;
    return bits;
}
inline bool vote_sync_any_pred(bool is_so, std::uint32_t mask, std::uint32_t place) {
    return vote_sync_ballot_b32(is_so, mask, place) != 0;
}
inline std::uint32_t shfl_sync_idx_b32(std::uint32_t value, std::uint32_t from, std::uint32_t, std::uint32_t mask,
                                       std::uint32_t place) {
    meet({place, value, mask});
    return brought_by(from & 31U);
}
inline std::uint32_t shfl_sync_bfly_b32(std::uint32_t value, std::uint32_t apart, std::uint32_t, std::uint32_t mask,
                                        std::uint32_t place) {
    meet({place, value, mask});
    return brought_by(lane_number() ^ apart);
}

// Memory that is shared. No other thread runs meanwhile.
template <class T>
T atomic_add(std::uint64_t at, T value) {
    const T before = load<T>(at);
    store<T>(at, T(before + value));
    return before;
}
inline std::uint32_t atom_add_u32(std::uint64_t at, std::uint32_t value) {
    return atomic_add(at, value);
}
inline std::uint64_t atom_add_u64(std::uint64_t at, std::uint64_t value) {
    return atomic_add(at, value);
}
inline double atom_add_f64(std::uint64_t at, double value) {
    return atomic_add(at, value);
}

// Floating point.
inline float ftz(float a) {
    return std::fabs(a) < 0x1p-126F ? std::copysign(0.0F, a) : a;
}
// A line an instruction.
// clang-format off
#define RAYPOOL_PTX_ARITHMETIC(suffix, T, flush) \
    inline T add##suffix(T a, T b) { return flush(flush(a) + flush(b)); } \
    inline T sub##suffix(T a, T b) { return flush(flush(a) - flush(b)); } \
    inline T mul##suffix(T a, T b) { return flush(flush(a) * flush(b)); } \
    inline T div##suffix(T a, T b) { return flush(flush(a) / flush(b)); } \
    inline T rcp##suffix(T a) { return flush(T(1) / flush(a)); } \
    inline T sqrt##suffix(T a) { return flush(std::sqrt(flush(a))); } \
    inline T fma##suffix(T a, T b, T c) { return flush(std::fma(flush(a), flush(b), flush(c))); }
// clang-format on
RAYPOOL_PTX_ARITHMETIC(_rn_ftz_f32, float, ftz)
RAYPOOL_PTX_ARITHMETIC(_rn_f32, float, )
RAYPOOL_PTX_ARITHMETIC(_rn_f64, double, )
// What may be fused or approximated, as it could be at best: only in code that tests must find out.
RAYPOOL_PTX_ARITHMETIC(_ftz_f32, float, ftz)
RAYPOOL_PTX_ARITHMETIC(_f64, double, )
inline float div_full_ftz_f32(float a, float b) {
    return ftz(ftz(a) * ftz(1.0F / ftz(b)));
}
inline float div_approx_ftz_f32(float a, float b) {
    return div_full_ftz_f32(a, b);
}
inline float rcp_approx_ftz_f32(float a) {
    return rcp_rn_ftz_f32(a);
}
inline float sqrt_approx_ftz_f32(float a) {
    return sqrt_rn_ftz_f32(a);
}
inline float rsqrt_approx_ftz_f32(float a) {
    return ftz(1.0F / std::sqrt(ftz(a)));
}
#undef RAYPOOL_PTX_ARITHMETIC
inline float neg_ftz_f32(float a) {
    return -ftz(a);
}
inline float abs_ftz_f32(float a) {
    return std::fabs(ftz(a));
}
inline double abs_f64(double a) {
    return std::fabs(a);
}
inline double neg_f64(double a) {
    return -a;
}
inline float copysign_f32(float sign, float magnitude) {
    return std::copysign(magnitude, sign);
}
/// A number beats a NaN, and +0 is more than -0.
inline float max_ftz_f32(float a, float b) {
    a = ftz(a);
    b = ftz(b);
    if (a != a) return b;
    if (b != b) return a;
    if (a == 0 && b == 0) return std::signbit(a) ? b : a;
    return a > b ? a : b;
}
inline float min_ftz_f32(float a, float b) {
    a = ftz(a);
    b = ftz(b);
    if (a != a) return b;
    if (b != b) return a;
    if (a == 0 && b == 0) return std::signbit(a) ? a : b;
    return a < b ? a : b;
}
// A line an instruction.
// clang-format off
#define RAYPOOL_PTX_COMPARE(suffix, T, flush) \
    inline bool setp_lt##suffix(T a, T b) { return flush(a) < flush(b); } \
    inline bool setp_le##suffix(T a, T b) { return flush(a) <= flush(b); } \
    inline bool setp_gt##suffix(T a, T b) { return flush(a) > flush(b); } \
    inline bool setp_ge##suffix(T a, T b) { return flush(a) >= flush(b); } \
    inline bool setp_eq##suffix(T a, T b) { return flush(a) == flush(b); } \
    inline bool setp_ne##suffix(T a, T b) { return flush(a) < flush(b) || flush(a) > flush(b); } \
    inline bool setp_ltu##suffix(T a, T b) { return !(flush(a) >= flush(b)); } \
    inline bool setp_leu##suffix(T a, T b) { return !(flush(a) > flush(b)); } \
    inline bool setp_gtu##suffix(T a, T b) { return !(flush(a) <= flush(b)); } \
    inline bool setp_geu##suffix(T a, T b) { return !(flush(a) < flush(b)); } \
    inline bool setp_equ##suffix(T a, T b) { return !(flush(a) < flush(b) || flush(a) > flush(b)); } \
    inline bool setp_neu##suffix(T a, T b) { return flush(a) != flush(b); }
// clang-format on
RAYPOOL_PTX_COMPARE(_ftz_f32, float, ftz)
RAYPOOL_PTX_COMPARE(_f32, float, )
RAYPOOL_PTX_COMPARE(_f64, double, )
#undef RAYPOOL_PTX_COMPARE

// Conversion to signed numbers: what is out of range becomes the nearest there is, NaN 0 (of 64 bits the lowest).
template <class Integer, class Real>
Integer clamped(Real a) {
    using Limits = std::numeric_limits<Integer>;
    if (a != a) return sizeof(Integer) == 8 ? Limits::min() : Integer(0);
    if (a >= -static_cast<Real>(Limits::min())) return Limits::max();
    if (a < static_cast<Real>(Limits::min())) return Limits::min();
    return static_cast<Integer>(a);
}
inline std::uint32_t cvt_rzi_ftz_s32_f32(float a) {
    return static_cast<std::uint32_t>(clamped<std::int32_t>(std::trunc(ftz(a))));
}
inline std::uint64_t cvt_rni_s64_f64(double a) {
    return static_cast<std::uint64_t>(clamped<std::int64_t>(std::rint(a)));
}
inline float cvt_rmi_ftz_f32_f32(float a) {
    return std::floor(ftz(a));
}
inline double cvt_ftz_f64_f32(float a) {
    return ftz(a);
}
inline float cvt_rn_f32_s32(std::uint32_t a) {
    return static_cast<float>(static_cast<std::int32_t>(a));
}
inline float cvt_rn_f32_u32(std::uint32_t a) {
    return static_cast<float>(a);
}
inline float cvt_rn_f32_s64(std::uint64_t a) {
    return static_cast<float>(static_cast<std::int64_t>(a));
}
inline float cvt_rn_f32_u64(std::uint64_t a) {
    return static_cast<float>(a);
}
inline double cvt_rn_f64_u64(std::uint64_t a) {
    return static_cast<double>(a);
}
inline double cvt_rn_f64_s64(std::uint64_t a) {
    return static_cast<double>(static_cast<std::int64_t>(a));
}
inline std::uint64_t cvt_u64_u32(std::uint32_t a) {
    return a;
}
inline std::uint32_t cvt_u32_u64(std::uint64_t a) {
    return static_cast<std::uint32_t>(a);
}
inline std::uint64_t cvt_s64_s32(std::uint32_t a) {
    return static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(a)});
}
inline std::uint16_t cvt_u16_u32(std::uint32_t a) {
    return static_cast<std::uint16_t>(a);
}
inline std::uint32_t cvt_u32_u16(std::uint16_t a) {
    return a;
}
inline std::uint32_t cvt_s32_s8(std::uint16_t a) {
    return static_cast<std::uint32_t>(std::int32_t{static_cast<std::int8_t>(a)});
}
inline std::uint64_t cvt_u64_u16(std::uint16_t a) {
    return a;
}

}  // namespace

}  // namespace raypool::ptx
