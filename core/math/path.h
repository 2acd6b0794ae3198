/// Names for a path and for how far it has come: together the key of its random numbers.
#pragma once

#include "core/math/real.h"

namespace raypool {

/// Which path this is; with its step it is the key of its random numbers.
template <class Real>
struct PathKey {
    Uint32<Real> pixel;  ///< row * width + column
    Uint32<Real> sample;
};

/// Where a path is: the number of hits so far, and which branch of a path that was split (0: none yet). A branch b
/// splits into 2b + 1 and 2b + 2, as in a heap. Both are part of the key of random numbers.
namespace path_step {
inline constexpr std::uint32_t kBranchShift = 24;
inline constexpr std::int32_t kMostBounces = (1 << kBranchShift) - 1;
inline constexpr int kMostSplits = 7;  ///< branches then fit into 8 bits

template <class U>
RAYPOOL_INLINE U bounce(const U& step) {
    return step & U((1U << kBranchShift) - 1);
}
template <class U>
RAYPOOL_INLINE U branch(const U& step) {
    return step >> static_cast<int>(kBranchShift);
}
/// The step of the reflected branch; that of the refracted one is 1 << kBranchShift more.
template <class U>
RAYPOOL_INLINE U reflected_branch(const U& step) {
    return step + (branch(step) + U(1U)) * U(1U << kBranchShift);
}
}  // namespace path_step

/// To which of two halves a sample of a pixel belongs, 0 or 1: of samples 2k and 2k + 1 one to each, by chance, so that
/// halves are alike also where samples are stratified by their number.
template <class U>
RAYPOOL_INLINE U half_of_sample(const U& pixel, const U& sample) {
    U x = (sample >> 1) * U(0x9e3779b9U) + pixel * U(0x85ebca6bU);
    x ^= x >> 15;
    x *= U(0x2c1b3c6dU);
    x ^= x >> 12;
    x *= U(0x297a2d39U);
    return (x >> 31) ^ (sample & U(1U));
}

/// Where a sample of a pixel is added: to the pixel itself, or to a half of it.
template <class U>
RAYPOOL_INLINE U cell_of(bool has_halves, const U& pixel, const U& sample) {
    if (!has_halves) [[likely]]
        return pixel;
    return pixel + pixel + half_of_sample<U>(pixel, sample);
}

}  // namespace raypool
