/// Moving spheres as one would write them at first. The engines' way is center_at() (core/geometry/shapes.h).
#pragma once

#include "core/math/vec.h"

namespace raypool::naive {

/// (1 - t) a + t b: exact at both ends, but it moves a sphere that stands still.
template <class Real>
RAYPOOL_INLINE Real blend(const Real& a, const Real& b, const Real& time) {
    return (Real(1) - time) * a + time * b;
}

}  // namespace raypool::naive
