/// Grey images around a scene of nothing, for the cases about images: their texels by number, and the exact angles.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "core/shading/compiled_scene.h"

namespace raypool::stability {

inline constexpr double kSun = 1e6;
inline constexpr double kDim = 0.25;

template <class Scalar>
struct Around {
    static constexpr double kPi = std::numbers::pi;

    std::shared_ptr<const Image> image;
    std::vector<double> sines;  ///< by row, of the angle from the pole to its middle

    [[nodiscard]] CompiledScene<Scalar> compiled() const {
        Scene scene;
        scene.background.image = image;
        return compile<Scalar>(scene);
    }
    [[nodiscard]] std::size_t count() const { return image->rgb.size() / 3; }
    [[nodiscard]] std::size_t row(std::size_t texel) const { return texel / (2 * sines.size()); }
    [[nodiscard]] double radiance(std::size_t texel) const { return image->rgb[3 * texel]; }
    /// Radiance times the sine: what books draw texels by.
    [[nodiscard]] double weight(std::size_t texel) const { return radiance(texel) * sines[row(texel)]; }
    [[nodiscard]] double solid_angle(std::size_t texel) const {
        const auto height = static_cast<double>(sines.size());
        return 2 * kPi / height * sines[row(texel)] * std::sin(kPi / height / 2);
    }
};

/// Twice as wide as high, with radiance(column, row) in its texels.
template <class Scalar>
Around<Scalar> around(std::int64_t height, const auto& radiance) {
    auto image = std::make_shared<Image>(2 * height, height);
    std::vector<double> sines;
    for (std::int64_t row = 0; row < height; ++row) {
        sines.push_back(std::sin(std::numbers::pi * (static_cast<double>(row) + 0.5) / static_cast<double>(height)));
        for (std::int64_t column = 0; column < 2 * height; ++column)
            std::fill_n(image->pixel(column, row), 3, static_cast<float>(radiance(column, row)));
    }
    return {image, sines};
}

/// Dim, with a sun in one texel.
template <class Scalar>
Around<Scalar> with_sun(std::int64_t height, std::int64_t sun_column, std::int64_t sun_row) {
    return around<Scalar>(height, [=](std::int64_t column, std::int64_t row) {
        return column == sun_column && row == sun_row ? kSun : kDim;
    });
}

}  // namespace raypool::stability
