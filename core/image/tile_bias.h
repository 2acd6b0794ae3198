/// Where one image is brighter than another beyond what the noise of their pixels explains.
///
/// Called by `raypool diff` and by tests. Two renders of different seeds differ everywhere; a bias is what does not
/// average out over a tile of pixels.
///
/// The test is Student's, of the differences of a tile's pixels. It holds where those differences are as likely one way
/// as the other: for two images of as many samples a pixel, however heavy the tails of their noise. An image of fewer
/// samples is darker in most of its pixels where light is rare, and much brighter in a few or in none; so of two images
/// of different numbers of samples, only the one of fewer being the brighter is evidence.
#pragma once

#include <cstdint>
#include <optional>

#include "core/image/image.h"

namespace raypool {

/// The tile that stands out most.
struct TileBias {
    std::int64_t x_begin = 0, x_end = 0;  ///< its pixels are [x_begin, x_end) by [y_begin, y_end)
    std::int64_t y_begin = 0, y_end = 0;
    std::int64_t pixel_count = 0;  ///< of these, finite in both images
    double difference = 0;         ///< mean of a - b over these pixels and their channels
    double t = 0;                  ///< that over its standard error; infinite where every pixel differs by the same
    double p_value = 1;            ///< of the tile by itself, two-sided
    std::int64_t tile_count = 0;
    double image_p_value = 1;  ///< probability that chance makes one of tile_count tiles so different (Sidak)
};

/// Least edge of a tile; the image is divided into as many equal ones as there is room for.
inline constexpr std::int64_t kTileEdge = 16;

/// The differences are of pixels, each the mean of its channels; pixels are taken as independent. A surface that is
/// seen brighter in part of the tile only makes the standard error larger and t smaller. A p-value is at least 2^(1 -
/// n), the chance that n differences all have one sign. Pixels that are not finite in both images are left out. No
/// value where no tile has two pixels left, or where no pixel of any tile differs. InputError if sizes differ.
std::optional<TileBias> greatest_tile_bias(const Image& a, const Image& b);

/// How the numbers of samples a pixel of two images compare.
enum class SampleCounts : std::uint8_t { Unknown, Equal, FirstHasFewer, SecondHasFewer };

/// What a TileBias says. Beyond chance is an image_p_value below 1 %.
enum class BiasVerdict : std::uint8_t {
    Chance,
    Bias,
    BiasIfEqual,  ///< beyond chance, if both images have as many samples a pixel
    RareLight,    ///< beyond chance, but as an image looks that has not met rare light often enough
};

BiasVerdict bias_verdict(const TileBias& bias, SampleCounts counts);

}  // namespace raypool
