/// Arbitrary output variables (AOVs): what a pixel shows beside its radiance, for denoisers, compositing and a look at
/// where an image is noisy.
///
/// First hits are those of the camera rays of the samples that made the image, traced once more after the render, one
/// by one: no engine knows of them, and an image without them does not pay for them. Variance comes from the
/// framebuffer's two halves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/film/framebuffer.h"
#include "core/image/image_file.h"
#include "core/runtime/settings.h"
#include "core/shading/compiled_scene.h"

namespace raypool {

/// Which samples of which pixels an image was made of.
struct ImageSamples {
    PixelWindow window;      ///< the pixels, a part of the image
    std::int64_t first = 0;  ///< samples [first, end) of each, or ...
    std::int64_t end = 0;
    std::span<const std::int32_t> counts = {};  ///< ... so many of each pixel of the whole image, from 0 on

    [[nodiscard]] std::int64_t begin_of(std::size_t) const { return counts.empty() ? first : 0; }
    [[nodiscard]] std::int64_t end_of(std::size_t pixel) const { return counts.empty() ? end : counts[pixel]; }
};

/// What the camera rays of the samples meet first, as channels of an EXR file. All are means over a pixel's samples,
/// but Z:
///   A                   the share of samples that meet a surface, in [0, 1]
///   Z                   the distance from the camera (from the point on its lens) in units of the scene, a mean over
///                       the samples that meet a surface; infinite where none does
///   N.X, N.Y, N.Z       the unit normal of shading on the side of the camera; 0 where nothing is met
///   albedo.R, .G, .B    the share of light that the surface sends on: a diffuse surface's or a metal's colour with its
///                       texture, 1 of glass, 0 of emitters and where nothing is met
/// The same for any number of threads. Needs 32 bytes a pixel of the window.
template <class Scalar>
std::vector<ImageChannel> first_hit_channels(const CompiledScene<Scalar>& scene, const ImageSettings& settings,
                                             const ImageSamples& samples, int threads);

extern template std::vector<ImageChannel> first_hit_channels(const CompiledScene<float>&, const ImageSettings&,
                                                             const ImageSamples&, int);
extern template std::vector<ImageChannel> first_hit_channels(const CompiledScene<double>&, const ImageSettings&,
                                                             const ImageSamples&, int);

/// How many samples pixels have, and how sure they are. The framebuffer is that of the whole image, with halves apart:
///   samples                the number in a pixel
///   variance.R, .G, .B     of the pixel's mean, in squared radiance: right on average where samples are independent
///                          (half_variance.h); infinite where a half has no sample
/// Needs 16 bytes a pixel of the window.
std::vector<ImageChannel> variance_channels(const Framebuffer& framebuffer, const ImageSamples& samples);

}  // namespace raypool
