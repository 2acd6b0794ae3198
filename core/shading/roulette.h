/// How paths end that carry little: Russian roulette, and darkness.
#pragma once

#include "core/math/path.h"
#include "core/math/vec.h"

namespace raypool {

template <class Real>
RAYPOOL_INLINE Mask<Real> carries_light(const Vec3<Real>& throughput) {
    return throughput[0] > Real(0) || throughput[1] > Real(0) || throughput[2] > Real(0);
}

/// Hits after which a path takes part in Russian roulette.
inline constexpr std::uint32_t kHitsBeforeRoulette = 3;

/// Ends paths by chance and makes up for it in those that go on (Arvo and Kirk, "Particle Transport and Image
/// Synthesis", 1990): a path survives with the probability q = min(1, greatest channel of its throughput) and is
/// divided by q, so that its expectation stays. q is rounded up to a multiple of 2^-24, the step of `random`: then
/// random < q has exactly that probability. Returns the paths that survive.
template <class Real>
RAYPOOL_INLINE Mask<Real> survives_roulette(Vec3<Real>& throughput, const Real& random, const Mask<Real>& is_played) {
    constexpr float kSteps = 1U << 24U;
    const Real most = max(max(throughput[0], throughput[1]), throughput[2]);
    const Real q = -floor(-most * Real(kSteps)) * Real(1 / kSteps);
    const Mask<Real> is_chance = is_played && q < Real(1) && q > Real(0);
    const Real divisor = select(is_chance, q, Real(1));
    for (int i = 0; i < 3; ++i) throughput[i] = throughput[i] / divisor;
    return !is_chance || random < q;
}

/// Whether a path takes part at its hit number `step` (path_step).
template <class Real>
RAYPOOL_INLINE Mask<Real> plays_roulette(const Uint32<Real>& step) {
    return from_uint32<Real>(path_step::bounce<Uint32<Real>>(step)) >=
           Real(static_cast<ScalarOf<Real>>(kHitsBeforeRoulette - 1));
}

}  // namespace raypool
