#include "core/film/framebuffer.h"

#include <algorithm>

#include <fmt/format.h>
#include <xxhash.h>

#include "core/base/error.h"

namespace raypool {

namespace {
/// The least k with 2^k >= value, for value > 0.
int ceil_log2(double value) {
    int exponent = 0;
    const double mantissa = std::frexp(value, &exponent);  // value = mantissa 2^exponent, mantissa in [1/2, 1)
    return mantissa == 0.5 ? exponent - 1 : exponent;
}
constexpr double kLeastMaxRadiance = 0x1p-20;  ///< a black scene still has a step

/// Cells have numbers of 32 bits.
std::size_t cells_of(std::int64_t pixels, Halves halves) {
    if (halves == Halves::Together) return static_cast<std::size_t>(pixels);
    if (pixels > std::int64_t{1} << 31U)
        throw InputError(
            fmt::format("--target-error and --aovs: take an image of at most 2^31 pixels, not {}", pixels));
    return 2 * static_cast<std::size_t>(pixels);
}
}  // namespace

FixedPoint FixedPoint::make(std::int64_t spp, double max_radiance, double parts) {
    const int limit_bits = ceil_log2(std::max(max_radiance, kLeastMaxRadiance)) + 1;
    const int spp_bits = ceil_log2(static_cast<double>(std::max(spp, kExtensibleSamples)));
    const int part_bits = ceil_log2(parts);
    return {62 - limit_bits - spp_bits - part_bits, std::ldexp(1.0, limit_bits)};
}

Framebuffer::Framebuffer(std::int64_t width, std::int64_t height, const FixedPoint& fixed, Halves halves)
    : width_(width), height_(height), fixed_(fixed), halves_(halves), sums_(3 * cells_of(width * height, halves)) {}

FixedRgb Framebuffer::sum(std::size_t pixel) const {
    if (!has_halves()) return {sums_[3 * pixel], sums_[3 * pixel + 1], sums_[3 * pixel + 2]};
    const std::int64_t* both = &sums_[6 * pixel];
    return {both[0] + both[3], both[1] + both[4], both[2] + both[5]};
}

std::string Framebuffer::hash() const {
    const std::array<std::int64_t, 3> shape{width_, height_, fixed_.fraction_bits};
    const XXH64_hash_t seed = XXH3_64bits(shape.data(), sizeof(shape));
    return fmt::format("{:016x}", XXH3_64bits_withSeed(sums_.data(), sums_.size() * sizeof(std::int64_t), seed));
}

Framebuffer Framebuffer::together() const {
    Framebuffer joined(width_, height_, fixed_);
    for (std::size_t pixel = 0; pixel < joined.cell_count(); ++pixel)
        joined.add(static_cast<std::int64_t>(pixel), sum(pixel));
    return joined;
}

Framebuffer Framebuffer::cut(const PixelWindow& window) const {
    RAYPOOL_CHECK(0 <= window.x_begin && window.x_end <= width_ && 0 <= window.y_begin && window.y_end <= height_,
                  "a part lies within the whole");
    Framebuffer part(window.x_end - window.x_begin, window.y_end - window.y_begin, fixed_, halves_);
    const auto of_a_pixel = static_cast<std::ptrdiff_t>(sums_.size()) / (width_ * height_);
    for (std::int64_t y = 0; y < part.height_; ++y)
        std::copy_n(sums_.begin() + ((window.y_begin + y) * width_ + window.x_begin) * of_a_pixel,
                    part.width_ * of_a_pixel, part.sums_.begin() + y * part.width_ * of_a_pixel);
    return part;
}

Image Framebuffer::image(std::int64_t sample_count) const {
    Image image(width_, height_);
    const double scale = 1 / (fixed_.scale() * static_cast<double>(std::max<std::int64_t>(sample_count, 1)));
    for (std::size_t i = 0; i < image.rgb.size(); ++i)
        image.rgb[i] = static_cast<float>(static_cast<double>(sum(i / 3)[i % 3]) * scale);
    return image;
}

Image Framebuffer::image(std::span<const std::int32_t> sample_counts) const {
    Image image(width_, height_);
    for (std::size_t i = 0; i < image.rgb.size(); ++i)
        image.rgb[i] = static_cast<float>(static_cast<double>(sum(i / 3)[i % 3]) /
                                          (fixed_.scale() * static_cast<double>(sample_counts[i / 3])));
    return image;
}

}  // namespace raypool
