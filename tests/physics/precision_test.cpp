// Float against double. Both follow the same paths by the same random keys, so what differs is rounding: a little in
// every path, and much in the few that it sends to the other side of an edge.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/physics/agreement.h"
#include "tests/physics/test_scene.h"

namespace raypool {
namespace {

TEST(Float, HasNoBiasAgainstDoubleOnThePapersScene) {
    const Scene paper = small_scene("paper", 96);
    const Rendered in_float = render<float>(paper, 64, 50);
    const Rendered in_double = render<double>(paper, 64, 50);
    const std::vector<double> of_float = pixel_values(in_float);
    const std::vector<double> of_double = pixel_values(in_double);

    std::vector<double> differences;
    double sum_without_flips = 0;
    std::size_t flipped_count = 0;
    for (std::size_t i = 0; i < of_float.size(); ++i) {
        differences.push_back((of_float[i] - of_double[i]) / in_double.mean(0));
        const bool is_flipped = std::abs(differences.back()) > 1e-4;  // a sample of the 64 took another way
        flipped_count += is_flipped ? 1 : 0;
        if (!is_flipped) sum_without_flips += differences.back();
    }
    EXPECT_GT(flipped_count, 0U) << "two different precisions are compared";
    EXPECT_LT(flipped_count, differences.size() / 4) << "one sample in 256";
    EXPECT_LT(std::abs(sum_without_flips) / static_cast<double>(differences.size()), 1e-6);
    EXPECT_TRUE(mean_agrees(differences, 0)) << "flips go both ways alike";
}

}  // namespace
}  // namespace raypool
