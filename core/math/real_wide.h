/// The register half of core/math/real.h: std::experimental::simd of floats and doubles, on AVX2, AVX-512 and NEON.
#pragma once

#include <experimental/simd>

#include "core/math/real_scalar.h"
#if defined(__aarch64__)
#include "core/math/simd_neon.h"
#elif defined(__AVX512F__)
#include "core/math/simd_avx512.h"
#else
#include "core/math/simd_avx2.h"
#endif

namespace raypool {

namespace stdx = std::experimental;

template <class T>
requires stdx::is_simd_v<T>
inline constexpr bool kIsSimd<T> = true;
template <class T>
requires stdx::is_simd_mask_v<T>
inline constexpr bool kIsSimdMask<T> = true;

/// A vector of N floats or doubles that fills one register.
template <class Scalar, int N>
using Wide = stdx::simd<Scalar, stdx::simd_abi::deduce_t<Scalar, N>>;

namespace detail {

template <Simd Real>
struct RealTraits<Real> {
    using Scalar = typename Real::value_type;
    using Mask = typename Real::mask_type;
    using Int = stdx::rebind_simd_t<typename RealTraits<Scalar>::Int, Real>;
    using Uint32 = stdx::simd<std::uint32_t, stdx::simd_abi::deduce_t<std::uint32_t, Real::size()>>;
    static constexpr int kLanes = Real::size();
};

template <Simd V>
using IntegerRegister = typename isa::Registers<float, sizeof(V)>::Integer;
template <Simd V>
using RealRegister = typename isa::Registers<typename V::value_type, sizeof(V)>::Real;
template <Simd V>
RAYPOOL_INLINE auto reg(const V& v) {
    return std::bit_cast<RealRegister<V>>(v);
}
/// A mask as its instruction set keeps it: a bit a lane in AVX-512, a register of ones and zeros elsewhere.
template <SimdMask M>
RAYPOOL_INLINE auto mask_register(const M& m) {
    if constexpr (sizeof(M) == 1) {
        return std::bit_cast<std::uint8_t>(m);
    } else if constexpr (sizeof(M) == 2) {
        return std::bit_cast<std::uint16_t>(m);
    } else {
        return std::bit_cast<typename isa::Registers<float, sizeof(M)>::Integer>(m);
    }
}

}  // namespace detail

template <SimdMask M>
RAYPOOL_INLINE unsigned mask_bits(const M& m) {
    return isa::mask_bits<M::size()>(detail::mask_register(m));
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

template <SimdMask M, Simd V>
RAYPOOL_INLINE V select(const M& m, const V& yes, const V& no) {
    using Register = detail::IntegerRegister<V>;
    return std::bit_cast<V>(isa::blend<sizeof(typename V::value_type)>(
        detail::mask_register(m), std::bit_cast<Register>(yes), std::bit_cast<Register>(no)));
}

template <Simd V>
RAYPOOL_INLINE V mad(const V& a, const V& b, const V& c) {
    return std::bit_cast<V>(isa::fmadd(detail::reg(a), detail::reg(b), detail::reg(c)));
}
template <Simd V>
RAYPOOL_INLINE V nmad(const V& a, const V& b, const V& c) {
    return std::bit_cast<V>(isa::fnmadd(detail::reg(a), detail::reg(b), detail::reg(c)));
}

template <Simd V>
RAYPOOL_INLINE auto lane(const V& v, int i) {
    return static_cast<typename V::value_type>(v[i]);
}

/// A register is compressed and then stored whole: a compressing store is slow.
template <Simd V, class T>
RAYPOOL_INLINE void compress_store(T* target, const V& v, unsigned bits) {
    const auto lanes = std::bit_cast<detail::IntegerRegister<V>>(v);
    if constexpr (sizeof(T) == 4) {
        std::bit_cast<V>(isa::compress32(lanes, bits)).copy_to(target, stdx::element_aligned);
    } else {
        std::bit_cast<V>(isa::compress64(lanes, bits)).copy_to(target, stdx::element_aligned);
    }
}

namespace detail {

template <Simd Real>
struct RealOperations<Real> {
    using Scalar = typename RealTraits<Real>::Scalar;
    using Int = typename RealTraits<Real>::Int;
    using Uint32 = typename RealTraits<Real>::Uint32;
    using Register = IntegerRegister<Real>;
    static constexpr int kLanes = Real::size();

    RAYPOOL_INLINE static Real min(const Real& a, const Real& b) {
        return std::bit_cast<Real>(isa::min(reg(a), reg(b)));
    }
    RAYPOOL_INLINE static Real max(const Real& a, const Real& b) {
        return std::bit_cast<Real>(isa::max(reg(a), reg(b)));
    }
    RAYPOOL_INLINE static Real sqrt(const Real& a) { return std::bit_cast<Real>(isa::sqrt(reg(a))); }
    RAYPOOL_INLINE static Real floor(const Real& a) { return std::bit_cast<Real>(isa::floor(reg(a))); }
    RAYPOOL_INLINE static Real abs(const Real& a) {
        return std::bit_cast<Real>(std::bit_cast<Register>(a) & ~std::bit_cast<Register>(Real(-0.0F)));
    }
    RAYPOOL_INLINE static Real copysign(const Real& magnitude, const Real& sign) {
        const Register sign_bit = std::bit_cast<Register>(Real(-0.0F));
        return std::bit_cast<Real>((std::bit_cast<Register>(magnitude) & ~sign_bit) |
                                   (std::bit_cast<Register>(sign) & sign_bit));
    }

    RAYPOOL_INLINE static Int to_int(const Real& a) { return stdx::static_simd_cast<Int>(a); }
    RAYPOOL_INLINE static Real to_real(const Int& a) { return stdx::static_simd_cast<Real>(a); }
    RAYPOOL_INLINE static Real from_uint32(const Uint32& a) {
        using Signed = stdx::rebind_simd_t<std::int32_t, Uint32>;
        return stdx::static_simd_cast<Real>(stdx::static_simd_cast<Signed>(a));
    }
    RAYPOOL_INLINE static Uint32 lane_numbers() {
        return Uint32([](auto i) { return static_cast<std::uint32_t>(i); });
    }
    RAYPOOL_INLINE static Scalar greatest_lane(const Real& v) { return isa::greatest(reg(v)); }
    RAYPOOL_INLINE static Real load(const Scalar* from) { return Real(from, stdx::vector_aligned); }

    template <int size>
    RAYPOOL_INLINE static Real pick(const Scalar* table, const Uint32& which) {
        return std::bit_cast<Real>(isa::pick<size>(table, std::bit_cast<IntegerRegister<Uint32>>(which)));
    }
    template <int count>
    RAYPOOL_INLINE static void load_rows_at(const Scalar* table, const std::uint32_t* offset, Real* column) {
        if constexpr (std::same_as<Scalar, float>) {
            const auto load_block = [&]<int columns>(int first) {
                const float* rows[kLanes];
                for (int i = 0; i < kLanes; ++i) rows[i] = table + first + offset[i];
                RealRegister<Real> block[columns];
                isa::transpose_rows(rows, block);
                for (int k = 0; k < columns; ++k) column[first + k] = std::bit_cast<Real>(block[k]);
            };
            int first = 0;
            if constexpr (kLanes == 16) {
                for (; first + 8 <= count; first += 8) load_block.template operator()<8>(first);
            }
            for (; first < count; first += 4) load_block.template operator()<4>(first);
        } else {
            for (int k = 0; k < count; ++k) column[k] = Real([&](auto i) { return table[offset[i] + k]; });
        }
    }
    template <int count>
    RAYPOOL_INLINE static void load_rows(const Scalar* table, int stride, const Int& row_id, Real* column) {
        if constexpr (std::same_as<Scalar, float>) {
            alignas(64) std::uint32_t offset[kLanes];  // kMostBoxes rows of 16 scalars are 2^28
            stdx::static_simd_cast<Uint32>(row_id * Int(stride)).copy_to(offset, stdx::vector_aligned);
            load_rows_at<count>(table, offset, column);
        } else {
            for (int k = 0; k < count; ++k) column[k] = Real([&](auto i) { return table[row_id[i] * stride + k]; });
        }
    }
    template <int count>
    RAYPOOL_INLINE static void store_rows(Scalar* rows, const Real* column) {
        if constexpr (std::same_as<Scalar, float>) {
            for (int first = 0; first < count; first += 4) {
                RealRegister<Real> block[4];
                for (int k = 0; k < 4; ++k) block[k] = reg(column[first + k]);
                isa::store_transposed(block, rows + first, count);
            }
        } else {
            for (int k = 0; k < count; ++k)
                for (int i = 0; i < kLanes; ++i) rows[i * count + k] = lane(column[k], i);
        }
    }
};

/// Where a lane goes is found once; lanes of 32 bits then take one instruction a register.
template <Simd Real>
class LanePacker<Real> {
    using Uint32 = typename RealTraits<Real>::Uint32;

  public:
    RAYPOOL_INLINE explicit LanePacker(unsigned bits) : bits_(bits) {
        if constexpr (kIsPermuted) {
            const auto numbers = std::bit_cast<IntegerRegister<Uint32>>(RealOperations<Real>::lane_numbers());
            order_ = std::bit_cast<Uint32>(isa::compress32(numbers, bits));
        }
    }
    template <class V, class T>
    RAYPOOL_INLINE void store(T* target, const V& v) const {
        if constexpr (kIsPermuted) {
            pack(v).copy_to(target, stdx::element_aligned);
        } else {
            compress_store(target, v, bits_);
        }
    }
    template <class V>
    RAYPOOL_INLINE V pack(const V& v) const {
        if constexpr (kIsPermuted) {
            using Register = IntegerRegister<V>;
            return std::bit_cast<V>(isa::permute32(std::bit_cast<Register>(v), std::bit_cast<Register>(order_)));
        } else {
            alignas(64) typename V::value_type lanes[V::size()];
            compress_store(lanes, v, bits_);
            return V(lanes, stdx::element_aligned);
        }
    }

  private:
    static constexpr bool kIsPermuted = sizeof(typename RealTraits<Real>::Scalar) == 4;
    unsigned bits_;
    Uint32 order_;
};

}  // namespace detail

}  // namespace raypool
