/// The framebuffer: three int64 fixed-point sums a pixel, interleaved (r, g, b, r, g, b, ...), row 0 at the top.
///
/// Integer addition is exact and has no order, so any engine, schedule or thread count that adds the same samples makes
/// the same bits. A thread that adds must own the pixel meanwhile, or add atomically.
/// The step is 2^-k with k chosen so that no render can overflow: spp samples of the scene's greatest radiance fit. It
/// is the same for all renders of up to 16,384 samples a pixel.
/// On request it also keeps the sum of squares of the samples of each pixel, exact and free of order too: the second
/// moment, from which adaptive.h estimates what error is left. It has no step of its own, so that no precision is lost
/// whatever else is in the scene.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "core/math/real_wide.h"
#include "core/math/vec.h"

namespace raypool {

/// What was wrong with samples; summed over threads. In a sound render all are zero.
struct SampleStatistics {
    std::int64_t non_finite = 0;  ///< samples with a NaN or infinite channel, left out whole
    std::int64_t clamped = 0;     ///< channels above the limit, or below zero, cut to it
    double clamped_energy = 0;    ///< radiance that the cut took away, summed

    void add(const SampleStatistics& other) {
        non_finite += other.non_finite;
        clamped += other.clamped;
        clamped_energy += other.clamped_energy;
    }
};

/// A sum or a sample in fixed point.
using FixedRgb = std::array<std::int64_t, 3>;

__extension__ using Int128 = __int128;

/// r^2 + g^2 + b^2 of a sample in fixed point, or a sum of them: high 2^k + low, with k the fixed point's
/// square_digit_bits(). Digits are added each by itself and without a carry, so that they can be added atomically.
struct FixedSquare {
    std::int64_t low = 0;
    std::int64_t high = 0;

    void add(const FixedSquare& other) {
        low += other.low;
        high += other.high;
    }
};

/// How radiance becomes an integer.
struct FixedPoint {
    int fraction_bits = 0;
    double limit = 0;  ///< radiance above which a channel of a part of a sample is cut: at least twice max_radiance

    /// Renders of up to this many samples a pixel have one step, so that one of them can be extended to any other.
    static constexpr std::int64_t kExtensibleSamples = 16384;

    /// For up to `spp` samples a pixel that come in up to `parts` parts, each channel of a part at most max_radiance.
    static FixedPoint make(std::int64_t spp, double max_radiance, std::int64_t parts = 1);

    bool operator==(const FixedPoint&) const = default;
    [[nodiscard]] double scale() const { return std::ldexp(1.0, fraction_bits); }
    /// The bits of a square's low digit. With 2^s samples at most, no channel of a sample is above 2^(62 - s), and no
    /// square above 3 * 2^(124 - 2 s). With 63 - s bits in the low digit, the sum of the low digits is below
    /// 2^s * 2^(63 - s) = 2^63, and that of the high ones at most 2^s * 3 * 2^(124 - 2 s) / 2^(63 - s) = 3 * 2^61.
    [[nodiscard]] int square_digit_bits() const { return 1 + std::ilogb(limit) + fraction_bits; }
    /// A sum of squares as one number, in units of the squared step; below 2^(126 - s).
    [[nodiscard]] Int128 whole(const FixedSquare& square) const {
        return Int128{square.high} * (Int128{1} << square_digit_bits()) + square.low;
    }
};

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

/// Whether a framebuffer keeps second moments.
enum class Moments : bool { First, Second };

/// Turns samples into integers, keeping an account of bad ones. One per thread.
class SampleConverter {
  public:
    explicit SampleConverter(const FixedPoint& fixed)
        : scale_(fixed.scale()),
          limit_(fixed.limit),
          square_digit_bits_(static_cast<unsigned>(fixed.square_digit_bits())) {}

    /// Rounds to nearest. Zero for a sample that is not finite.
    template <class Scalar>
    FixedRgb convert(const Vec3<Scalar>& radiance) {
        FixedRgb fixed{};
        for (int i = 0; i < 3; ++i) {
            const double value = static_cast<double>(radiance[i]);
            if (!(value >= 0 && value <= limit_)) [[unlikely]]
                return convert_bad(radiance.template cast<double>());
            fixed[i] = std::llrint(value * scale_);
        }
        return fixed;
    }
    /// convert() of eight samples whose channels are columns, where the processor can: fixed[k][i] of channel k. False,
    /// and nothing of use in `fixed`, where it cannot or a sample is bad.
    [[nodiscard]] bool convert_eight(const float* const (&channel)[3], std::int64_t (&fixed)[3][8]) const {
        bool is_good = true;
        for (int k = 0; k < 3; ++k) is_good = is_good && x86::round_eight(channel[k], scale_, limit_, fixed[k]);
        return is_good;
    }
    /// r^2 + g^2 + b^2 of a whole sample, for the sum of squares: exact.
    [[nodiscard]] FixedSquare square(const FixedRgb& sample) const {
        const Int128 square =
            Int128{sample[0]} * sample[0] + Int128{sample[1]} * sample[1] + Int128{sample[2]} * sample[2];
        return {static_cast<std::int64_t>(square) & ((std::int64_t{1} << square_digit_bits_) - 1),
                static_cast<std::int64_t>(square >> square_digit_bits_)};
    }
    [[nodiscard]] const SampleStatistics& statistics() const { return statistics_; }

  private:
    FixedRgb convert_bad(const Eigen::Vector3d& radiance);

    double scale_;
    double limit_;
    unsigned square_digit_bits_;
    SampleStatistics statistics_;
};

class Framebuffer {
  public:
    Framebuffer(std::int64_t width, std::int64_t height, const FixedPoint& fixed, Moments moments = Moments::First);

    [[nodiscard]] std::int64_t width() const { return width_; }
    [[nodiscard]] std::int64_t height() const { return height_; }
    [[nodiscard]] const FixedPoint& fixed_point() const { return fixed_; }

    template <Addition addition = Addition::Plain>
    void add(std::int64_t pixel, const FixedRgb& sample) {
        for (int i = 0; i < 3; ++i) add_to<addition>(sums_[static_cast<std::size_t>(3 * pixel + i)], sample[i]);
    }
    /// Only where it keeps second moments.
    template <Addition addition = Addition::Plain>
    void add_square(std::int64_t pixel, const FixedSquare& square) {
        add_to<addition>(squares_[static_cast<std::size_t>(2 * pixel)], square.low);
        add_to<addition>(squares_[static_cast<std::size_t>(2 * pixel + 1)], square.high);
    }
    [[nodiscard]] FixedSquare square(std::size_t pixel) const { return {squares_[2 * pixel], squares_[2 * pixel + 1]}; }
    [[nodiscard]] bool has_squares() const { return !squares_.empty(); }
    /// Two a pixel, its low digit and its high one; empty without second moments.
    [[nodiscard]] std::span<std::int64_t> squares() { return squares_; }
    [[nodiscard]] std::span<const std::int64_t> squares() const { return squares_; }
    [[nodiscard]] std::span<std::int64_t> sums() { return sums_; }
    [[nodiscard]] std::span<const std::int64_t> sums() const { return sums_; }

    /// 16 hexadecimal digits over the size, the step, every sum and, where kept, every sum of squares (XXH3).
    [[nodiscard]] std::string hash() const;

    /// The mean of `sample_count` samples a pixel, linear radiance.
    [[nodiscard]] Image image(std::int64_t sample_count) const;
    /// The same where each pixel has a number of samples of its own, none of them 0.
    [[nodiscard]] Image image(std::span<const std::int32_t> sample_counts) const;

  private:
    std::int64_t width_;
    std::int64_t height_;
    FixedPoint fixed_;
    std::vector<std::int64_t> sums_;
    std::vector<std::int64_t> squares_;
};

}  // namespace raypool
