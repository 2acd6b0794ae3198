/// The framebuffer: three int64 fixed-point sums a pixel, interleaved (r, g, b, r, g, b, ...), row 0 at the top.
///
/// Integer addition is exact and has no order, so any engine, schedule or thread count that adds the same samples makes
/// the same bits. A thread that adds must own the pixel meanwhile, or add atomically.
/// The step is 2^-k with k chosen so that no render can overflow: spp samples of the scene's greatest radiance fit. It
/// is the same for all renders of up to 16,384 samples a pixel.
/// On request it keeps the sums of two halves of each pixel's samples apart. Their difference tells what error is left
/// (half_variance.h), is exact and free of order too, and does not ask in how many parts a sample comes.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/film/sample_converter.h"
#include "core/image/image.h"
#include "core/math/path.h"
#include "core/math/real_wide.h"
#include "core/math/vec.h"

namespace raypool {

/// Plain additions are right as long as no two threads add to a pixel.
enum class Addition : bool { Plain, Atomic };

/// Adds to a sum of a pixel.
template <Addition addition, class Sum>
void add_to(Sum& sum, Sum value) {
    if constexpr (addition == Addition::Atomic) {
        std::atomic_ref(sum).fetch_add(value, std::memory_order_relaxed);
    } else {
        sum += value;
    }
}

/// Whether a framebuffer has one sum a pixel, or keeps those of two halves of its samples apart.
enum class Halves : bool { Together, Apart };

/// SampleConverter::convert() of eight samples whose channels are columns, where the processor can: fixed[k][i] of
/// channel k. False, and nothing of use in `fixed`, where it cannot or a sample is bad.
[[nodiscard]] inline bool convert_eight(const SampleConverter& converter, const float* const (&channel)[3],
                                        std::int64_t (&fixed)[3][8]) {
    bool is_good = true;
    for (int k = 0; k < 3; ++k)
        is_good = is_good && isa::round_eight(channel[k], converter.scale(), converter.limit(), fixed[k]);
    return is_good;
}

class Framebuffer {
  public:
    Framebuffer(std::int64_t width, std::int64_t height, const FixedPoint& fixed, Halves halves = Halves::Together);

    [[nodiscard]] std::int64_t width() const { return width_; }
    [[nodiscard]] std::int64_t height() const { return height_; }
    [[nodiscard]] const FixedPoint& fixed_point() const { return fixed_; }
    [[nodiscard]] bool has_halves() const { return halves_ == Halves::Apart; }
    /// The number of pixels, or twice that: cell c has the sums 3 c to 3 c + 2.
    [[nodiscard]] std::size_t cell_count() const { return sums_.size() / 3; }

    /// Adds a sample or a part of one; the cell is cell_of() its pixel.
    template <Addition addition = Addition::Plain>
    void add(std::int64_t cell, const FixedRgb& sample) {
        for (int i = 0; i < 3; ++i) add_to<addition>(sums_[static_cast<std::size_t>(3 * cell + i)], sample[i]);
    }
    [[nodiscard]] std::span<std::int64_t> sums() { return sums_; }
    [[nodiscard]] std::span<const std::int64_t> sums() const { return sums_; }
    /// The sum of all samples of a pixel.
    [[nodiscard]] FixedRgb sum(std::size_t pixel) const;

    /// With one sum a pixel, as if halves had never been apart.
    [[nodiscard]] Framebuffer together() const;
    /// A part of it, as a framebuffer of its own.
    [[nodiscard]] Framebuffer cut(const PixelWindow& window) const;

    /// 16 hexadecimal digits over the size, the step and every sum (XXH3).
    [[nodiscard]] std::string hash() const;

    /// The mean of `sample_count` samples a pixel, linear radiance.
    [[nodiscard]] Image image(std::int64_t sample_count) const;
    /// The same where each pixel has a number of samples of its own, none of them 0.
    [[nodiscard]] Image image(std::span<const std::int32_t> sample_counts) const;

  private:
    std::int64_t width_;
    std::int64_t height_;
    FixedPoint fixed_;
    Halves halves_;
    std::vector<std::int64_t> sums_;
};

}  // namespace raypool
