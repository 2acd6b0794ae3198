/// Where one image is brighter than another beyond what the noise of their pixels explains.
///
/// Called by `raypool diff` and by tests. Two renders of different seeds differ everywhere; a bias is what does not
/// average out over a tile of pixels.
#pragma once

#include <cstdint>

#include "core/image.h"

namespace raypool {

/// The tile that stands out most.
struct TileBias {
    std::int64_t x_begin = 0, x_end = 0;  ///< its pixels are [x_begin, x_end) by [y_begin, y_end)
    std::int64_t y_begin = 0, y_end = 0;
    double difference = 0;  ///< mean of a - b over its pixels and channels
    double z = 0;           ///< that over its standard error; infinite where every pixel differs by the same
    std::int64_t tile_count = 0;
    double z_limit = 0;  ///< what the greatest |z| of that many tiles passes by chance in 1 % of cases (Sidak)
};

/// Least edge of a tile; the image is divided into as many equal ones as there is room for.
inline constexpr std::int64_t kTileEdge = 16;

/// The standard error is that of the mean of the pixels' differences, each the mean of its channels: pixels are taken
/// as independent, and so numerous that their mean is normal. A surface that is seen brighter in part of the tile only
/// makes it larger and z smaller. Pixels that are not finite in both images are left out. InputError if sizes differ.
TileBias greatest_tile_bias(const Image& a, const Image& b);

/// The z that the greatest of `count` independent normal variables passes, in absolute value, with probability
/// `chance`.
double sidak_limit(std::int64_t count, double chance);

}  // namespace raypool
