/// What the sums of two halves of a pixel's samples say of its variance.
///
/// Both halves estimate one mean. With sums a and b of n_a and n_b samples, n = n_a + n_b, the difference n_b a - n_a b
/// has the expectation 0 and the variance n n_a n_b times that of a sample. Its square is an estimate with one degree
/// of freedom: right on average over many pixels, and little to go by for a single one. It takes samples for
/// independent. Those of Sobol's sequence avoid each other, so that it is too high for them: up to 5 times (60 renders
/// of 16 samples).
#pragma once

#include <array>
#include <cstdint>

#include "core/film/framebuffer.h"

namespace raypool {

/// How many of a pixel's samples are in either half (half_of_sample()).
struct HalfCounts {
    std::int64_t a = 0;
    std::int64_t b = 0;

    /// Of samples [first, end) of a pixel.
    static HalfCounts of(std::size_t pixel, std::int64_t first, std::int64_t end) {
        const auto in_b = [&](std::int64_t n) {  // of the first n: one of each pair
            const bool last_in_b =
                n % 2 == 1 && half_of_sample(static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(n - 1)) == 1;
            return n / 2 + (last_in_b ? 1 : 0);
        };
        const std::int64_t b = in_b(end) - in_b(first);
        return {end - first - b, b};
    }
    [[nodiscard]] std::int64_t all() const { return a + b; }
};

/// The square of n_b a - n_a b for each channel of a pixel of a framebuffer that keeps halves apart, in steps of its
/// sums. The difference is exact, since it may be tiny beside both.
inline std::array<double, 3> squared_differences(const Framebuffer& framebuffer, std::size_t pixel,
                                                 const HalfCounts& counts) {
    __extension__ using Int128 = __int128;
    const std::int64_t* sums = &framebuffer.sums()[6 * pixel];
    std::array<double, 3> squares{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto difference = static_cast<double>(Int128{sums[k]} * counts.b - Int128{sums[3 + k]} * counts.a);
        squares[k] = difference * difference;
    }
    return squares;
}

}  // namespace raypool
