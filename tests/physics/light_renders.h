/// Renders by each way to find lights, and whether two of them have the same means.
#pragma once

#include <vector>

#include "tests/physics/agreement.h"
#include "tests/physics/test_scene.h"

namespace raypool {

template <class Scalar>
Rendered render_with(const Scene& scene, LightSampling sampling, std::int64_t spp, std::uint64_t seed = 0,
                     std::int32_t depth = 20) {
    RenderSettings settings;
    settings.end_sample = spp;
    settings.depth = depth;
    settings.seed = seed;
    settings.light_sampling = sampling;
    return render(recursive::IterativeEngine(), compile<Scalar>(scene), settings);
}

/// Pixel by pixel: what differs between pixels is no noise.
inline testing::AssertionResult same_means(const Rendered& a, const Rendered& b) {
    const std::vector<double> of_a = pixel_values(a);
    const std::vector<double> of_b = pixel_values(b);
    std::vector<double> differences;
    for (std::size_t i = 0; i < of_a.size(); ++i) differences.push_back(of_b[i] - of_a[i]);
    return mean_agrees(differences, 0);
}

}  // namespace raypool
