// Surfaces that scatter: furnaces, cavities and convex bodies, whose radiance is known exactly or in closed form.
// A furnace does not see geometry that vanished, so hits are counted beside every one.

#include <gtest/gtest.h>

#include "tests/physics/agreement.h"
#include "tests/physics/test_scene.h"

namespace raypool {
namespace {

/// Camera rays of the first sample that pass within a sphere's radius of its centre, found by plain geometry.
std::int64_t rays_toward_spheres(const Scene& scene) {
    const Camera<double> camera = make_camera<double>(scene.camera, scene.width, scene.height);
    std::int64_t count = 0;
    for (std::int64_t y = 0; y < scene.height; ++y) {
        for (std::int64_t x = 0; x < scene.width; ++x) {
            const Ray<double> ray =
                camera_ray<kEverything, double>(camera, static_cast<double>(x), static_cast<double>(y),
                                                static_cast<std::uint32_t>(y * scene.width + x), 0, random_seed(0));
            bool is_met = false;
            for (const Sphere& sphere : scene.spheres) {
                const Vector3d to_center = sphere.center0 - ray.origin;
                const double along_ray = to_center.dot(ray.direction);
                is_met |= along_ray > 0 && (to_center - along_ray * ray.direction).norm() < sphere.radius;
            }
            count += is_met ? 1 : 0;
        }
    }
    return count;
}

using Precisions = testing::Types<float, double>;

template <class Scalar>
class Furnace : public testing::Test {};
TYPED_TEST_SUITE(Furnace, Precisions);

TYPED_TEST(Furnace, IsExactlyOneInEveryPixel) {
    const Scene scene = builtin_scene("furnace");
    constexpr std::int64_t kSpp = 4;
    const Rendered rendered = render<TypeParam>(scene, kSpp, 1000);
    const std::int64_t one = kSpp << rendered.framebuffer.fixed_point().fraction_bits;
    for (const std::int64_t sum : rendered.framebuffer.sums()) ASSERT_EQ(sum, one);

    const std::int64_t expected_hits = rays_toward_spheres(scene);
    EXPECT_GT(expected_hits, scene.width * scene.height / 8);
    EXPECT_NEAR(static_cast<double>(hit_count<TypeParam>(scene, 1)), static_cast<double>(expected_hits), 2);
}

TYPED_TEST(Furnace, LosesWhatTheDepthCutsOff) {
    const Scene scene = builtin_scene("furnace");
    const Rendered camera_rays_only = render<TypeParam>(scene, 1, 1);
    const auto hits = static_cast<double>(hit_count<TypeParam>(scene, 1));
    const auto pixels = static_cast<double>(scene.width * scene.height);
    EXPECT_DOUBLE_EQ(camera_rays_only.mean(0), 1 - hits / pixels);
}

template <class Scalar>
class ConvexBody : public testing::Test {};
TYPED_TEST_SUITE(ConvexBody, Precisions);

/// Under a constant sky a diffuse sphere sends back its albedo, and not a path that leaves it meets it again.
TYPED_TEST(ConvexBody, SendsBackItsAlbedoAndNeverMeetsItself) {
    struct Case {
        double place, radius;  // of the sphere; seen from six radii away
    };
    for (const auto& [place, radius] : {Case{0, 1}, {1e4, 1}, {1e6, 100}, {0, 1e-4}, {0, 1000}, {0, 1e6}}) {
        constexpr double kAlbedo = 0.7;
        constexpr double kSky = 0.9;
        TestScene scene(48, 48, Vector3d::Constant(kSky));
        const Vector3d center(place, -place, place);
        scene.sphere(center, radius, scene.diffuse(kAlbedo));
        scene.look(center + Vector3d(0, 0, 6 * radius), center, 28);
        const Rendered rendered = render<TypeParam>(scene, 1, 50);

        const auto sky = static_cast<TypeParam>(kSky);
        const double on_sphere = static_cast<TypeParam>(kAlbedo) * sky;
        const double step = 1 / rendered.framebuffer.fixed_point().scale();
        std::int64_t hits = 0;
        for (const double value : pixel_values(rendered)) {
            hits += std::abs(value - on_sphere) <= step ? 1 : 0;
            ASSERT_TRUE(std::abs(value - on_sphere) <= step || std::abs(value - sky) <= step)
                << value << " at " << place << " with radius " << radius;
        }
        EXPECT_EQ(rendered.report.segments(), rendered.report.paths() + hits);
        const auto expected_hits = static_cast<double>(rays_toward_spheres(scene));
        EXPECT_GT(expected_hits, 48 * 48 / 4);
        EXPECT_NEAR(static_cast<double>(hits), expected_hits, place == 0 ? 2 : 0.01 * expected_hits);
    }
}

template <class Scalar>
class Cavity : public testing::Test {};
TYPED_TEST_SUITE(Cavity, Precisions);

/// White walls and no light: every path goes on to its depth, and what leaks out would be seen as light.
TYPED_TEST(Cavity, LetsNothingOut) {
    struct Case {
        double place, radius;
    };
    for (const auto& [place, radius] : {Case{0, 1}, {1e4, 1}, {1e6, 100}, {0, 1e-4}, {0, 1e6}}) {
        for (const bool is_mirror : {false, true}) {
            TestScene scene(24, 24, Vector3d::Ones());
            const Vector3d center(place, -place, place);
            scene.sphere(center, radius, is_mirror ? scene.mirror(1) : scene.diffuse(1));
            scene.look(center + Vector3d(0, 0.5 * radius, 0), center, 90);
            const Rendered rendered = render<TypeParam>(scene, 1, 200);
            EXPECT_EQ(rendered.report.segments(), 200 * rendered.report.paths()) << place << " " << radius;
            EXPECT_EQ(rendered.mean(0), 0);
        }
    }
}

TYPED_TEST(Cavity, OfSixQuadsLetsNothingOut) {
    TestScene scene(32, 32, Vector3d::Ones());
    const std::int32_t white = scene.diffuse(1);
    const Vector3d axes[] = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
    for (int i = 0; i < 3; ++i) {
        const Vector3d u = 2 * axes[(i + 1) % 3];
        const Vector3d v = 2 * axes[(i + 2) % 3];
        scene.quad(-Vector3d::Ones(), u, v, white);
        scene.quad(-Vector3d::Ones() + 2 * axes[i], u, v, white);
    }
    scene.look({0.1, 0.2, 0.3}, {1, 0, 0}, 120);
    const Rendered rendered = render<TypeParam>(scene, 1, 500);
    EXPECT_EQ(rendered.report.segments(), 500 * rendered.report.paths());
    EXPECT_EQ(rendered.mean(0), 0);
}

/// An integrating sphere: from any point of a diffuse sphere's wall, the next hit is uniform over its area. A plane
/// that shines cuts off the part f of it. A wall of albedo a, seen through paths of at most D segments, then has the
/// radiance a f (1 - q^(D-1)) / (1 - q), q = a (1 - f), of the plane's.
TYPED_TEST(Cavity, WithAShiningPortHasTheRadianceOfAnIntegratingSphere) {
    constexpr double kAlbedo = 0.99;
    constexpr double kHeight = 0.875;  // of the port above the centre, in radii: whole in float at 1e4
    constexpr double kPort = (1 - kHeight) / 2;
    for (const double place : {0.0, 1e4}) {
        for (const std::int32_t depth : {1, 2, 5, 50, 400}) {
            TestScene scene(128, 128, Vector3d::Zero());
            const Vector3d center = Vector3d::Constant(place);
            scene.sphere(center, 1, scene.diffuse(kAlbedo));
            scene.plane(center + Vector3d(0, kHeight, 0), {0, 1, 0}, scene.emitter(1));
            scene.look(center, center - Vector3d::UnitY(), 60);
            const Rendered rendered = render<TypeParam>(scene, 4, depth);
            const double q = kAlbedo * (1 - kPort);
            const double expected = kAlbedo * kPort * (1 - std::pow(q, depth - 1)) / (1 - q);
            if (depth == 1) {
                EXPECT_EQ(rendered.mean(0), 0);
            } else {
                EXPECT_TRUE(mean_agrees(pixel_values(rendered), expected)) << "depth " << depth << " at " << place;
            }
        }
    }
}

/// Float's paths fade to nothing below 2^-126, double's below 2^-1022; both are flushed to zero there and end.
TEST(FadingPath, EndsWhereItsThroughputIsNoNormalNumber) {
    TestScene scene(4, 4, Vector3d::Ones());
    scene.sphere({0, 0, 0}, 1, scene.diffuse(0.5));
    scene.look({0, 0, 0}, {0, 0, -1}, 90);
    EXPECT_EQ(render<float>(scene, 1, 5000).report.segments(), 127 * 16);
    EXPECT_EQ(render<double>(scene, 1, 5000).report.segments(), 1023 * 16);
}

}  // namespace
}  // namespace raypool
