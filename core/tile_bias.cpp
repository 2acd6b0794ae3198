#include "core/tile_bias.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/image_diff.h"

namespace raypool {
namespace {

constexpr double kChance = 0.01;

/// Mean and spread of the differences of a tile's pixels.
void measure(const Image& a, const Image& b, TileBias& tile) {
    double count = 0, mean = 0, squares = 0;  // Welford's
    for (std::int64_t y = tile.y_begin; y < tile.y_end; ++y) {
        for (std::int64_t x = tile.x_begin; x < tile.x_end; ++x) {
            const auto first = static_cast<std::size_t>(3 * (y * a.width + x));
            double difference = 0;
            for (std::size_t c = first; c < first + 3; ++c)
                difference += (static_cast<double>(a.rgb[c]) - static_cast<double>(b.rgb[c])) / 3;
            if (!std::isfinite(difference)) continue;
            ++count;
            const double step = difference - mean;
            mean += step / count;
            squares += step * (difference - mean);
        }
    }
    tile.difference = mean;
    if (mean == 0 || count < 2) return;
    tile.z = mean / std::sqrt(squares / (count - 1) / count);
}

}  // namespace

double sidak_limit(std::int64_t count, double chance) {
    const double each = -std::expm1(std::log1p(-chance) / static_cast<double>(count));
    double low = 0, high = 40;
    for (int i = 0; i < 60; ++i) {
        const double z = 0.5 * (low + high);
        (std::erfc(z / std::sqrt(2.0)) > each ? low : high) = z;
    }
    return high;
}

TileBias greatest_tile_bias(const Image& a, const Image& b) {
    check_same_size(a, b);
    const std::int64_t columns = std::max<std::int64_t>(1, a.width / kTileEdge);
    const std::int64_t rows = std::max<std::int64_t>(1, a.height / kTileEdge);
    TileBias greatest;
    for (std::int64_t row = 0; row < rows; ++row) {
        for (std::int64_t column = 0; column < columns; ++column) {
            TileBias tile;
            tile.x_begin = column * a.width / columns;
            tile.x_end = (column + 1) * a.width / columns;
            tile.y_begin = row * a.height / rows;
            tile.y_end = (row + 1) * a.height / rows;
            measure(a, b, tile);
            if (greatest.x_end == 0 || std::abs(tile.z) > std::abs(greatest.z)) greatest = tile;
        }
    }
    greatest.tile_count = rows * columns;
    greatest.z_limit = sidak_limit(greatest.tile_count, kChance);
    return greatest;
}

}  // namespace raypool
