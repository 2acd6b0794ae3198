/// Large images and many branches, as programs often have them.
#pragma once

#include <cstdint>

#include "core/shading/camera.h"

namespace raypool::naive {

/// y * width + x in 32 bits; what overflows wraps around.
inline std::int64_t int32_pixel(std::int64_t x, std::int64_t y, std::int64_t width) {
    const auto product = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(width);
    return static_cast<std::int32_t>(product + static_cast<std::uint32_t>(x));
}

/// The ray through column x + jitter of the image's middle line, column and jitter added before anything else.
template <class Scalar>
Vec3<Scalar> joined_column(const Camera<Scalar>& camera, Scalar x, Scalar jitter) {
    const Scalar column = (x + jitter) - camera.half_width;
    return unit<Scalar>(Vec3<Scalar>(camera.to_center + column * camera.pixel_u));
}

/// Records alive at once where every record of a batch is split `splits` times before any of them ends.
inline std::int64_t breadth_first_records(std::int64_t batch, int splits) {
    std::int64_t records = batch;
    for (int i = 0; i < splits; ++i) records += records;
    return records;
}

}  // namespace raypool::naive
