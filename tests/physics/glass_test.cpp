// Glass against Fresnel's equations. A furnace of glass is 1 whatever the split between reflection and refraction, so
// here the depth, or where the light stands, tells them apart.

#include <gtest/gtest.h>

#include <numbers>

#include "tests/physics/agreement.h"
#include "tests/physics/test_scene.h"

namespace raypool {
namespace {

/// Reflectance for unpolarised light by Snell's law and Fresnel's equations in sines and tangents of angles.
double fresnel(double angle_in, double index_in, double index_out) {
    if (angle_in < 1e-9) return std::pow((index_in - index_out) / (index_in + index_out), 2);
    const double sine = std::sin(angle_in) * index_in / index_out;
    if (sine >= 1) return 1;
    const double angle_out = std::asin(sine);
    const double r_s = std::sin(angle_in - angle_out) / std::sin(angle_in + angle_out);
    const double r_p = std::tan(angle_in - angle_out) / std::tan(angle_in + angle_out);
    return (r_s * r_s + r_p * r_p) / 2;
}

/// Mean over a disc of parallel rays onto a unit sphere of f(angle): the integral of f(asin(s)) 2 s ds.
template <class Function>
double mean_over_disc(Function f) {
    constexpr int kSteps = 20000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double s_squared = (i + 0.5) / kSteps;
        sum += f(std::asin(std::sqrt(s_squared)));
    }
    return sum / kSteps;
}

template <class Scalar>
class Glass : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(Glass, Precisions);

/// A glass sphere under a white sky, seen from far. A path of D segments is home if it reflects at once, or comes out
/// after fewer than D - 2 reflections within; inside a sphere every one has the same angle, and so the same chance. A
/// path that splits gives each branch that chance as its weight.
TYPED_TEST(Glass, SphereReflectsAndRefractsAsFresnelSaysSplitOrNot) {
    for (const double ior : {1.5, 2.4, 1 / 1.5}) {
        TestScene scene(256, 256, Vector3d::Ones());
        scene.sphere({0, 0, 0}, 1, scene.glass(ior));
        scene.look({0, 0, 1000}, {0, 0, 0}, 0.12);
        constexpr std::int64_t kSpp = 4;
        const std::int64_t hits = hit_count<TypeParam>(scene, kSpp);
        const std::int64_t paths = kSpp * scene.width * scene.height;
        EXPECT_GT(hits, paths / 3);
        for (const std::int32_t depth : {2, 3, 4, 8}) {
            const double expected = mean_over_disc([&](double angle) {
                const double r = fresnel(angle, 1, ior);
                double home = r;
                for (int inside = 1; inside <= depth - 2; ++inside) home += (1 - r) * (1 - r) * std::pow(r, inside - 1);
                return home;
            });
            for (const int split_depth : {0, 1, 3}) {
                const Rendered rendered = render<TypeParam>(scene, kSpp, depth, split_depth);
                const auto home_from_sphere =
                    rendered.mean(0) * static_cast<double>(paths) - static_cast<double>(paths - hits);
                EXPECT_TRUE(share_agrees(home_from_sphere, static_cast<double>(hits), expected))
                    << "ior " << ior << ", depth " << depth << ", split depth " << split_depth;
            }
        }
    }
}

/// Inside a glass ball, at its centre, every ray is along the normal: a part of ((n - 1) / (n + 1))^2 stays inside.
TYPED_TEST(Glass, KeepsFourPercentOfWhatComesAlongTheNormal) {
    TestScene scene(256, 256, Vector3d::Ones());
    scene.sphere({0, 0, 0}, 1, scene.glass(1.5));
    scene.look({0, 0, 0}, {0, 0, -1}, 100);
    const Rendered rendered = render<TypeParam>(scene, 4, 2);
    EXPECT_EQ(hit_count<TypeParam>(scene, 1), scene.width * scene.height);
    EXPECT_TRUE(mean_agrees(pixel_values(rendered), 1 - 0.04));
}

/// Through a slab with reflections to and fro, light from behind arrives as (1 - R) / (1 + R).
TYPED_TEST(Glass, SlabLetsThroughWhatTheSeriesOfItsReflectionsAddsUpTo) {
    for (const double degrees : {0.0, 45.0, 75.0, 88.0}) {
        const double angle = degrees * std::numbers::pi / 180;
        TestScene scene(256, 256, Vector3d::Zero());
        const std::int32_t glass = scene.glass(1.5);
        scene.plane({0, 0, 0}, {0, 1, 0}, glass);
        scene.plane({0, -0.5, 0}, {0, -1, 0}, glass);
        scene.plane({0, -3, 0}, {0, 1, 0}, scene.emitter(1));
        scene.look(3 * Vector3d(std::sin(angle), std::cos(angle), 0), {0, 0, 0}, 0.01);
        const Rendered rendered = render<TypeParam>(scene, 4, 200);
        const double r = fresnel(angle, 1, 1.5);
        EXPECT_TRUE(mean_agrees(pixel_values(rendered), (1 - r) / (1 + r))) << degrees << " degrees";
        EXPECT_GT(rendered.report.segments(), 2 * rendered.report.paths());
    }
}

/// From within glass, beyond the critical angle of 41.8 degrees, the boundary is a perfect mirror.
TYPED_TEST(Glass, ReflectsAllBeyondTheCriticalAngle) {
    for (const double degrees : {42.0, 60.0, 89.0}) {
        const double angle = degrees * std::numbers::pi / 180;
        TestScene scene(8, 8, Vector3d::Zero());
        scene.background.top = Vector3d::Ones();
        scene.plane({0, 0, 0}, {0, 1, 0}, scene.glass(1.5));
        const Vector3d direction(std::sin(angle), std::cos(angle), 0);
        scene.look(-direction, {0, 0, 0}, 0.001);
        const double expected = (1 - std::cos(angle)) / 2;  // the sky toward the mirrored direction
        for (const double value : pixel_values(render<TypeParam>(scene, 8, 50))) EXPECT_NEAR(value, expected, 2e-5);
    }
}

/// Glass with the index of what surrounds it bends no ray and reflects none: the sky behind it has the same bits, and
/// what else is behind it is met at the same place but for rounding.
TYPED_TEST(Glass, OfIndexOneIsInvisible) {
    TestScene bare(64, 48, {1, 1, 1});
    bare.background.top = {0.2, 0.4, 1};
    bare.look({0, 1, 6}, {0, 0, 0}, 40);
    TestScene with_ball = bare;
    with_ball.sphere({0, 0, 2}, 1.5, with_ball.glass(1));
    EXPECT_EQ(hit_count<TypeParam>(bare, 1), 0);
    EXPECT_GT(hit_count<TypeParam>(with_ball, 1), 500);
    EXPECT_EQ(render<TypeParam>(with_ball, 4, 50).hash(), render<TypeParam>(bare, 4, 50).hash());

    const std::int32_t mirror = bare.mirror(0.9);
    bare.sphere({0, 0, -3}, 3, mirror);
    with_ball = bare;
    with_ball.sphere({0, 0, 2}, 1.5, with_ball.glass(1));
    const std::vector<double> expected = pixel_values(render<TypeParam>(bare, 4, 50));
    const std::vector<double> got = pixel_values(render<TypeParam>(with_ball, 4, 50));
    int far_count = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) far_count += std::abs(got[i] - expected[i]) > 2e-6 ? 1 : 0;
    EXPECT_LE(far_count, 2) << "but for rays along the mirror's edge";
}

}  // namespace
}  // namespace raypool
