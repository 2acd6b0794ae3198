/// The methods that kernels use where rounding decides between an image and garbage.
///
/// Kernels call them by the variant that they are compiled for (SceneNeeds::variant). Every engine is variant 0, which
/// is here. An experiment may specialise Methods for a variant of its own, and so see what another method does to an
/// image: bench/stability/naive_engines.cpp does.
#pragma once

#include "core/shapes.h"
#include "core/textures.h"

namespace raypool {

template <std::uint8_t variant>
struct Methods {
    template <class Real>
    RAYPOOL_INLINE static Real sphere_distance(const Vec3<Real>& origin, const Vec3<Real>& direction,
                                               const Vec3<Real>& center, const Real& radius,
                                               const Mask<Real>& is_leaving) {
        return raypool::sphere_distance<Real>(origin, direction, center, radius, is_leaving);
    }
    template <class Real>
    RAYPOOL_INLINE static Mask<Real> is_odd_cell(const Vec3<Real>& p, const Vec3<Real>& outward,
                                                 const Split<Real>& scale) {
        return raypool::is_odd_cell<Real>(p, outward, scale);
    }
};

}  // namespace raypool
