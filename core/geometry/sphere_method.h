/// The distance to a sphere, by the method that kernels are compiled for (Features::variant).
///
/// Every engine is variant 0, which is here. An experiment may specialise another variant, and so see what another
/// method does to an image: bench/stability/naive_engines.cpp does. Streams and pairs call sphere_distance() itself.
#pragma once

#include "core/geometry/shapes.h"

namespace raypool {

template <std::uint8_t variant>
struct SphereMethod {
    template <class Real>
    RAYPOOL_INLINE static Real distance(const Vec3<Real>& origin, const Vec3<Real>& direction, const Vec3<Real>& center,
                                        const Real& radius, const Mask<Real>& is_leaving) {
        return sphere_distance<Real>(origin, direction, center, radius, is_leaving);
    }
};

}  // namespace raypool
