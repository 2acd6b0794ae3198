#include "core/image/image_diff.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/image/colour_map.h"

namespace raypool {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool same_bits(float a, float b) {
    return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

/// (a - b)^2, by the rules in the header.
double squared_error(float a, float b) {
    if (same_bits(a, b)) return 0;
    if (!std::isfinite(a) || !std::isfinite(b)) return kInfinity;
    const double difference = static_cast<double>(a) - b;
    return difference * difference;
}

/// Position of a float among all floats in ascending order, both zeroes at 0.
std::int64_t rank(float value) {
    const auto bits = std::bit_cast<std::int32_t>(value);
    return bits >= 0 ? bits : std::int64_t{std::numeric_limits<std::int32_t>::min()} - bits;
}

std::uint64_t ulp_distance(float a, float b) {
    if (same_bits(a, b)) return 0;
    if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<std::uint64_t>::max();
    return static_cast<std::uint64_t>(std::abs(rank(a) - rank(b)));
}

double mean_square_of_finite(const std::vector<float>& values) {
    double sum = 0;
    for (const float value : values) {
        if (std::isfinite(value)) sum += static_cast<double>(value) * value;
    }
    return sum / static_cast<double>(values.size());
}

std::array<double, 3> channel_means(const Image& image) {
    std::array<double, 3> means{};
    for (std::size_t i = 0; i < image.rgb.size(); ++i) means[i % 3] += image.rgb[i];
    for (double& mean : means) mean /= static_cast<double>(image.width * image.height);
    return means;
}

}  // namespace

void check_same_size(const Image& a, const Image& b) {
    if (a.width != b.width || a.height != b.height) {
        throw InputError(fmt::format("images to compare must have the same size, got {} x {} and {} x {}", a.width,
                                     a.height, b.width, b.height));
    }
}

ImageDiff compare_images(const Image& a, const Image& b) {
    check_same_size(a, b);
    ImageDiff diff;
    diff.mean_a = channel_means(a);
    diff.mean_b = channel_means(b);

    const double floor = 0.01 * mean_square_of_finite(b.rgb);
    double sum = 0, relative_sum = 0;
    bool pixel_differs = false;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        const double error = squared_error(a.rgb[i], b.rgb[i]);
        const double reference = b.rgb[i];
        sum += error;
        if (error > 0) relative_sum += std::isinf(error) ? kInfinity : error / (reference * reference + floor);
        diff.max_abs = std::max(diff.max_abs, std::sqrt(error));
        diff.max_ulp = std::max(diff.max_ulp, ulp_distance(a.rgb[i], b.rgb[i]));

        pixel_differs |= !same_bits(a.rgb[i], b.rgb[i]);
        if (i % 3 == 2) diff.differing_pixels += std::exchange(pixel_differs, false) ? 1 : 0;
    }
    const auto count = static_cast<double>(a.rgb.size());
    diff.mse = sum / count;
    diff.rmse = std::sqrt(diff.mse);
    diff.rel_mse = relative_sum / count;
    diff.psnr = -20 * std::log10(diff.rmse);
    return diff;
}

Image false_colour(const Image& a, const Image& b) {
    check_same_size(a, b);
    constexpr double kDecades = 7;
    constexpr double kDarkest = 0.1;
    Image picture(a.width, a.height);
    for (std::size_t i = 0; i < a.rgb.size(); i += 3) {
        double sum = 0;
        bool is_same = true;
        for (std::size_t c = i; c < i + 3; ++c) {
            sum += squared_error(a.rgb[c], b.rgb[c]);
            is_same &= same_bits(a.rgb[c], b.rgb[c]);
        }
        if (is_same) continue;
        const double error = std::sqrt(sum / 3);
        inferno(std::clamp(1 + std::log10(error) / kDecades, kDarkest, 1.0), &picture.rgb[i]);
    }
    return picture;
}

}  // namespace raypool
