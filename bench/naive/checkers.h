/// Checkers as books have them. The engines' way is cell_parity() (core/shading/textures.h).
#pragma once

#include <cmath>

#include "core/math/vec.h"

namespace raypool::naive {

/// Rounds towards zero, so the cells on both sides of zero are one.
template <class Real>
RAYPOOL_INLINE Real truncated_parity(const Real& x, const Real& scale) {
    const Real scaled = x * scale;
    const Real cell = copysign(floor(abs(scaled)), scaled);
    return abs(cell - Real(2) * copysign(floor(abs(cell * Real(0.5F))), cell));
}

/// "Ray Tracing: The Next Week", chapter 4.3: the floor of a product that was rounded before.
template <class Real>
RAYPOOL_INLINE Real floored_parity(const Real& x, const Real& scale) {
    const Real cell = floor(x * scale);
    return cell - Real(2) * floor(cell * Real(0.5F));
}

}  // namespace raypool::naive
