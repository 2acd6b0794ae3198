/// Checkers that stay right far from the origin and on the paper's ground, and coordinates on spheres.
#include "core/shading/textures.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "core/scene/scene_reader.h"
#include "core/shading/compiled_scene.h"
#include "core/shading/shade.h"
#include "tests/core/geometry/exact_sphere.h"
#include "tests/core/shading/colour_of.h"
#include "tests/errors.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

template <class Scalar>
TwoParts<Scalar> split_scale(double edge) {
    const Scalar high = static_cast<Scalar>(1 / edge);
    return {high, static_cast<Scalar>(1 / edge - static_cast<double>(high))};
}

/// Parity of the cell, in 128-bit arithmetic; -1 where rounding of 1 / edge to two Scalars decides.
int exact_parity(double x, double edge) {
    const Float128 cell = Float128{x} / edge;
    auto below = static_cast<std::int64_t>(cell);
    if (static_cast<Float128>(below) > cell) --below;
    const auto part = static_cast<double>(cell - static_cast<Float128>(below));
    const double undecided = edge == 1 ? 0 : 0x1p-44 * std::abs(static_cast<double>(cell));
    return part < undecided || part > 1 - undecided ? -1 : static_cast<int>(below & 1);
}

TEST(Checker, FindsTheCellFarFromTheOrigin) {
    for (const double edge : {0.32, 1.0, 0.7, 7.7}) {
        for (const double reach : {10.0, 1e5, 1e6, 1e9}) {
            RandomInputs random(1);
            int wrong = 0;
            for (int i = 0; i < kInputs / 20; ++i) {
                const float x = static_cast<float>(random.uniform(-reach, reach));
                const int parity = exact_parity(x, edge);
                if (parity >= 0 && cell_parity<float>(x, split_scale<float>(edge)) != static_cast<float>(parity))
                    ++wrong;
            }
            EXPECT_EQ(wrong, 0) << edge << ' ' << reach;
        }
    }
}

TEST(Checker, IsJudgedByCasesThatASingleProductGetsWrong) {
    RandomInputs random(1);
    int judged = 0;
    int wrong = 0;
    for (int i = 0; i < kInputs / 20; ++i) {
        const float x = static_cast<float>(random.uniform(-1e6, 1e6));
        const int parity = exact_parity(x, 0.32);
        if (parity < 0) continue;
        ++judged;
        if (std::abs(std::fmod(std::floor(x * (1 / 0.32F)), 2.0F)) != static_cast<float>(parity)) ++wrong;
    }
    EXPECT_GT(judged, kInputs / 30);
    EXPECT_GT(wrong, judged / 50);
}

TEST(Checker, PutsABoundaryIntoTheCellAboveIt) {
    for (const float edge : {0.25F, 1.0F, 4.0F}) {
        for (int k = -1000; k <= 1000; ++k) {
            const float boundary = static_cast<float>(k) * edge;
            const TwoParts<float> scale = split_scale<float>(edge);
            ASSERT_EQ(cell_parity<float>(boundary, scale), k & 1) << boundary;
            const float below = k == 0 ? -1e-6F : std::nextafter(boundary, -kInfinity<float>);
            ASSERT_EQ(cell_parity<float>(below, scale), (k - 1) & 1) << boundary;
        }
    }
    EXPECT_EQ(cell_parity<float>(-0.0F, split_scale<float>(1)), 0);
}

TEST(Checker, CountsTheSumOfThreeCells) {
    for (int cell = 0; cell < 64; ++cell) {
        const int x = cell % 4 - 2, y = cell / 4 % 4 - 2, z = cell / 16 - 2;
        const Vec3<float> p = vec3<float>(x + 0.5F, y + 0.5F, z + 0.5F);
        EXPECT_EQ(is_odd_cell<float>(p, vec3<float>(0, 0, 0), split_scale<float>(1)), ((x + y + z) & 1) != 0);
    }
}

/// The colour of the point where a ray meets the ground of `paper`, in Scalar; black where it does not.
template <class Scalar>
Vec3<double> ground_colour(const CompiledScene<Scalar>& scene, int ground_id, const Vec3<double>& origin,
                           const Vec3<double>& target) {
    const auto* row = scene.surfaces[ground_id].value;
    const Vec3<Scalar> center = vec3<Scalar>(row[0], row[1], row[2]);
    const Ray<Scalar> ray{origin.cast<Scalar>(), unit<Scalar>((target - origin).cast<Scalar>()), 0};
    const Scalar t = sphere_distance<Scalar>(ray.origin, ray.direction, center, row[3], false);
    if (!(t < kInfinity<Scalar>)) return vec3<double>(0, 0, 0);
    const SurfacePoint<Scalar> point = surface_point<kEverything, Scalar>(ray, t, row);
    return colour_of(scene, point, ground_id, row);
}

/// Rounding may only decide beside a boundary: within `reach` of one.
TEST(Checker, IsFreeOfNoiseOnThePapersGround) {
    const Scene scene = builtin_scene("paper");
    const CompiledScene<float> in_float = compile<float>(scene);
    const CompiledScene<double> in_double = compile<double>(scene);
    int ground_id = 0;
    while (scene.spheres[ground_id].radius < 100) ++ground_id;
    const double edge = scene.textures[scene.materials[scene.spheres[ground_id].material_id].texture_id].scale;

    RandomInputs random(2);
    int differ = 0;
    int odd = 0;
    int compared = 0;
    for (int i = 0; i < kInputs / 4; ++i) {
        Vec3<double> target = random.point<double>(11);
        target[1] = std::sqrt(1e6 - target[0] * target[0] - target[2] * target[2]) - 1000;  // on the ground
        const auto near_boundary = [&](double x) { return std::abs(x / edge - std::round(x / edge)) < 1e-3; };
        if (near_boundary(target[0]) || near_boundary(target[2])) continue;
        ++compared;
        const Vec3<double> colour = ground_colour<float>(in_float, ground_id, scene.camera.look_from, target);
        if ((colour - ground_colour<double>(in_double, ground_id, scene.camera.look_from, target)).norm() > 1e-6)
            ++differ;
        if (colour[0] > 0.5) ++odd;
    }
    EXPECT_GT(compared, kInputs / 5);
    EXPECT_EQ(differ, 0);
    EXPECT_NEAR(static_cast<double>(odd) / compared, 0.5, 0.01);
}

TEST(SphereCoordinates, GoOnceAroundFromMinusXAndUpFromMinusY) {
    const auto expect = [](float x, float y, float z, float u, float v) {
        const auto [got_u, got_v] = sphere_coordinates<float>(vec3<float>(x, y, z));
        EXPECT_NEAR(got_u, u, 1e-6F) << x << ' ' << y << ' ' << z;
        EXPECT_NEAR(got_v, v, 1e-6F) << x << ' ' << y << ' ' << z;
    };
    expect(1, 0, 0, 0.5F, 0.5F);
    expect(0, 0, 1, 0.25F, 0.5F);
    expect(0, 0, -1, 0.75F, 0.5F);
    expect(-1, 0, 1e-7F, 0, 0.5F);
    expect(-0.5F, std::sqrt(0.5F), 0.5F, 0.125F, 0.75F);
    EXPECT_NEAR(sphere_coordinates<float>(vec3<float>(0, 1, 0))[1], 1, 1e-6F);
    EXPECT_NEAR(sphere_coordinates<float>(vec3<float>(0, -1, 0))[1], 0, 1e-6F);
}

TEST(SphereCoordinates, AreAccurateAndWithinTheUnitSquare) {
    RandomInputs random(3);
    Errors errors;
    for (int i = 0; i < kInputs / 4; ++i) {
        const Vec3<float> n = random.direction<float>();
        const auto [u, v] = sphere_coordinates<float>(n);
        ASSERT_TRUE(u >= 0 && u < 1 && v >= 0 && v <= 1) << u << ' ' << v;
        const Vec3<double> exact = n.cast<double>().normalized();
        const double around = std::atan2(-exact[2], exact[0]) / (2 * std::numbers::pi) + 0.5;
        const double difference = std::abs(u - around);
        errors.add(std::min(difference, 1 - difference));
        errors.add(v - std::acos(-exact[1]) / std::numbers::pi);
    }
    EXPECT_LT(errors.max(), 3e-7);
}

}  // namespace
}  // namespace raypool::test
