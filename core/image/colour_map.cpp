#include "core/image/colour_map.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/image/srgb.h"

namespace raypool {

namespace {

/// "Inferno" by Nathaniel J. Smith and Stéfan van der Walt (public domain, CC0), every sixteenth of its range, in sRGB.
constexpr std::array<std::array<double, 3>, 17> kInferno{{
    {0.0015, 0.0005, 0.0139},
    {0.0423, 0.0281, 0.1411},
    {0.1293, 0.0473, 0.2908},
    {0.2383, 0.0366, 0.3964},
    {0.3415, 0.0623, 0.4294},
    {0.4412, 0.0993, 0.4316},
    {0.5409, 0.1347, 0.4151},
    {0.6401, 0.1714, 0.3811},
    {0.7357, 0.2159, 0.3302},
    {0.8173, 0.2710, 0.2704},
    {0.8903, 0.3480, 0.1983},
    {0.9443, 0.4428, 0.1204},
    {0.9771, 0.5508, 0.0391},
    {0.9879, 0.6677, 0.0583},
    {0.9761, 0.7900, 0.1960},
    {0.9487, 0.9105, 0.3953},
    {0.9884, 0.9984, 0.6449},
}};

}  // namespace

void inferno(double position, float* rgb) {
    // Between the points of the table sRGB codes are interpolated.
    const double scaled = std::clamp(position, 0.0, 1.0) * (kInferno.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(scaled), kInferno.size() - 2);
    const double fraction = scaled - static_cast<double>(below);
    for (std::size_t c = 0; c < 3; ++c) {
        const double coded = kInferno[below][c] + fraction * (kInferno[below + 1][c] - kInferno[below][c]);
        rgb[c] = static_cast<float>(linear_from_srgb(coded));
    }
}

}  // namespace raypool
