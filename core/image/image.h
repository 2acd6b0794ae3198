/// An image in memory: what the framebuffer resolves to and what image files are written from and read into.
///
/// Pixels are linear RGB with the primaries of sRGB, row 0 at the top, three interleaved floats a pixel. Any float is
/// allowed, NaN and infinities included.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raypool {

/// Columns [x_begin, x_end) of rows [y_begin, y_end).
struct PixelWindow {
    std::int64_t x_begin = 0, x_end = 0;
    std::int64_t y_begin = 0, y_end = 0;
    bool operator==(const PixelWindow&) const = default;
};

struct Image {
    Image() = default;
    Image(std::int64_t width, std::int64_t height)
        : width(width), height(height), rgb(static_cast<std::size_t>(width * height * 3)) {}

    /// The three values of the pixel in column x and row y.
    float* pixel(std::int64_t x, std::int64_t y) { return &rgb[static_cast<std::size_t>((y * width + x) * 3)]; }
    const float* pixel(std::int64_t x, std::int64_t y) const {
        return &rgb[static_cast<std::size_t>((y * width + x) * 3)];
    }

    std::int64_t width = 0;
    std::int64_t height = 0;
    std::vector<float> rgb;  ///< width * height * 3 values
};

}  // namespace raypool
