/// Random numbers keyed by what they are for: a pixel, a sample, and a block of four numbers in the life of a path.
///
/// There is no state, so the numbers of a path do not depend on which engine, thread or lane follows it, nor on
/// whether a neighbouring feature drew a number. Called by core/camera.h and core/shade.h.
#pragma once

#include <array>
#include <cstdint>

#include "core/real.h"
#include "core/sobol.h"

namespace raypool {

/// How numbers are made of their key: each independent of all others, or so that the samples of a pixel lie evenly.
enum class Sampler : std::uint8_t { Independent, Sobol };

/// The part of the key that is the same for a whole render.
struct RandomSeed {
    std::uint32_t low;
    std::uint32_t high;
    Sampler sampler = Sampler::Independent;
};

/// Spreads a user's seed over the key: neighbouring seeds share no bits (splitmix64's finaliser, Steele et al. 2014).
constexpr RandomSeed random_seed(std::uint64_t seed, Sampler sampler = Sampler::Independent) {
    std::uint64_t z = seed + 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    z ^= z >> 31U;
    return {static_cast<std::uint32_t>(z), static_cast<std::uint32_t>(z >> 32U), sampler};
}

/// Which block of four numbers. A path draws the film block, perhaps the shutter block, and one block a bounce.
namespace random_block_id {
inline constexpr std::uint32_t kFilm = 0;     ///< 0, 1: place in the pixel; 2, 3: place on the lens
inline constexpr std::uint32_t kShutter = 1;  ///< 0: time
inline constexpr std::uint32_t kBounce =
    2;  ///< kBounce + the path's step (shade.h). 0, 1: direction; 2: reflect or refract; 3: roulette
}  // namespace random_block_id

namespace detail {

template <class Real>
using Words = std::array<Uint32<Real>, 4>;

/// pcg4d (Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020): four words of four words.
template <class Real>
RAYPOOL_INLINE Words<Real> random_words(const Uint32<Real>& pixel, const Uint32<Real>& sample,
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
    return {x, y, z, w};
}

/// Sample `sample` of the four-dimensional set that belongs to the pixel and the block. Its scrambling is keyed by what
/// no sample number is: they stay below 2^31. A call by value, and never inlined, so that independent numbers stay in
/// registers and pay for nothing but the choice.
template <class Real>
[[gnu::noinline]] Words<Real> sobol_words(Uint32<Real> pixel, Uint32<Real> sample, Uint32<Real> block,
                                          RandomSeed seed) {
    using U = Uint32<Real>;
    const Words<Real> order = random_words<Real>(pixel, U(0xffffffffU), block, seed);
    const Words<Real> scramble = random_words<Real>(pixel, U(0xfffffffeU), block, seed);
    return sobol::scrambled_point<U>(sample, order[0], scramble);
}

}  // namespace detail

/// Four numbers in [0, 1), each a multiple of 2^-24 (so that no float rounds up to 1). `pixel` counts row by row.
/// `sample` is below 2^31.
template <class Real>
RAYPOOL_INLINE std::array<Real, 4> random_block(const Uint32<Real>& pixel, const Uint32<Real>& sample,
                                                const Uint32<Real>& block, const RandomSeed& seed) {
    detail::Words<Real> word = detail::random_words<Real>(pixel, sample, block, seed);
    if (seed.sampler != Sampler::Independent) [[unlikely]]
        word = detail::sobol_words<Real>(pixel, sample, block, seed);
    const Real scale(1.0F / (1U << 24U));
    return {from_uint32<Real>(word[0] >> 8) * scale, from_uint32<Real>(word[1] >> 8) * scale,
            from_uint32<Real>(word[2] >> 8) * scale, from_uint32<Real>(word[3] >> 8) * scale};
}

}  // namespace raypool
