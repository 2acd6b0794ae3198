/// What a limit of depth cuts off: paths that are still under way, and the light that they would have brought.
///
/// Random numbers are keyed, so the image at a limit and the deep image are made of the same paths: their difference is
/// exactly the light cut off, without noise of its own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace raypool::studies {

/// Sums of two halves of the samples of an image, as the framebuffer keeps them: equal counts, independent paths.
struct Halves {
    std::vector<std::int64_t> first, second;
};

/// In radiance, where `scale` is the framebuffer's and each half has `half_spp` samples a pixel.
struct Loss {
    double relative = 0;     ///< light cut off over all light of the deep image; 0 for a black one
    double paired_rmse = 0;  ///< between the two images as they are; holds the noise of rare bright paths too
    double rmse = 0;         ///< of the expected images: the error that more samples would not mend
};
/// The images hold at least one pixel. The expected square of what a pixel loses is estimated by the product of the two
/// halves, which is free of bias since they are independent.
Loss truncation_loss(const Halves& deep, const Halves& cut, double scale, std::int64_t half_spp);

/// RMSE of an image of `spp` samples a pixel that is due to chance, from how far the two halves lie apart.
double noise_rmse(const Halves& image, double scale, std::int64_t half_spp, std::int64_t spp);

/// Share of paths with more than d segments, from the segments at limits d and d + 1.
double alive_share(std::int64_t segments, std::int64_t segments_one_deeper, std::int64_t paths);

}  // namespace raypool::studies
