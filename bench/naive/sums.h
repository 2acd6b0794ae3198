/// Sums that round. The engines' are integers (core/film/framebuffer.h).
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

namespace raypool::naive {

template <class Scalar>
struct PlainSum {
    Scalar sum = 0;
    void add(float x) { sum += static_cast<Scalar>(x); }
    [[nodiscard]] double value() const { return static_cast<double>(sum); }
};

/// Neumaier, "Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen", 1974. In float the compensation
/// itself stops growing.
struct NeumaierSum {
    float sum = 0;
    float compensation = 0;
    void add(float x) {
        const float next = sum + x;
        compensation += std::fabs(sum) >= std::fabs(x) ? (sum - next) + x : (x - next) + sum;
        sum = next;
    }
    [[nodiscard]] double value() const { return static_cast<double>(sum + compensation); }
};

/// Blocks of 64 in float, added up in double.
struct BlockSum {
    double sum = 0;
    float block = 0;
    int count = 0;
    void add(float x) {
        block += x;
        if (++count == 64) {
            sum += static_cast<double>(block);
            block = 0;
            count = 0;
        }
    }
    [[nodiscard]] double value() const { return sum + static_cast<double>(block); }
};

/// Fixed point with a step that does not look at the scene, converted without looking at the number. What the processor
/// makes of a number out of range, NaN too, is the least integer; in C++ it is undefined, so it is spelled out here.
struct BlindFixedSum {
    std::int64_t sum = 0;
    static constexpr double kScale = 0x1p24;
    void add(float x) {
        const double scaled = static_cast<double>(x) * kScale;
        const bool is_in_range = std::fabs(scaled) < 0x1p63;
        const std::int64_t fixed = is_in_range ? std::llrint(scaled) : std::numeric_limits<std::int64_t>::min();
        sum = static_cast<std::int64_t>(static_cast<std::uint64_t>(sum) + static_cast<std::uint64_t>(fixed));
    }
    [[nodiscard]] double value() const { return static_cast<double>(sum) / kScale; }
};

}  // namespace raypool::naive
