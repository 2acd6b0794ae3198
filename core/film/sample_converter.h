/// How radiance becomes the integers that a framebuffer sums.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

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

/// How radiance becomes an integer.
struct FixedPoint {
    int fraction_bits = 0;
    double limit = 0;  ///< radiance above which a channel of a part of a sample is cut: at least twice max_radiance

    /// Renders of up to this many samples a pixel have one step, so that one of them can be extended to any other.
    static constexpr std::int64_t kExtensibleSamples = 16384;

    /// For up to `spp` samples a pixel that come in parts, each channel of a part at most max_radiance, and of a sample
    /// at most `parts` times that.
    static FixedPoint make(std::int64_t spp, double max_radiance, double parts = 1);

    bool operator==(const FixedPoint&) const = default;
    [[nodiscard]] double scale() const { return std::ldexp(1.0, fraction_bits); }
};

/// Turns samples into integers, keeping an account of bad ones. One per thread.
class SampleConverter {
  public:
    explicit SampleConverter(const FixedPoint& fixed) : scale_(fixed.scale()), limit_(fixed.limit) {}

    [[nodiscard]] double scale() const { return scale_; }
    [[nodiscard]] double limit() const { return limit_; }

    /// Rounds to nearest. Zero for a sample that is not finite.
    template <class Scalar>
    RAYPOOL_HOST_DEVICE FixedRgb convert(const Vec3<Scalar>& radiance) {
        FixedRgb fixed{};
        for (int i = 0; i < 3; ++i) {
            const double value = static_cast<double>(radiance[i]);
            if (!(value >= 0 && value <= limit_)) [[unlikely]]
                return convert_bad(radiance[0], radiance[1], radiance[2]);
            fixed[i] = std::llrint(value * scale_);
        }
        return fixed;
    }
    [[nodiscard]] RAYPOOL_HOST_DEVICE const SampleStatistics& statistics() const { return statistics_; }

  private:
    [[gnu::noinline]] RAYPOOL_HOST_DEVICE FixedRgb convert_bad(double r, double g, double b) {
        const double radiance[3] = {r, g, b};
        for (const double channel : radiance) {
            if (std::isfinite(channel)) continue;
            ++statistics_.non_finite;
            return {};
        }
        FixedRgb fixed{};
        for (int i = 0; i < 3; ++i) {
            const double kept = radiance[i] < 0 ? 0 : radiance[i] > limit_ ? limit_ : radiance[i];
            if (kept != radiance[i]) ++statistics_.clamped;
            statistics_.clamped_energy += radiance[i] - kept;
            fixed[i] = std::llrint(kept * scale_);
        }
        return fixed;
    }

    double scale_;
    double limit_;
    SampleStatistics statistics_;
};

}  // namespace raypool
