/// What each pixel cost: recorded by the engines that render pixel by pixel, where RenderSettings::cost_image says so.
///
/// Thread safety: pixels are added to atomically.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image/image.h"

namespace raypool {

/// Segments traced, box and primitive tests, or nanoseconds (with other threads' disturbance).
enum class Cost : std::uint8_t { Segments, Tests, Nanoseconds };

struct CostImage {
    CostImage(Cost cost, std::int64_t width, std::int64_t height)
        : cost(cost), width(width), height(height), values(static_cast<std::size_t>(width * height)) {}

    /// The values in all three channels, rounded to floats.
    [[nodiscard]] Image image() const {
        Image out(width, height);
        for (std::size_t i = 0; i < out.rgb.size(); ++i) out.rgb[i] = static_cast<float>(values[i / 3]);
        return out;
    }

    Cost cost;
    std::int64_t width;
    std::int64_t height;
    std::vector<std::int64_t> values;  ///< row 0 at the top
};

}  // namespace raypool
