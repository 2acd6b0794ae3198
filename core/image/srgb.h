/// The transfer curve of sRGB (IEC 61966-2-1), exactly as defined: a line near black, a power above.
///
/// Used wherever 8-bit colour meets linear light: PNG files, colour maps. Both functions expect [0, 1].
#pragma once

#include <cmath>

namespace raypool {

inline double srgb_from_linear(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

inline double linear_from_srgb(double coded) {
    return coded <= 0.04045 ? coded / 12.92 : std::pow((coded + 0.055) / 1.055, 2.4);
}

}  // namespace raypool
