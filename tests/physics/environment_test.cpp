// An image around the scene: the same means by chance and by light sampling, and closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/scene/emission.h"
#include "tests/physics/light_renders.h"

namespace raypool {
namespace {

std::shared_ptr<const Image> constant(double radiance) {
    return image_of(8, [&](std::int64_t, std::int64_t) { return Vector3d::Constant(radiance); });
}

/// A floor, a ball and a mirror.
TestScene balls() {
    TestScene scene(40, 40, Vector3d::Zero());
    scene.plane({0, 0, 0}, {0, 1, 0}, scene.diffuse(0.7));
    scene.sphere({-0.8, 1, 0}, 1, scene.diffuse(0.5));
    scene.sphere({1, 0.6, 0.3}, 0.6, scene.mirror(0.9));
    scene.look({0, 2, 6}, {0, 0.7, 0}, 45);
    return scene;
}

struct Case {
    const char* name;
    void (*set)(TestScene&);
};
constexpr Case kCases[] = {
    {"constant", [](TestScene& s) { s.background.image = constant(0.6); }},
    {"gradient",
     [](TestScene& s) {
         s.background.image = image_of(24, [](std::int64_t column, std::int64_t row) {
             return Vector3d(0.02 * static_cast<double>(column), 0, 0.1 * static_cast<double>(row));
         });
         s.background.scale = 0.8;
     }},
    {"sun",
     [](TestScene& s) {
         s.background.image = image_of(32, [](std::int64_t column, std::int64_t row) {
             return Vector3d::Constant(row == 6 && column == 20 ? 60 : row < 16 ? 0.2 : 0);
         });
         s.background.rotation_degrees = 77;
     }},
    {"half_black",
     [](TestScene& s) {
         s.background.image =
             image_of(3, [](std::int64_t column, std::int64_t) { return Vector3d::Constant(column < 3 ? 0.7 : 0); });
         s.background.rotation_degrees = -100;
     }},
    {"sky_and_lamps",
     [](TestScene& s) {
         s.background.image = image_of(1, [](std::int64_t column, std::int64_t) {
             return Vector3d::Constant(0.3 + 0.4 * static_cast<double>(column));
         });
         s.quad({-1, 2.5, -1}, {1.5, 0, 0}, {0, 0, 1.5}, s.emitter(3));
         s.sphere({1.5, 2, -1}, 0.3, s.emitter(5));
     }},
    {"sky_through_glass_and_a_wall_in_motion",
     [](TestScene& s) {
         s.background.image = constant(0.8);
         s.sphere({0.3, 0.5, 2}, 0.5, s.glass(1.5));
         s.quad({-3, 0, -2}, {6, 0, 0}, {0, 4, 0}, s.diffuse(0.4));
         s.sphere({-2, 1, 1}, 0.4, s.diffuse(0.8));
         s.spheres.back().center1 = {-1, 1.5, 1};
         s.camera.shutter_close = 1;
     }},
};

class EnvironmentCase : public testing::TestWithParam<Case> {
  protected:
    template <class Scalar>
    static void expect_equal_means() {
        TestScene scene = balls();
        GetParam().set(scene);
        const Rendered by_chance = render_with<Scalar>(scene, LightSampling::None, 400);
        for (const LightSampling sampling : {LightSampling::Mis, LightSampling::Light}) {
            const Rendered rendered = render_with<Scalar>(scene, sampling, 100, 1);
            EXPECT_TRUE(same_means(by_chance, rendered));
            EXPECT_TRUE(sampling == LightSampling::Light || rendered.report.statistics.clamped == 0);
            EXPECT_EQ(rendered.report.statistics.non_finite, 0);
            EXPECT_GT(rendered.report.total(&ThreadReport::shadow_rays), 0);
        }
    }
};
TEST_P(EnvironmentCase, HasTheMeansOfChanceInFloat) {
    expect_equal_means<float>();
}
TEST_P(EnvironmentCase, HasTheMeansOfChanceInDouble) {
    expect_equal_means<double>();
}
INSTANTIATE_TEST_SUITE_P(Physics, EnvironmentCase, testing::ValuesIn(kCases),
                         [](const auto& info) { return std::string(info.param.name); });

constexpr LightSampling kAll[] = {LightSampling::None, LightSampling::Light, LightSampling::Mis};

TEST(EnvironmentImage, OfOneColourIsABackgroundOfThatColour) {
    TestScene colour = balls();
    colour.background = {Vector3d::Constant(0.6), Vector3d::Constant(0.6)};
    TestScene image = balls();
    image.background.image = constant(0.3);
    image.background.scale = 2;
    const Rendered expected = render_with<float>(colour, LightSampling::None, 200);
    for (const LightSampling sampling : kAll)
        EXPECT_TRUE(same_means(expected, render_with<float>(image, sampling, 200, 1)));
}

/// A floor under a sky of one radiance L sends back its albedo times L.
TEST(EnvironmentImage, OfOneColourMeetsTheClosedFormOfAFloor) {
    TestScene scene(64, 64, Vector3d::Zero());
    scene.plane({0, 0, 0}, {0, 1, 0}, scene.diffuse(0.7));
    scene.look({0.5, 3, 1}, {0, 0, 0}, 10);
    scene.background.image = constant(0.6);
    for (const LightSampling sampling : {LightSampling::Light, LightSampling::Mis})
        EXPECT_TRUE(mean_agrees(pixel_values(render_with<float>(scene, sampling, 64)), 0.7 * 0.6));
}

/// The irradiance of a texel on a floor: its radiance times its width in angle times half the difference of the squared
/// sines of its edges, seen from the pole.
TEST(EnvironmentImage, OfASmallSunMeetsItsClosedFormWithLittleNoise) {
    constexpr double kPi = std::numbers::pi;
    TestScene scene(64, 64, Vector3d::Zero());
    scene.plane({0, 0, 0}, {0, 1, 0}, scene.diffuse(0.7));
    scene.look({0.5, 3, 1}, {0, 0, 0}, 10);
    scene.background.image = image_of(256, [](std::int64_t column, std::int64_t row) {
        return Vector3d::Constant(row == 80 && column == 411 ? 1e6 : 0);
    });
    const double sine_0 = std::sin(kPi * 80 / 256);
    const double sine_1 = std::sin(kPi * 81 / 256);
    const double irradiance = 1e6 * 2 * kPi / 512 * (sine_1 * sine_1 - sine_0 * sine_0) / 2;
    const double expected = 0.7 / kPi * irradiance;
    for (const LightSampling sampling : {LightSampling::Light, LightSampling::Mis}) {
        const std::vector<double> values = pixel_values(render_with<float>(scene, sampling, 16));
        EXPECT_TRUE(mean_agrees(values, expected));
        // A path that meets the sun by chance as well brings about as much once more, in one of some thousand samples.
        const double most = sampling == LightSampling::Light ? 0.02 : 0.2;
        for (const double value : values) ASSERT_NEAR(value / expected, 1, most);
    }
}

/// Where every surface is white and every direction is 1, all is 1.
TEST(EnvironmentImage, OfOneColourIsAFurnace) {
    Scene scene = small_scene("furnace", 48);
    scene.background = {};
    scene.background.image = constant(1);
    const Rendered by_chance = render_with<float>(scene, LightSampling::None, 4, 0, 1000);
    for (const double value : pixel_values(by_chance)) ASSERT_EQ(value, 1);
    for (const LightSampling sampling : {LightSampling::Light, LightSampling::Mis})
        EXPECT_TRUE(mean_agrees(pixel_values(render_with<float>(scene, sampling, 64, 0, 1000)), 1));
}

/// Of nothing but the image, seen by a narrow camera: from the centre of each texel, however the image is turned.
TEST(EnvironmentImage, IsSeenWhereItsRotationTakesIt) {
    constexpr double kPi = std::numbers::pi;
    const auto image = image_of(4, [](std::int64_t column, std::int64_t row) {
        return Vector3d::Constant(static_cast<double>(8 * row + column + 1));
    });
    for (const double rotation : {0.0, 45.0, -90.0, 200.0}) {
        for (int texel = 0; texel < 32; ++texel) {
            const double down = kPi * (texel / 8 + 0.5) / 4;
            const double around = 2 * kPi * (texel % 8 + 0.5) / 8 - rotation / 180 * kPi;
            const Vector3d toward(-std::sin(down) * std::sin(around), std::cos(down),
                                  std::sin(down) * std::cos(around));
            TestScene scene(2, 2, Vector3d::Zero());
            scene.background.image = image;
            scene.background.rotation_degrees = rotation;
            scene.look({1, 2, 3}, Vector3d(1, 2, 3) + toward, 0.01);
            for (const double value : pixel_values(render_with<float>(scene, LightSampling::Mis, 1)))
                ASSERT_NEAR(value, texel + 1, 1e-6) << rotation;
        }
    }
}

}  // namespace
}  // namespace raypool
