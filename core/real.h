/// The number types that the kernels are written over, and the few operations that differ between them.
///
/// A kernel is a template over `Real`: float, double, long double, or a SIMD vector of float or double. Every
/// operation here gives each lane the bits that the scalar operation gives, so a kernel's result does not depend on
/// how many rays it is asked about at a time. That is what lets two engines make one image.
///
/// Idioms: `if (any(mask))` is the branch when Real is a scalar and the skip when it is wide, and select() follows;
/// literals are Real(2); a fused multiply-add is written mad or nmad and happens nowhere else.
#pragma once

#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <experimental/simd>
#include <limits>
#include <type_traits>

#include "core/simd_x86.h"

namespace raypool {

namespace stdx = std::experimental;

template <class T>
concept Simd = stdx::is_simd_v<T>;
template <class T>
concept SimdMask = stdx::is_simd_mask_v<T>;

/// A vector of N floats or doubles that fills one register.
template <class Scalar, int N>
using Wide = stdx::simd<Scalar, stdx::simd_abi::deduce_t<Scalar, N>>;

namespace detail {
template <class Real>
struct RealTraits {  // scalars
    using Scalar = Real;
    using Mask = bool;
    using Int = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
    using Uint32 = std::uint32_t;
    static constexpr int kLanes = 1;
};
template <Simd Real>
struct RealTraits<Real> {
    using Scalar = typename Real::value_type;
    using Mask = typename Real::mask_type;
    using Int = stdx::rebind_simd_t<typename RealTraits<Scalar>::Int, Real>;
    using Uint32 = stdx::simd<std::uint32_t, stdx::simd_abi::deduce_t<std::uint32_t, Real::size()>>;
    static constexpr int kLanes = Real::size();
};
}  // namespace detail

template <class Real>
using ScalarOf = typename detail::RealTraits<Real>::Scalar;
template <class Real>
using Mask = typename detail::RealTraits<Real>::Mask;
/// Signed integers as wide as the real: 32 bits beside float, 64 bits beside double.
template <class Real>
using Int = typename detail::RealTraits<Real>::Int;
/// As many 32-bit unsigned integers as Real has lanes, for random numbers.
template <class Real>
using Uint32 = typename detail::RealTraits<Real>::Uint32;
template <class Real>
inline constexpr int kLanes = detail::RealTraits<Real>::kLanes;

template <class Real>
inline constexpr ScalarOf<Real> kInfinity = std::numeric_limits<ScalarOf<Real>>::infinity();

namespace detail {
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
#ifdef __AVX512F__
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
#endif
template <Simd V>
using IntegerRegister = typename Registers<float, sizeof(V)>::Integer;
template <Simd V>
using RealRegister = typename Registers<typename V::value_type, sizeof(V)>::Real;
template <Simd V>
RAYPOOL_INLINE auto reg(const V& v) {
    return std::bit_cast<RealRegister<V>>(v);
}
/// A mask as its instruction set keeps it: a bit a lane in AVX-512, a register of ones and zeros in AVX2.
template <SimdMask M>
RAYPOOL_INLINE auto mask_register(const M& m) {
    if constexpr (sizeof(M) == 1) {
        return std::bit_cast<std::uint8_t>(m);
    } else if constexpr (sizeof(M) == 2) {
        return std::bit_cast<std::uint16_t>(m);
    } else {
        return std::bit_cast<typename Registers<float, sizeof(M)>::Integer>(m);
    }
}
}  // namespace detail

// Masks.

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

template <SimdMask M>
RAYPOOL_INLINE unsigned mask_bits(const M& m) {
    const auto bits = detail::mask_register(m);
    if constexpr (sizeof(M) <= 2) {
        return bits;
    } else if constexpr (M::size() == 8) {
        return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(bits)));
    } else {
        return static_cast<unsigned>(_mm256_movemask_pd(_mm256_castsi256_pd(bits)));
    }
}
template <SimdMask M>
inline constexpr unsigned kAllBits = (1U << M::size()) - 1;
template <SimdMask M>
RAYPOOL_INLINE bool any(const M& m) {
    return mask_bits(m) != 0;
}
template <SimdMask M>
RAYPOOL_INLINE bool all(const M& m) {
    return mask_bits(m) == kAllBits<M>;
}
template <SimdMask M>
RAYPOOL_INLINE bool none(const M& m) {
    return mask_bits(m) == 0;
}

/// The mask of a comparison of Int<Real> as a mask of Real.
template <class Real, class M>
RAYPOOL_INLINE Mask<Real> as_mask(const M& m) {
    if constexpr (std::same_as<M, bool>) {
        return Mask<Real>(m);
    } else {
        return std::bit_cast<Mask<Real>>(m);
    }
}

// Choice.

template <class T>
requires std::is_arithmetic_v<T> RAYPOOL_INLINE T select(bool m, T yes, T no) {
    return m ? yes : no;
}
template <SimdMask M, Simd V>
RAYPOOL_INLINE V select(const M& m, const V& yes, const V& no) {
    using Register = detail::IntegerRegister<V>;
    return std::bit_cast<V>(x86::blend<sizeof(typename V::value_type)>(
        detail::mask_register(m), std::bit_cast<Register>(yes), std::bit_cast<Register>(no)));
}

// Arithmetic.

template <std::floating_point T>
RAYPOOL_INLINE T mad(T a, T b, T c) {
    return std::fma(a, b, c);
}
template <std::floating_point T>
RAYPOOL_INLINE T nmad(T a, T b, T c) {
    return std::fma(-a, b, c);
}
/// a b + c, rounded once.
template <Simd V>
RAYPOOL_INLINE V mad(const V& a, const V& b, const V& c) {
    return std::bit_cast<V>(x86::fmadd(detail::reg(a), detail::reg(b), detail::reg(c)));
}
/// c - a b, rounded once.
template <Simd V>
RAYPOOL_INLINE V nmad(const V& a, const V& b, const V& c) {
    return std::bit_cast<V>(x86::fnmadd(detail::reg(a), detail::reg(b), detail::reg(c)));
}
// These are objects, not functions: the arguments of an unqualified call would bring in the functions of the same name
// of std::experimental, and those take other values for NaN and for zeros of either sign.
namespace detail {

struct Minimum {
    template <class Real>
    RAYPOOL_INLINE Real operator()(const Real& a, const Real& b) const {
        if constexpr (Simd<Real>) {
            return std::bit_cast<Real>(x86::min(reg(a), reg(b)));
        } else {
            return a < b ? a : b;
        }
    }
};
struct Maximum {
    template <class Real>
    RAYPOOL_INLINE Real operator()(const Real& a, const Real& b) const {
        if constexpr (Simd<Real>) {
            return std::bit_cast<Real>(x86::max(reg(a), reg(b)));
        } else {
            return a > b ? a : b;
        }
    }
};
struct SquareRoot {
    template <class Real>
    RAYPOOL_INLINE Real operator()(const Real& a) const {
        if constexpr (Simd<Real>) {
            return std::bit_cast<Real>(x86::sqrt(reg(a)));
        } else {
            return std::sqrt(a);
        }
    }
};
struct Floor {
    template <class Real>
    RAYPOOL_INLINE Real operator()(const Real& a) const {
        if constexpr (Simd<Real>) {
            return std::bit_cast<Real>(x86::floor(reg(a)));
        } else {
            return std::floor(a);
        }
    }
};
struct Absolute {
    template <class Real>
    RAYPOOL_INLINE Real operator()(const Real& a) const {
        if constexpr (Simd<Real>) {
            using Register = IntegerRegister<Real>;
            return std::bit_cast<Real>(x86::bit_and(std::bit_cast<Register>(a), ~std::bit_cast<Register>(Real(-0.0F))));
        } else {
            return std::fabs(a);
        }
    }
};
struct CopySign {
    template <class Real>
    RAYPOOL_INLINE Real operator()(const Real& magnitude, const Real& sign) const {
        if constexpr (Simd<Real>) {
            using Register = IntegerRegister<Real>;
            const Register sign_bit = std::bit_cast<Register>(Real(-0.0F));
            return std::bit_cast<Real>(x86::bit_or(x86::bit_and(std::bit_cast<Register>(magnitude), ~sign_bit),
                                                   x86::bit_and(std::bit_cast<Register>(sign), sign_bit)));
        } else {
            return std::copysign(magnitude, sign);
        }
    }
};

}  // namespace detail

inline constexpr detail::Minimum min{};  ///< a < b ? a : b, so b when either is NaN
inline constexpr detail::Maximum max{};  ///< a > b ? a : b, so b when either is NaN
inline constexpr detail::SquareRoot sqrt{};
inline constexpr detail::Floor floor{};
inline constexpr detail::Absolute abs{};
inline constexpr detail::CopySign copysign{};  ///< (magnitude, sign)

// Conversion. Values must be in range of the target; callers clamp first.

/// Rounds towards zero.
template <class Real>
RAYPOOL_INLINE Int<Real> to_int(const Real& a) {
    if constexpr (Simd<Real>) {
        return stdx::static_simd_cast<Int<Real>>(a);
    } else {
        return static_cast<Int<Real>>(a);
    }
}
/// The integers whose bits are those of `a`, and back: for tables in which a column of integers stands among reals. Such
/// a column may be moved, and nothing else, unless its values say otherwise (FlatMark): as a number it can be a NaN, or
/// too small for the processor to keep.
template <class Real>
RAYPOOL_INLINE Int<Real> bits_of(const Real& a) {
    return std::bit_cast<Int<Real>>(a);
}
template <class Real>
RAYPOOL_INLINE Real of_bits(const Int<Real>& a) {
    return std::bit_cast<Real>(a);
}
template <class Real>
RAYPOOL_INLINE Real to_real(const Int<Real>& a) {
    if constexpr (Simd<Real>) {
        return stdx::static_simd_cast<Real>(a);
    } else {
        return static_cast<Real>(a);
    }
}
/// The real value of unsigned integers below 2^31.
template <class Real>
RAYPOOL_INLINE Real from_uint32(const Uint32<Real>& a) {
    if constexpr (Simd<Real>) {
        using Signed = stdx::rebind_simd_t<std::int32_t, Uint32<Real>>;
        return stdx::static_simd_cast<Real>(stdx::static_simd_cast<Signed>(a));
    } else {
        return static_cast<Real>(static_cast<std::int32_t>(a));
    }
}

// Lanes and tables.

template <class V>
RAYPOOL_INLINE auto lane(const V& v, int i) {
    if constexpr (Simd<V>) {
        return static_cast<typename V::value_type>(v[i]);
    } else {
        return v;
    }
}

/// Stores the lanes whose bit is set in `bits` one after the other. May write garbage over the rest of a whole vector,
/// so the target has room for one. (A register is compressed and then stored whole: a compressing store is slow.)
template <class V, class T>
RAYPOOL_INLINE void compress_store(T* target, const V& v, unsigned bits) {
    static_assert(Simd<V> || sizeof(V) == sizeof(T));
    if constexpr (!Simd<V>) {
        if (bits != 0) *target = v;
    } else if constexpr (sizeof(T) == 4) {
        const auto packed = x86::compress32(std::bit_cast<detail::IntegerRegister<V>>(v), bits);
        std::bit_cast<V>(packed).copy_to(target, stdx::element_aligned);
    } else {
        const auto packed = x86::compress64(std::bit_cast<detail::IntegerRegister<V>>(v), bits);
        std::bit_cast<V>(packed).copy_to(target, stdx::element_aligned);
    }
}

/// 0, 1, 2, ... by lane.
template <class Real>
RAYPOOL_INLINE Uint32<Real> lane_numbers() {
    if constexpr (Simd<Real>) {
        return Uint32<Real>([](auto i) { return static_cast<std::uint32_t>(i); });
    } else {
        return 0;
    }
}

/// compress_store() of many registers with the same bits: where a lane goes is found once, and lanes of 32 bits then
/// take one instruction a register.
template <class Real>
class LanePacker {
  public:
    RAYPOOL_INLINE explicit LanePacker(unsigned bits) : bits_(bits) {
        if constexpr (kIsPermuted) {
            const auto numbers = std::bit_cast<detail::IntegerRegister<Uint32<Real>>>(lane_numbers<Real>());
            order_ = std::bit_cast<Uint32<Real>>(x86::compress32(numbers, bits));
        }
    }
    template <class V, class T>
    RAYPOOL_INLINE void store(T* target, const V& v) const {
        if constexpr (kIsPermuted) {
            using Register = detail::IntegerRegister<V>;
            const Register packed = x86::permute32(std::bit_cast<Register>(v), std::bit_cast<Register>(order_));
            std::bit_cast<V>(packed).copy_to(target, stdx::element_aligned);
        } else {
            compress_store(target, v, bits_);
        }
    }

  private:
    static constexpr bool kIsPermuted = Simd<Real> && sizeof(ScalarOf<Real>) == 4;
    unsigned bits_;
    Uint32<Real> order_;
};

/// No lane may be NaN.
template <class Real>
RAYPOOL_INLINE ScalarOf<Real> greatest_lane(const Real& v) {
    if constexpr (!Simd<Real>) {
        return v;
    } else {
        return x86::greatest(detail::reg(v));
    }
}

/// The first `count` lanes.
template <class Real>
RAYPOOL_INLINE Mask<Real> lanes_before(std::size_t count) {
    return from_uint32<Real>(lane_numbers<Real>()) < Real(static_cast<ScalarOf<Real>>(count));
}

/// table[which[lane]] of `size` scalars, as many as fill a register or half of one; `which` is below `size`.
template <int size, class Real>
RAYPOOL_INLINE Real pick(const ScalarOf<Real>* table, const Uint32<Real>& which) {
    if constexpr (!Simd<Real>) {
        return table[which];
    } else {
        return std::bit_cast<Real>(x86::pick<size>(table, std::bit_cast<detail::IntegerRegister<Uint32<Real>>>(which)));
    }
}

/// Rows of `count` scalars, a multiple of four, that begin at table[offset[lane]], transposed: column[k] =
/// table[offset[lane] + k]. All lanes' offsets must be in the table.
template <int count, class Real>
RAYPOOL_INLINE void load_rows_at(const ScalarOf<Real>* table, const std::uint32_t* offset, Real* column) {
    static_assert(count % 4 == 0);
    if constexpr (Simd<Real> && std::same_as<ScalarOf<Real>, float>) {
        const auto load_block = [&]<int columns>(int first) {
            const float* rows[kLanes<Real>];
            for (int i = 0; i < kLanes<Real>; ++i) rows[i] = table + first + offset[i];
            detail::RealRegister<Real> block[columns];
            x86::transpose_rows(rows, block);
            for (int k = 0; k < columns; ++k) column[first + k] = std::bit_cast<Real>(block[k]);
        };
        int first = 0;
        if constexpr (kLanes<Real> == 16) {
            for (; first + 8 <= count; first += 8) load_block.template operator()<8>(first);
        }
        for (; first < count; first += 4) load_block.template operator()<4>(first);
    } else if constexpr (Simd<Real>) {
        for (int k = 0; k < count; ++k) column[k] = Real([&](auto i) { return table[offset[i] + k]; });
    } else {
        for (int k = 0; k < count; ++k) column[k] = table[*offset + k];
    }
}

/// Row `row_id[lane]` of a table whose rows are `stride` scalars long: column[k] = table[row_id * stride + first + k].
/// `count` is a multiple of four; every row id, also of lanes that the caller will ignore, must be in the table.
template <int count, class Real>
RAYPOOL_INLINE void load_rows(const ScalarOf<Real>* table, int stride, const Int<Real>& row_id, Real* column) {
    static_assert(count % 4 == 0);
    if constexpr (Simd<Real> && std::same_as<ScalarOf<Real>, float>) {
        alignas(64) std::uint32_t offset[kLanes<Real>];  // kMostBoxes rows of 16 scalars are 2^28
        stdx::static_simd_cast<Uint32<Real>>(row_id * Int<Real>(stride)).copy_to(offset, stdx::vector_aligned);
        load_rows_at<count, Real>(table, offset, column);
    } else if constexpr (Simd<Real>) {
        for (int k = 0; k < count; ++k) column[k] = Real([&](auto i) { return table[lane(row_id, i) * stride + k]; });
    } else {
        for (int k = 0; k < count; ++k) column[k] = table[row_id * stride + k];
    }
}

/// The inverse of load_rows for consecutive rows: row[lane * count + k] = column[k] of that lane.
template <int count, class Real>
RAYPOOL_INLINE void store_rows(ScalarOf<Real>* rows, const Real* column) {
    static_assert(count % 4 == 0);
    if constexpr (Simd<Real> && std::same_as<ScalarOf<Real>, float>) {
        for (int first = 0; first < count; first += 4) {
            detail::RealRegister<Real> block[4];
            for (int k = 0; k < 4; ++k) block[k] = detail::reg(column[first + k]);
            x86::store_transposed(block, rows + first, count);
        }
    } else {
        for (int k = 0; k < count; ++k)
            for (int i = 0; i < kLanes<Real>; ++i) rows[i * count + k] = lane(column[k], i);
    }
}

}  // namespace raypool
