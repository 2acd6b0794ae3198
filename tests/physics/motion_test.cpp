// Motion blur: a pixel's mean over the shutter is the part of the time that the sphere covers it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/physics/agreement.h"
#include "tests/physics/test_scene.h"

namespace raypool {
namespace {

constexpr double kFar = 1000;      // so far that rays are as good as parallel
constexpr double kHalfHeight = 2;  // of the image, where the sphere is
constexpr int kPixelsPerUnit = 8;

/// A shining unit sphere that moves from x = -2 at time 0 to x = 1 at time 1, in an image 8 wide and 4 high.
TestScene moving_sphere(double shutter_open, double shutter_close) {
    TestScene scene(8 * kPixelsPerUnit, 4 * kPixelsPerUnit, Vector3d::Zero());
    scene.sphere({-2, 0, 0}, 1, scene.emitter(1));
    scene.spheres[0].center1 = {1, 0, 0};
    scene.look({0, 0, kFar}, {0, 0, 0}, 2 * std::atan(kHalfHeight / kFar) * 180 / std::numbers::pi);
    scene.camera.shutter_open = shutter_open;
    scene.camera.shutter_close = shutter_close;
    return scene;
}

/// The part of [open, close] in which a unit disc centred at (-2 + 3 t, 0) holds the point (x, y).
double covered_part(double x, double y, double open, double close) {
    if (std::abs(y) >= 1) return 0;
    const double half_chord = std::sqrt(1 - y * y);
    const double enter = std::max(open, (x - half_chord + 2) / 3);
    const double exit = std::min(close, (x + half_chord + 2) / 3);
    return std::max(0.0, exit - enter) / (close - open);
}

TEST(MovingSphere, CoversAPixelForThePartOfTheShutterThatItIsThere) {
    struct Case {
        double open, close;
    };
    for (const auto& [open, close] : {Case{0, 1}, {0.25, 0.5}, {0.9, 1}}) {
        constexpr std::int64_t kSpp = 64;
        const TestScene scene = moving_sphere(open, close);
        const std::vector<double> values = pixel_values(render<float>(scene, kSpp, 2));
        std::vector<double> squares;
        double variance = 0;  // of the sum of all pixels
        for (std::int64_t i = 0; i < scene.width * scene.height; ++i) {
            const double left = static_cast<double>(i % scene.width) / kPixelsPerUnit - 4;
            const double top = kHalfHeight - static_cast<double>(i / scene.width) / kPixelsPerUnit;
            constexpr int kSteps = 16;
            double expected = 0;
            for (int k = 0; k < kSteps * kSteps; ++k) {
                const double x = left + (k % kSteps + 0.5) / kSteps / kPixelsPerUnit;
                const double y = top - (k / kSteps + 0.5) / kSteps / kPixelsPerUnit;
                expected += covered_part(x, y, open, close) / (kSteps * kSteps);
            }
            variance += expected * (1 - expected) / kSpp;
            const double value = values[static_cast<std::size_t>(i)];
            if (expected < 0.02 || expected > 0.98) {
                EXPECT_NEAR(value, expected, 0.1);
            } else {
                squares.push_back(std::pow(value - expected, 2) * kSpp / (expected * (1 - expected)));
            }
        }
        EXPECT_GT(squares.size(), 100U);
        EXPECT_TRUE(mean_agrees(squares, 1)) << "shutter " << open << " to " << close;
        double sum = 0;
        for (const double value : values) sum += value;
        const double area = sum / (kPixelsPerUnit * kPixelsPerUnit);
        constexpr double kPixelsPerArea = kPixelsPerUnit * kPixelsPerUnit;
        EXPECT_TRUE(estimate_agrees(area, std::sqrt(variance) / kPixelsPerArea, std::numbers::pi))
            << "what moves grows no larger";
    }
}

TEST(MovingSphere, StandsStillForAShutterThatIsOpenForNoTime) {
    TestScene still = moving_sphere(0.5, 0.5);
    still.spheres[0].center0 = still.spheres[0].center1 = {-0.5, 0, 0};
    const Rendered expected = render<float>(still, 2, 2);
    EXPECT_GT(expected.mean(0), 0.05);
    EXPECT_EQ(render<float>(moving_sphere(0.5, 0.5), 2, 2).hash(), expected.hash());
}

}  // namespace
}  // namespace raypool
