/// Each image format as functions between pixels and the bytes of a file; called by image_file.cpp and the fuzz
/// targets.
///
/// They throw std::exceptions that say what is wrong with the bytes, for the caller to put the file's name in front.
/// Decoders trust nothing in the bytes: dimensions are checked against the limits and, as far as the format allows,
/// against the number of bytes, before memory is taken for the pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/image/image.h"
#include "core/image/image_file.h"

namespace raypool {

using Bytes = std::vector<std::byte>;
using BytesView = std::span<const std::byte>;

Bytes encode_png(const Image& image, const ImageAttributes& attributes);
ImageContents decode_png(BytesView bytes, std::int64_t max_side, std::int64_t max_pixels);

Bytes encode_exr(const Image& image, const ImageAttributes& attributes, const ExrExtras& extras);
ImageContents decode_exr(BytesView bytes, const ImageLimits& limits = {});

Bytes encode_pfm(const Image& image);
ImageContents decode_pfm(BytesView bytes, const ImageLimits& limits = {});

/// An image that is shown whole.
inline ImageContents whole(Image image) {
    ImageContents contents;
    contents.data_window = contents.display_window = {0, image.width, 0, image.height};
    contents.image = std::move(image);
    return contents;
}

inline void check_image_size(std::int64_t width, std::int64_t height, std::int64_t max_side,
                             std::int64_t max_pixels = kMaxImagePixels, const char* what = "width and height") {
    if (width < 1 || height < 1 || width > max_side || height > max_side || width * height > max_pixels) {
        throw std::runtime_error(fmt::format("{} must be within [1, {}] and at most {} pixels, got {} x {}", what,
                                             max_side, max_pixels, width, height));
    }
}

}  // namespace raypool
