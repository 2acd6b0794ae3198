/// Primitive ids of a register of rays, as records keep them and as kernels compare them.
#pragma once

#include "core/geometry/wide_rays.h"

namespace raypool::wavefront {

/// Primitive ids as a record keeps them, in unsigned numbers, as the kernels compare them.
template <Simd Real>
RAYPOOL_INLINE Int<Real> signed_ids(const Uint32<Real>& ids) {
    using Signed = stdx::rebind_simd_t<std::int32_t, Uint32<Real>>;
    return stdx::static_simd_cast<Int<Real>>(stdx::static_simd_cast<Signed>(ids));
}
/// The inverse, for a scalar too.
template <class Real>
RAYPOOL_INLINE Uint32<Real> id_bits(const Int<Real>& id) {
    if constexpr (Simd<Real>) {
        return stdx::static_simd_cast<Uint32<Real>>(id);
    } else {
        return static_cast<std::uint32_t>(id);
    }
}
/// Whole numbers by the bits of a mask.
template <class Real>
RAYPOOL_INLINE Uint32<Real> select_bits(unsigned bits, const Uint32<Real>& yes, const Uint32<Real>& no) {
    if constexpr (Simd<Real>) {
        return Uint32<Real>([&](auto i) { return (bits >> i & 1U) != 0 ? lane(yes, i) : lane(no, i); });
    } else {
        return bits != 0 ? yes : no;
    }
}
template <Simd Real>
RAYPOOL_INLINE WideRays<Real> wide_rays(const Ray<Real>& ray, const Uint32<Real>& leaving_id) {
    return {ray, ray_inverse<Real>(ray.direction), signed_ids<Real>(leaving_id)};
}

}  // namespace raypool::wavefront
