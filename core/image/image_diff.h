/// How far two images of the same size lie apart, as figures and as a picture.
///
/// Called by `raypool diff` and by tests. Values compare bit by bit: what has the same bits differs by nothing, a NaN
/// included; any other pair with a NaN or an infinity in it is an infinite error.
#pragma once

#include <array>
#include <cstdint>

#include "core/image/image.h"

namespace raypool {

/// The errors are over all channel values of all pixels.
struct ImageDiff {
    std::array<double, 3> mean_a{};  ///< mean of each channel
    std::array<double, 3> mean_b{};
    std::int64_t differing_pixels = 0;  ///< pixels with any bit different
    double mse = 0;                     ///< mean squared error
    double rmse = 0;                    ///< its root
    double rel_mse = 0;                 ///< mean of (a - b)^2 / (b^2 + 1 % of the mean of b^2); b is the reference
    double psnr = 0;                    ///< decibels for a peak of 1; infinite for equal values
    double max_abs = 0;
    std::uint64_t max_ulp = 0;  ///< floats between a and b, -0 and +0 being one; the largest integer for a NaN
};

/// InputError if the sizes differ.
void check_same_size(const Image& a, const Image& b);

/// InputError as above.
ImageDiff compare_images(const Image& a, const Image& b);

/// The error of each pixel (root mean square over its channels) in the colours of "inferno", on a logarithmic scale
/// that is the same for every picture: dark violet for 1e-7, orange for an 8-bit code value, pale yellow for 1 and
/// more. Pixels with the same bits are black and no others are. InputError as above.
Image false_colour(const Image& a, const Image& b);

}  // namespace raypool
