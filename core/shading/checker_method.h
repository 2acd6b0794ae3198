/// Which cell of a checker a point is in, by the method that kernels are compiled for: as
/// core/geometry/sphere_method.h.
#pragma once

#include "core/shading/textures.h"

namespace raypool {

template <std::uint8_t variant>
struct CheckerMethod {
    template <class Real>
    RAYPOOL_INLINE static Mask<Real> is_odd(const Vec3<Real>& p, const Vec3<Real>& outward,
                                            const TwoParts<Real>& scale) {
        return is_odd_cell<Real>(p, outward, scale);
    }
};

}  // namespace raypool
