/// What a limit of depth cuts off: paths that are still under way, and the light that they would have brought.
///
/// Random numbers are keyed, so the image at a limit and the deep image are made of the same paths: their difference is
/// exactly the light cut off, without noise of its own.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace raypool::studies {

/// Sums of two halves of the samples of an image, as the framebuffer keeps them: equal counts, independent paths.
struct Halves {
    std::vector<std::int64_t> first, second;
};

/// Of a sum that `spp` samples made.
inline double mean_value(std::int64_t sum, double scale, std::int64_t spp) {
    return static_cast<double>(sum) / scale / static_cast<double>(spp);
}

/// In radiance, where `scale` is the framebuffer's and each half has `half_spp` samples a pixel.
struct Loss {
    double relative = 0;     ///< light cut off over all light of the deep image; 0 for a black one
    double paired_rmse = 0;  ///< between the two images as they are; holds the noise of rare bright paths too
    double rmse = 0;         ///< of the expected images: the error that more samples would not mend
};
/// The images hold at least one pixel. The expected square of what a pixel loses is estimated by the product of the two
/// halves, which is free of bias since they are independent.
inline Loss truncation_loss(const Halves& deep, const Halves& cut, double scale, std::int64_t half_spp) {
    double light = 0;
    double lost = 0;
    double lost_squared = 0;
    double product = 0;
    const std::size_t n = deep.first.size();
    for (std::size_t i = 0; i < n; ++i) {
        const double first = mean_value(deep.first[i] - cut.first[i], scale, half_spp);
        const double second = mean_value(deep.second[i] - cut.second[i], scale, half_spp);
        light += mean_value(deep.first[i] + deep.second[i], scale, 2 * half_spp);
        lost += 0.5 * (first + second);
        lost_squared += 0.25 * (first + second) * (first + second);
        product += first * second;
    }
    const auto count = static_cast<double>(n);
    return {light == 0 ? 0 : lost / light, std::sqrt(lost_squared / count), std::sqrt(std::max(product, 0.0) / count)};
}

/// RMSE of an image of `spp` samples a pixel that is due to chance, from how far the two halves lie apart.
inline double noise_rmse(const Halves& image, double scale, std::int64_t half_spp, std::int64_t spp) {
    double squares = 0;
    for (std::size_t i = 0; i < image.first.size(); ++i) {
        const double apart = mean_value(image.first[i] - image.second[i], scale, half_spp);
        squares += apart * apart;
    }
    // The halves differ by twice the variance of a half, which is that of a sample over half_spp.
    const double sample_variance =
        0.5 * squares / static_cast<double>(image.first.size()) * static_cast<double>(half_spp);
    return std::sqrt(sample_variance / static_cast<double>(spp));
}

/// Share of paths with more than d segments, from the segments at limits d and d + 1.
inline double alive_share(std::int64_t segments, std::int64_t segments_one_deeper, std::int64_t paths) {
    return static_cast<double>(segments_one_deeper - segments) / static_cast<double>(paths);
}

}  // namespace raypool::studies
