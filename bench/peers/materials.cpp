#include "bench/peers/materials.h"

#include <algorithm>
#include <cmath>

namespace raypool::peers {

namespace {

/// Bilinear between texel centres; beyond an edge of the image lies the edge itself or, where it repeats, the opposite.
V3<float> image_colour(const Image& image, float u, float v, bool repeats_u, bool repeats_v) {
    const int width = static_cast<int>(image.width);
    const int height = static_cast<int>(image.height);
    const auto index = [](int at, int size, bool repeats) {
        return repeats ? (at + 2 * size) % size : std::clamp(at, 0, size - 1);
    };
    const auto texel = [&](int x, int y) {
        x = index(x, width, repeats_u);
        y = index(y, height, repeats_v);
        const float* p = &image.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                         static_cast<std::size_t>(x))];
        return V3<float>{p[0], p[1], p[2]};
    };
    // Coordinates on a plane are unbounded.
    const auto bounded = [](float at, bool repeats) {
        return repeats ? at - std::floor(at) : std::clamp(at, -1.0F, 2.0F);
    };
    const float x = bounded(u, repeats_u) * static_cast<float>(width) - 0.5F;
    const float y = bounded(1 - v, repeats_v) * static_cast<float>(height) - 0.5F;
    const float left = std::floor(x);
    const float top = std::floor(y);
    const int i = static_cast<int>(left);
    const int k = static_cast<int>(top);
    const float right_part = x - left;
    const float low_part = y - top;
    const V3<float> upper = (1 - right_part) * texel(i, k) + right_part * texel(i + 1, k);
    const V3<float> lower = (1 - right_part) * texel(i, k + 1) + right_part * texel(i + 1, k + 1);
    return (1 - low_part) * upper + low_part * lower;
}

}  // namespace

V3<float> mapped_colour(const EmbreeScene& scene, int id, V3<float> outward, float u, float v) {
    const Rows<float> row(scene, id);
    if (row.value(Surface::kRadius) > 0) {
        constexpr float kPi = 3.14159265F;
        u = 0.5F + std::atan2(-outward.z, outward.x) / (2 * kPi);
        v = 0.5F + std::asin(std::clamp(outward.y, -1.0F, 1.0F)) / kPi;
    }
    if (row.is(Texture::Kind::CheckerUv)) {
        const bool is_odd = is_odd_cell<float>({u, v, 0}, row.value(Surface::kDensity));
        return row.vector(is_odd ? Surface::kOdd : Surface::kColour);
    }
    return image_colour(*scene.texture(static_cast<int>(row.value(Surface::kImage))).image, u, v,
                        row.value(Surface::kRepeatU) != 0, row.value(Surface::kRepeatV) != 0);
}

}  // namespace raypool::peers
