/// Whether an image is another sample of what an engine renders, where it need not be the same to the bit.
#pragma once

#include <cmath>

#include "core/film/framebuffer.h"

namespace raypool::peers {

/// Of two images of the same scene, size, samples and fixed point. Nearly all of their paths are the same, so their
/// difference is far below the noise of either; where it has no bias, its mean over the pixels is a few standard errors
/// at most.
struct MeanDifference {
    double relative = 0;          ///< of the mean of an image to that of the expected one, less 1
    double standard_errors = 0;   ///< of the mean difference of a pixel, were there no bias; signed
    double differing_pixels = 0;  ///< their share, in [0, 1]

    static constexpr double kMostStandardErrors = 4;
    [[nodiscard]] bool is_noise() const { return std::abs(standard_errors) <= kMostStandardErrors; }
};

/// A pixel counts by the sum of its channels. Images of different sizes are a bug.
MeanDifference mean_difference(const Framebuffer& image, const Framebuffer& expected);

}  // namespace raypool::peers
