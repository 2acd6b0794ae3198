/// The scalar half of core/math/real.h: float, double and long double. It parses without std::experimental::simd, and
/// for a GPU.
///
/// What differs by width is in RealTraits, in RealOperations, and in overloads for bool and for arithmetic types;
/// real_wide.h has the other half of each.
#pragma once

#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "core/math/platform.h"

namespace raypool {

namespace detail {

template <class Real>
struct RealTraits {
    using Scalar = Real;
    using Mask = bool;
    using Int = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
    using Uint32 = std::uint32_t;
    static constexpr int kLanes = 1;
};

template <class Real>
struct RealOperations {
    using Int = typename RealTraits<Real>::Int;

    RAYPOOL_INLINE static Real min(Real a, Real b) { return a < b ? a : b; }
    RAYPOOL_INLINE static Real max(Real a, Real b) { return a > b ? a : b; }
    RAYPOOL_INLINE static Real sqrt(Real a) { return std::sqrt(a); }
    RAYPOOL_INLINE static Real floor(Real a) { return std::floor(a); }
    RAYPOOL_INLINE static Real abs(Real a) { return std::fabs(a); }
    RAYPOOL_INLINE static Real copysign(Real magnitude, Real sign) { return std::copysign(magnitude, sign); }

    RAYPOOL_INLINE static Int to_int(Real a) { return static_cast<Int>(a); }
    RAYPOOL_INLINE static Real to_real(Int a) { return static_cast<Real>(a); }
    RAYPOOL_INLINE static Real from_uint32(std::uint32_t a) { return static_cast<Real>(static_cast<std::int32_t>(a)); }
    RAYPOOL_INLINE static std::uint32_t lane_numbers() { return 0; }
    RAYPOOL_INLINE static Real greatest_lane(Real a) { return a; }
    RAYPOOL_INLINE static Real load(const Real* from) { return *from; }

    template <int size>
    RAYPOOL_INLINE static Real pick(const Real* table, std::uint32_t which) {
        return table[which];
    }
    template <int count>
    RAYPOOL_INLINE static void load_rows_at(const Real* table, const std::uint32_t* offset, Real* column) {
        for (int k = 0; k < count; ++k) column[k] = table[*offset + k];
    }
    template <int count>
    RAYPOOL_INLINE static void load_rows(const Real* table, int stride, Int row_id, Real* column) {
        for (int k = 0; k < count; ++k) column[k] = table[row_id * stride + k];
    }
    template <int count>
    RAYPOOL_INLINE static void store_rows(Real* rows, const Real* column) {
        for (int k = 0; k < count; ++k) rows[k] = column[k];
    }
};

/// LanePacker (real.h) of one lane.
template <class Real>
class LanePacker {
  public:
    RAYPOOL_INLINE explicit LanePacker(unsigned bits) : bits_(bits) {}
    template <class V, class T>
    RAYPOOL_INLINE void store(T* target, const V& v) const {
        if (bits_ != 0) *target = v;
    }
    template <class V>
    RAYPOOL_INLINE V pack(const V& v) const {
        return v;
    }

  private:
    unsigned bits_;
};

}  // namespace detail

/// Whether a type is a register of numbers, and whether one is a mask of such.
template <class T>
inline constexpr bool kIsSimd = false;
template <class T>
inline constexpr bool kIsSimdMask = false;
template <class T>
concept Simd = kIsSimd<T>;
template <class T>
concept SimdMask = kIsSimdMask<T>;

RAYPOOL_INLINE bool any(bool m) {
    return m;
}
RAYPOOL_INLINE bool all(bool m) {
    return m;
}
RAYPOOL_INLINE bool none(bool m) {
    return !m;
}
/// One bit a lane, lane 0 lowest.
RAYPOOL_INLINE unsigned mask_bits(bool m) {
    return m ? 1 : 0;
}

template <class T>
requires std::is_arithmetic_v<T> RAYPOOL_INLINE T select(bool m, T yes, T no) {
    return m ? yes : no;
}

/// a b + c, rounded once.
template <std::floating_point T>
RAYPOOL_INLINE T mad(T a, T b, T c) {
    return std::fma(a, b, c);
}
/// c - a b, rounded once.
template <std::floating_point T>
RAYPOOL_INLINE T nmad(T a, T b, T c) {
    return std::fma(-a, b, c);
}

template <class T>
requires std::is_arithmetic_v<T> RAYPOOL_INLINE T lane(const T& v, int) {
    return v;
}

/// Stores the lanes whose bit is set in `bits` one after the other. May write garbage over the rest of a whole vector,
/// so the target has room for one.
template <class V, class T>
requires std::is_arithmetic_v<V> RAYPOOL_INLINE void compress_store(T* target, const V& v, unsigned bits) {
    static_assert(sizeof(V) == sizeof(T));
    if (bits != 0) *target = v;
}

}  // namespace raypool
