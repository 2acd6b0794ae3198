/// Random numbers keyed by what they are for: a pixel, a sample, a step of the path, and a purpose.
///
/// There is no state, so the numbers of a path do not depend on which engine, thread or lane follows it, nor on
/// whether a neighbouring feature drew a number. Called by core/shading/camera.h and core/shading/shade.h.
#pragma once

#include <array>
#include <cstdint>

#include "core/math/path.h"
#include "core/math/real.h"
#include "core/math/sobol.h"

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

/// What a block of four numbers is for: a part of its key, so that a purpose added here changes no number of another.
/// Each purpose has a block for every step of a path (path.h); what happens once in a path uses step 0.
enum class RandomPurpose : std::uint32_t {
    Film,         ///< 0, 1: place in the pixel; 2, 3: place on the lens. Once
    Shutter,      ///< 0: time. Once
    Scatter,      ///< 0, 1: direction; 2: reflect or refract; 3: roulette
    Light,        ///< 0, 3: which light; 1, 2: where on it
    Environment,  ///< 0, 1: which row of the image around the scene; 2, 3: which texel of it
};

namespace detail {

template <class Real>
using Words = std::array<Uint32<Real>, 4>;

/// After pcg4d (Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020), with one fold more: the
/// upper bits of pixel, sample and step go onto the lower ones before the first round. Products carry a difference of
/// two keys to higher bits only, so keys that differ in their highest bits, as those of branches and of distant pixels
/// and samples do, would share parts of their numbers. What pcg4d does and no test can tell (random_keys_test.cpp) pays
/// for it: z is not folded a second time, and no increment is added to what is random as the seed is.
template <class Real>
RAYPOOL_INLINE Words<Real> random_words(const Uint32<Real>& pixel, const Uint32<Real>& sample, const Uint32<Real>& step,
                                        RandomPurpose purpose, const RandomSeed& seed) {
    using U = Uint32<Real>;
    const U multiplier(1664525U);
    const U increment(1013904223U);
    U x = (pixel + U(seed.low)) * multiplier;
    U y = sample * multiplier + increment;
    U z = step * multiplier + increment;
    U w(seed.high + static_cast<std::uint32_t>(purpose) * 0x9e3779b9U);
    x ^= x >> 15, y ^= y >> 15, z ^= z >> 15;
    x += y * w, y += z * x, z += x * y, w += y * z;
    x ^= x >> 16, y ^= y >> 16, w ^= w >> 16;
    x += y * w, y += z * x, z += x * y, w += y * z;
    return {x, y, z, w};
}

/// Sample `sample` of the four-dimensional set that belongs to the pixel, the step and the purpose. Its scrambling is
/// keyed by what no sample number is: they stay below 2^31. A call by value, and never inlined, so that independent
/// numbers stay in registers and pay for nothing but the choice.
template <class Real>
[[gnu::noinline]] RAYPOOL_HOST_DEVICE Words<Real> sobol_words(Uint32<Real> pixel, Uint32<Real> sample,
                                                              Uint32<Real> step, RandomPurpose purpose,
                                                              RandomSeed seed) {
    using U = Uint32<Real>;
    const Words<Real> order = random_words<Real>(pixel, U(0xffffffffU), step, purpose, seed);
    const Words<Real> scramble = random_words<Real>(pixel, U(0xfffffffeU), step, purpose, seed);
    return sobol::scrambled_point<U>(sample, order[0], scramble);
}

}  // namespace detail

/// Four numbers in [0, 1), each a multiple of 2^-24 (so that no float rounds up to 1). Samples are below 2^31.
template <class Real>
RAYPOOL_INLINE std::array<Real, 4> random_block(const PathKey<Real>& path, const Uint32<Real>& step,
                                                RandomPurpose purpose, const RandomSeed& seed) {
    detail::Words<Real> word = detail::random_words<Real>(path.pixel, path.sample, step, purpose, seed);
    if (seed.sampler != Sampler::Independent) [[unlikely]]
        word = detail::sobol_words<Real>(path.pixel, path.sample, step, purpose, seed);
    const Real scale(1.0F / (1U << 24U));
    return {from_uint32<Real>(word[0] >> 8) * scale, from_uint32<Real>(word[1] >> 8) * scale,
            from_uint32<Real>(word[2] >> 8) * scale, from_uint32<Real>(word[3] >> 8) * scale};
}

}  // namespace raypool
