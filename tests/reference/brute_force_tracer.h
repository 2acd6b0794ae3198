/// A path tracer that shares nothing with the engines but the scene's description: the measure of their physics.
///
/// Called by brute_force_agreement_test.cpp. All is in double, every ray asks every shape, and the random numbers are
/// those of the standard library, so no mistake can hide here and in an engine alike. Written from
/// docs/scene-format.md, with a least distance in place of care about rounding: it is for scenes whose coordinates are
/// below some thousands and whose surfaces do not coincide.
#pragma once

#include <cstdint>
#include <vector>

#include "core/scene/scene.h"

namespace raypool::test {

struct BruteForceRender {
    std::vector<double> rgb;  ///< mean radiance, three a pixel, from the top left
    double segments_per_path;
};

/// `spp` samples of each pixel; renders with different seeds are independent.
BruteForceRender brute_force_render(const Scene& scene, int spp, int depth, std::uint64_t seed);

}  // namespace raypool::test
