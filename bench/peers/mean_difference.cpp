#include "bench/peers/mean_difference.h"

#include "core/base/error.h"

namespace raypool::peers {

MeanDifference mean_difference(const Framebuffer& image, const Framebuffer& expected) {
    RAYPOOL_CHECK(image.sums().size() == expected.sums().size() && image.fixed_point() == expected.fixed_point(),
                  "the images are of one size and of one fixed point");
    const auto count = static_cast<double>(image.width() * image.height());
    double whole = 0;
    double sum = 0;
    double squares = 0;
    double differing = 0;
    for (std::size_t pixel = 0; pixel < static_cast<std::size_t>(image.width() * image.height()); ++pixel) {
        const FixedRgb a = image.sum(pixel);
        const FixedRgb b = expected.sum(pixel);
        const auto difference = static_cast<double>(a[0] - b[0] + a[1] - b[1] + a[2] - b[2]);
        whole += static_cast<double>(b[0]) + static_cast<double>(b[1]) + static_cast<double>(b[2]);
        sum += difference;
        squares += difference * difference;
        differing += a == b ? 0 : 1;
    }
    MeanDifference found{.differing_pixels = differing / count};
    if (sum != 0) {
        found.relative = sum / whole;
        found.standard_errors = sum / std::sqrt(squares);
    }
    return found;
}

}  // namespace raypool::peers
