// What rays see that meet nothing, or only mirrors; and what the depth leaves of an image.

#include <gtest/gtest.h>

#include <vector>

#include "tests/physics/test_scene.h"

namespace raypool {
namespace {

template <class Scalar>
class Sky : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(Sky, Precisions);

TestScene gradient_scene(std::int64_t width, std::int64_t height) {
    TestScene scene(width, height, {0.25, 0.5, 0.75});
    scene.background.top = {1, 0.5, 0.125};
    return scene;
}

/// A camera so narrow that every ray of it has the direction asked for.
TYPED_TEST(Sky, OfAnEmptySceneIsTheGradientOfItsBackground) {
    for (const Vector3d& toward : {Vector3d(0, 1, 0), Vector3d(0, -1, 0), Vector3d(1, 0, 0), Vector3d(-3, 2, 1)}) {
        TestScene scene = gradient_scene(8, 8);
        scene.look({5, -7, 2}, Vector3d(5, -7, 2) + toward, 0.001);
        const Rendered rendered = render<TypeParam>(scene, 2, 50);
        const double s = (toward.normalized().y() + 1) / 2;
        for (std::size_t i = 0; i < rendered.image().rgb.size(); ++i) {
            const auto c = static_cast<Eigen::Index>(i % 3);
            const double expected =
                scene.background.bottom[c] + s * (scene.background.top[c] - scene.background.bottom[c]);
            EXPECT_NEAR(rendered.image().rgb[i], expected, 1e-5);
        }
        EXPECT_EQ(rendered.report.segments(), rendered.report.paths());
    }
}

TYPED_TEST(Sky, InAFlatMirrorIsTheSkyUpsideDown) {
    TestScene mirror = gradient_scene(48, 32);
    mirror.plane({0, 0, 0}, {0, 1, 0}, mirror.mirror(1));
    mirror.look({0, 2, 0}, {0, 0, -2}, 50);
    TestScene flipped = gradient_scene(48, 32);
    std::swap(flipped.background.bottom, flipped.background.top);
    flipped.look({0, 2, 0}, {0, 0, -2}, 50);

    const Rendered seen = render<TypeParam>(mirror, 2, 50);
    const Rendered expected = render<TypeParam>(flipped, 2, 50);
    EXPECT_EQ(seen.report.segments(), 2 * seen.report.paths());
    for (std::size_t i = 0; i < seen.image().rgb.size(); ++i)
        ASSERT_NEAR(seen.image().rgb[i], expected.image().rgb[i], 1e-6);
}

TYPED_TEST(Sky, InAMirrorHasExactlyTheSkysColourTimesTheMirrors) {
    TestScene scene(32, 32, Vector3d::Constant(0.9));
    scene.sphere({0, 0, 0}, 1, scene.mirror(0.7));
    scene.look({0, 0, 4}, {0, 0, 0}, 20);
    const Rendered rendered = render<TypeParam>(scene, 1, 50);
    EXPECT_EQ(rendered.report.segments(), 2 * rendered.report.paths());
    const double expected = static_cast<TypeParam>(0.7) * static_cast<TypeParam>(0.9);
    const double step = 1 / rendered.framebuffer.fixed_point().scale();
    for (const double value : pixel_values(rendered)) ASSERT_NEAR(value, expected, step);
}

TYPED_TEST(Sky, IsBlackAtDepthZeroAndAloneAtDepthOne) {
    const Scene scene = small_scene("glass_stack", 48);
    const Rendered black = render<TypeParam>(scene, 2, 0);
    for (const std::int64_t sum : black.framebuffer.sums()) ASSERT_EQ(sum, 0);
    EXPECT_EQ(black.report.segments(), 0);
    EXPECT_EQ(black.report.paths(), 2 * 48 * 36);

    // At depth one a sample is black, or what it would be in the empty scene.
    Scene empty = scene;
    empty.spheres.clear();
    empty.planes.clear();
    const std::vector<double> sky = pixel_values(render<TypeParam>(empty, 1, 1));
    const std::vector<double> seen = pixel_values(render<TypeParam>(scene, 1, 1));
    std::int64_t black_count = 0;
    for (std::size_t i = 0; i < sky.size(); ++i) {
        ASSERT_TRUE(seen[i] == 0 || seen[i] == sky[i]);
        black_count += seen[i] == 0 ? 1 : 0;
    }
    EXPECT_EQ(black_count, hit_count<TypeParam>(scene, 1));
    EXPECT_GT(black_count, 500);
    EXPECT_LT(black_count, 48 * 36 - 20);
}

}  // namespace
}  // namespace raypool
