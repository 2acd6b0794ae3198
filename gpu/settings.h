/// What is particular to the GPU engine.
#pragma once

#include <array>
#include <cstdint>

namespace raypool::gpu {

/// Who follows a path.
enum class Form : std::uint8_t {
    Mega,            ///< a thread a path, from the camera to its end: the paper's version
    MegaRegenerate,  ///< as many threads as the device holds; one whose path ends takes the next
    Wave             ///< the pool: rounds of kernels over ray records in the device's memory
};

/// As users write them, in order.
inline constexpr std::array<const char*, 3> kFormNames{"mega", "mega-regenerate", "wave"};

struct GpuSettings {
    Form form = Form::Wave;
    /// Records of the pool of Form::Wave, within [1, 2^31 - 1].
    std::int64_t capacity = std::int64_t{1} << 20;
};

}  // namespace raypool::gpu
