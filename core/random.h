/// Random numbers keyed by what they are for: a pixel, a sample, and a block of four numbers in the life of a path.
///
/// There is no state, so the numbers of a path do not depend on which engine, thread or lane follows it, nor on
/// whether a neighbouring feature drew a number. The generator is pcg4d (Jarzynski and Olano, "Hash Functions for GPU
/// Rendering", JCGT 9(3), 2020), which turns four 32-bit words into four.
#pragma once

#include <array>
#include <cstdint>

#include "core/real.h"

namespace raypool {

/// The part of the key that is the same for a whole render.
struct RandomSeed {
    std::uint32_t low;
    std::uint32_t high;
};

/// Spreads a user's seed over the key: neighbouring seeds share no bits (splitmix64's finaliser, Steele et al. 2014).
constexpr RandomSeed random_seed(std::uint64_t seed) {
    std::uint64_t z = seed + 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    z ^= z >> 31U;
    return {static_cast<std::uint32_t>(z), static_cast<std::uint32_t>(z >> 32U)};
}

/// Which block of four numbers. A path draws the film block, perhaps the shutter block, and one block a bounce.
namespace random_block_id {
inline constexpr std::uint32_t kFilm = 0;     ///< 0, 1: place in the pixel; 2, 3: place on the lens
inline constexpr std::uint32_t kShutter = 1;  ///< 0: time
inline constexpr std::uint32_t kBounce =
    2;  ///< kBounce + the path's step (shade.h). 0, 1: direction; 2: reflect or refract
}  // namespace random_block_id

/// Four numbers in [0, 1), each a multiple of 2^-24 (so that no float rounds up to 1). `pixel` counts row by row.
template <class Real>
RAYPOOL_INLINE std::array<Real, 4> random_block(const Uint32<Real>& pixel, const Uint32<Real>& sample,
                                                const Uint32<Real>& block, const RandomSeed& seed) {
    using U = Uint32<Real>;
    const U multiplier(1664525U);
    const U increment(1013904223U);
    U x = (pixel + U(seed.low)) * multiplier + increment;
    U y = sample * multiplier + increment;
    U z = block * multiplier + increment;
    U w = U(seed.high) * multiplier + increment;
    x += y * w, y += z * x, z += x * y, w += y * z;
    x ^= x >> 16, y ^= y >> 16, z ^= z >> 16, w ^= w >> 16;
    x += y * w, y += z * x, z += x * y, w += y * z;

    const Real scale(1.0F / (1U << 24U));
    return {from_uint32<Real>(x >> 8) * scale, from_uint32<Real>(y >> 8) * scale, from_uint32<Real>(z >> 8) * scale,
            from_uint32<Real>(w >> 8) * scale};
}

}  // namespace raypool
