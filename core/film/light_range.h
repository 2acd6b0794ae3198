/// The range of light in a scene: whether the sums' step is fine enough for its dimmest part.
///
/// The step follows the brightest (framebuffer.h), and a sample is rounded to it. What a sample of radiance x can lose
/// or gain is half a step; where that is more than kFineStep of x, dim parts of an image are wrong by as much.
#pragma once

#include "core/film/framebuffer.h"
#include "core/scene/scene.h"

namespace raypool {

inline constexpr double kFineStep = 1e-3;

/// The least channel above zero of the sky and of what shapes emit; 0 where all is black.
double dimmest_light(const Scene& scene);

/// By how much, relatively, rounding changes a sample of the given radiance at most; 0 for no radiance.
inline double rounding_of(double radiance, const FixedPoint& fixed) {
    return radiance > 0 ? 0.5 / (fixed.scale() * radiance) : 0;
}

}  // namespace raypool
