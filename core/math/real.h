/// The number types that the kernels are written over, and the few operations that differ between them.
///
/// A kernel is a template over `Real`: float, double, long double, or a SIMD vector of float or double. Every
/// operation here gives each lane the bits that the scalar operation gives, so a kernel's result does not depend on
/// how many rays it is asked about at a time. That is what lets two engines make one image.
///
/// Idioms: `if (any(mask))` is the branch when Real is a scalar and the skip when it is wide, and select() follows;
/// literals are Real(2); a fused multiply-add is written mad or nmad and happens nowhere else. any, all, none,
/// mask_bits, select, mad, nmad, lane and compress_store are overloads in the two halves.
#pragma once

#include "core/math/real_scalar.h"
#ifndef __CUDACC__
#include "core/math/real_wide.h"
#endif

namespace raypool {

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

/// The mask of a comparison of Int<Real> as a mask of Real.
template <class Real, class M>
RAYPOOL_INLINE Mask<Real> as_mask(const M& m) {
    if constexpr (std::same_as<M, bool>) {
        return Mask<Real>(m);
    } else {
        return std::bit_cast<Mask<Real>>(m);
    }
}

// These are objects, not functions: the arguments of an unqualified call would bring in the functions of the same name
// of std::experimental, and those take other values for NaN and for zeros of either sign.
namespace detail {

struct Minimum {
    template <class Real>
    RAYPOOL_INLINE Real operator()(const Real& a, const Real& b) const {
        return RealOperations<Real>::min(a, b);
    }
};
struct Maximum {
    template <class Real>
    RAYPOOL_INLINE Real operator()(const Real& a, const Real& b) const {
        return RealOperations<Real>::max(a, b);
    }
};
struct SquareRoot {
    template <class Real>
    RAYPOOL_INLINE Real operator()(const Real& a) const {
        return RealOperations<Real>::sqrt(a);
    }
};
struct Floor {
    template <class Real>
    RAYPOOL_INLINE Real operator()(const Real& a) const {
        return RealOperations<Real>::floor(a);
    }
};
struct Absolute {
    template <class Real>
    RAYPOOL_INLINE Real operator()(const Real& a) const {
        return RealOperations<Real>::abs(a);
    }
};
struct CopySign {
    template <class Real>
    RAYPOOL_INLINE Real operator()(const Real& magnitude, const Real& sign) const {
        return RealOperations<Real>::copysign(magnitude, sign);
    }
};

}  // namespace detail

RAYPOOL_CONSTANT detail::Minimum min{};  ///< a < b ? a : b, so b when either is NaN
RAYPOOL_CONSTANT detail::Maximum max{};  ///< a > b ? a : b, so b when either is NaN
RAYPOOL_CONSTANT detail::SquareRoot sqrt{};
RAYPOOL_CONSTANT detail::Floor floor{};
RAYPOOL_CONSTANT detail::Absolute abs{};
RAYPOOL_CONSTANT detail::CopySign copysign{};  ///< (magnitude, sign)

// Conversion. Values must be in range of the target; callers clamp first.

/// Rounds towards zero.
template <class Real>
RAYPOOL_INLINE Int<Real> to_int(const Real& a) {
    return detail::RealOperations<Real>::to_int(a);
}
template <class Real>
RAYPOOL_INLINE Real to_real(const Int<Real>& a) {
    return detail::RealOperations<Real>::to_real(a);
}
/// The real value of unsigned integers below 2^31.
template <class Real>
RAYPOOL_INLINE Real from_uint32(const Uint32<Real>& a) {
    return detail::RealOperations<Real>::from_uint32(a);
}
/// The integers whose bits are those of `a`, and back: for tables in which a column of integers stands among reals.
/// Such a column may be moved, and nothing else, unless its values say otherwise (PlanarMark): as a number it can be a
/// NaN, or too small for the processor to keep.
template <class Real>
RAYPOOL_INLINE Int<Real> bits_of(const Real& a) {
    return std::bit_cast<Int<Real>>(a);
}
template <class Real>
RAYPOOL_INLINE Real of_bits(const Int<Real>& a) {
    return std::bit_cast<Real>(a);
}

// Lanes and tables.

/// 0, 1, 2, ... by lane.
template <class Real>
RAYPOOL_INLINE Uint32<Real> lane_numbers() {
    return detail::RealOperations<Real>::lane_numbers();
}

/// The first `count` lanes.
template <class Real>
RAYPOOL_INLINE Mask<Real> lanes_before(std::size_t count) {
    return from_uint32<Real>(lane_numbers<Real>()) < Real(static_cast<ScalarOf<Real>>(count));
}

/// No lane may be NaN.
template <class Real>
RAYPOOL_INLINE ScalarOf<Real> greatest_lane(const Real& v) {
    return detail::RealOperations<Real>::greatest_lane(v);
}

/// Of `from[0]`, `from[1]`, ... by lane, where a register begins.
template <class Real>
RAYPOOL_INLINE Real load_aligned(const ScalarOf<Real>* from) {
    return detail::RealOperations<Real>::load(from);
}

/// compress_store() of many registers of Real's lanes with the same bits: LanePacker(bits), then store(target,
/// register); or pack(register), which returns the register that would be stored: its first lanes are those of `bits`.
template <class Real>
using LanePacker = detail::LanePacker<Real>;

/// table[which[lane]] of `size` scalars, as many as fill a register or half of one; `which` is below `size`.
template <int size, class Real>
RAYPOOL_INLINE Real pick(const ScalarOf<Real>* table, const Uint32<Real>& which) {
    return detail::RealOperations<Real>::template pick<size>(table, which);
}

/// Rows of `count` scalars, a multiple of four, that begin at table[offset[lane]], transposed: column[k] =
/// table[offset[lane] + k]. All lanes' offsets must be in the table.
template <int count, class Real>
RAYPOOL_INLINE void load_rows_at(const ScalarOf<Real>* table, const std::uint32_t* offset, Real* column) {
    static_assert(count % 4 == 0);
    detail::RealOperations<Real>::template load_rows_at<count>(table, offset, column);
}

/// Row `row_id[lane]` of a table whose rows are `stride` scalars long: column[k] = table[row_id * stride + k].
/// `count` is a multiple of four; every row id, also of lanes that the caller will ignore, must be in the table.
template <int count, class Real>
RAYPOOL_INLINE void load_rows(const ScalarOf<Real>* table, int stride, const Int<Real>& row_id, Real* column) {
    static_assert(count % 4 == 0);
    detail::RealOperations<Real>::template load_rows<count>(table, stride, row_id, column);
}

/// The inverse of load_rows for consecutive rows: row[lane * count + k] = column[k] of that lane.
template <int count, class Real>
RAYPOOL_INLINE void store_rows(ScalarOf<Real>* rows, const Real* column) {
    static_assert(count % 4 == 0);
    detail::RealOperations<Real>::template store_rows<count>(rows, column);
}

}  // namespace raypool
