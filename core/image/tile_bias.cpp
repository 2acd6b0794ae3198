#include "core/image/tile_bias.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <boost/math/distributions/students_t.hpp>

#include "core/image/image_diff.h"

namespace raypool {
namespace {

constexpr double kChance = 0.01;

/// Probability that the mean of `count` >= 2 differences is t standard errors or more away from zero.
double p_value_of(double t, std::int64_t count) {
    const double one_sign = std::exp2(static_cast<double>(1 - count));
    if (std::isinf(t)) return one_sign;
    const boost::math::students_t distribution(static_cast<double>(count - 1));
    return std::max(one_sign, 2 * boost::math::cdf(boost::math::complement(distribution, std::abs(t))));
}

/// Mean and spread of the differences of a tile's pixels. False where there is nothing to estimate from.
bool measure(const Image& a, const Image& b, TileBias& tile) {
    double mean = 0, squares = 0;  // Welford's
    for (std::int64_t y = tile.y_begin; y < tile.y_end; ++y) {
        for (std::int64_t x = tile.x_begin; x < tile.x_end; ++x) {
            const auto first = static_cast<std::size_t>(3 * (y * a.width + x));
            double difference = 0;
            for (std::size_t c = first; c < first + 3; ++c)
                difference += (static_cast<double>(a.rgb[c]) - static_cast<double>(b.rgb[c])) / 3;
            if (!std::isfinite(difference)) continue;
            ++tile.pixel_count;
            const double step = difference - mean;
            mean += step / static_cast<double>(tile.pixel_count);
            squares += step * (difference - mean);
        }
    }
    if (tile.pixel_count < 2 || (mean == 0 && squares == 0)) return false;
    const auto count = static_cast<double>(tile.pixel_count);
    tile.difference = mean;
    tile.t = mean / std::sqrt(squares / (count - 1) / count);
    tile.p_value = p_value_of(tile.t, tile.pixel_count);
    return true;
}

}  // namespace

std::optional<TileBias> greatest_tile_bias(const Image& a, const Image& b) {
    check_same_size(a, b);
    const std::int64_t columns = std::max<std::int64_t>(1, a.width / kTileEdge);
    const std::int64_t rows = std::max<std::int64_t>(1, a.height / kTileEdge);
    std::optional<TileBias> greatest;
    for (std::int64_t row = 0; row < rows; ++row) {
        for (std::int64_t column = 0; column < columns; ++column) {
            TileBias tile;
            tile.x_begin = column * a.width / columns;
            tile.x_end = (column + 1) * a.width / columns;
            tile.y_begin = row * a.height / rows;
            tile.y_end = (row + 1) * a.height / rows;
            if (!measure(a, b, tile)) continue;
            const bool stands_out = !greatest || tile.p_value < greatest->p_value ||
                                    (tile.p_value == greatest->p_value && std::abs(tile.t) > std::abs(greatest->t));
            if (stands_out) greatest = tile;
        }
    }
    if (greatest) {
        greatest->tile_count = rows * columns;
        greatest->image_p_value =
            -std::expm1(static_cast<double>(greatest->tile_count) * std::log1p(-std::min(greatest->p_value, 1.0)));
    }
    return greatest;
}

BiasVerdict bias_verdict(const TileBias& bias, SampleCounts counts) {
    if (bias.image_p_value >= kChance) return BiasVerdict::Chance;
    if (counts == SampleCounts::Unknown) return BiasVerdict::BiasIfEqual;
    const bool is_darker_where_fewer = (counts == SampleCounts::FirstHasFewer && bias.difference < 0) ||
                                       (counts == SampleCounts::SecondHasFewer && bias.difference > 0);
    return is_darker_where_fewer ? BiasVerdict::RareLight : BiasVerdict::Bias;
}

}  // namespace raypool
