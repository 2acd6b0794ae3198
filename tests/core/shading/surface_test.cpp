/// Points on surfaces: where rays land, on which side, and what a moving sphere makes of it.
#include <gtest/gtest.h>

#include "core/shading/shade.h"
#include "tests/core/geometry/exact_sphere.h"
#include "tests/errors.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

template <class Scalar>
using SphereRow = std::array<Scalar, SurfaceRow<Scalar>::kColumns>;

template <class Scalar>
SphereRow<Scalar> sphere_row(const Vec3<Scalar>& center, Scalar radius) {
    return {center[0], center[1], center[2], radius};
}

struct Landing {
    Errors off_surface;  ///< distance of the point from the sphere, over the radius
    Errors normal;       ///< distance between the unit normals, computed and exact
};

/// Where rays from `distance` radii away land on a sphere.
template <class Scalar>
Landing land(double distance) {
    RandomInputs random(1);
    Landing landing;
    for (int i = 0; i < kInputs / 20; ++i) {
        const Vec3<Scalar> center = random.point<Scalar>(1);
        const Vec3<double> away = random.direction<double>();
        Ray<Scalar> ray{(center.template cast<double>() + distance * away).template cast<Scalar>(), center, 0};
        const Vec3<double> target =
            center.template cast<double>() + random.uniform(0, 0.9) * random.direction<double>();
        ray.direction = (target - ray.origin.template cast<double>()).normalized().template cast<Scalar>();
        const ExactSphere exact(ray.origin, ray.direction, center, Scalar(1));
        const Scalar t = sphere_distance<Scalar>(ray.origin, ray.direction, center, Scalar(1), false);
        const auto row = sphere_row<Scalar>(center, 1);
        const SurfacePoint<Scalar> point = surface_point<Features{}, Scalar>(ray, t, row.data());
        EXPECT_TRUE(point.is_front);

        const ExactVec c = ExactVec::of<Scalar>(center);
        landing.off_surface.add((ExactVec::of<Scalar>(point.position) - c).norm() - 1);
        const ExactVec p = ExactVec::of<Scalar>(ray.origin) + exact.first * ExactVec::of<Scalar>(ray.direction);
        landing.normal.add((p - c - ExactVec::of<Scalar>(point.outward)).norm());
    }
    return landing;
}

TEST(SurfacePoint, LiesOnAFarSphere) {
    EXPECT_LT(land<float>(10).off_surface.quantile(0.99), 2e-7);
    EXPECT_LT(land<float>(100).off_surface.quantile(0.99), 2e-7);
    EXPECT_LT(land<float>(1000).off_surface.quantile(0.99), 2e-7);
}

TEST(SurfacePoint, KeepsItsNormalOnAVeryFarSphereInDouble) {
    const Landing landing = land<double>(1e7);
    EXPECT_LT(landing.off_surface.quantile(0.99), 4e-16);
    EXPECT_LT(landing.normal.quantile(0.99), 1e-8);
}

TEST(SurfacePoint, LiesOnAHugeGroundSphere) {
    RandomInputs random(2);
    const Vec3<float> center = vec3<float>(0, -1000, 0);
    const auto row = sphere_row<float>(center, 1000);
    Errors off_surface;
    for (int i = 0; i < kInputs / 20; ++i) {
        Vec3<double> target = random.point<double>(11);
        target[1] = 0;
        const Vec3<float> eye = vec3<float>(13, 2, 3);
        const Ray<float> ray{eye, (target - eye.cast<double>()).normalized().cast<float>(), 0};
        const float t = sphere_distance<float>(ray.origin, ray.direction, center, 1000.0F, false);
        if (!(t < 100)) continue;
        const Vec3<float> p = surface_point<Features{}, float>(ray, t, row.data()).position;
        off_surface.add(((p.cast<double>() - center.cast<double>()).norm() - 1000) / 1000);
    }
    EXPECT_GT(off_surface.count(), static_cast<std::size_t>(kInputs / 25));
    EXPECT_LT(off_surface.quantile(0.99), 2e-8);
}

TEST(SurfacePoint, HasAUnitNormalAgainstTheRay) {
    RandomInputs random(3);
    Errors length;
    for (int i = 0; i < kInputs / 4; ++i) {
        const Vec3<float> center = random.point<float>(3);
        const auto row = sphere_row<float>(center, 2);
        const Ray<float> ray{along<float>(center, static_cast<float>(random.uniform(0, 4)), random.direction<float>()),
                             random.direction<float>(), 0};
        const float t = sphere_distance<float>(ray.origin, ray.direction, center, 2.0F, false);
        if (!(t < kInfinity<float>)) continue;
        const SurfacePoint<float> point = surface_point<Features{}, float>(ray, t, row.data());
        length.add(point.normal.cast<double>().norm() - 1);
        ASSERT_LE(dot<float>(point.normal, ray.direction), 0);
        ASSERT_EQ(point.normal, point.is_front ? point.outward : Vec3<float>(-point.outward));
    }
    EXPECT_LT(length.max(), 2.5e-7);
}

TEST(SurfacePoint, OfAFlatShapeIsThePointOnTheRayWithTheStoredNormal) {
    SphereRow<float> row = sphere_row<float>(vec3<float>(0, 1, 0), PlanarMark<float>::make(0));
    const Ray<float> down{vec3<float>(1, 5, 2), vec3<float>(0, -1, 0), 0};
    const SurfacePoint<float> above = surface_point<kEverything, float>(down, 5.0F, row.data());
    EXPECT_EQ(above.position, vec3<float>(1, 0, 2));
    EXPECT_EQ(above.normal, vec3<float>(0, 1, 0));
    EXPECT_TRUE(above.is_front);
    const Ray<float> up{vec3<float>(1, -5, 2), vec3<float>(0, 1, 0), 0};
    const SurfacePoint<float> below = surface_point<kEverything, float>(up, 5.0F, row.data());
    EXPECT_EQ(below.normal, vec3<float>(0, -1, 0));
    EXPECT_FALSE(below.is_front);
}

TEST(MovingCentre, StaysWhereItIsWithoutMotionAndNeverLeavesItsSegment) {
    RandomInputs random(4);
    for (int i = 0; i < kInputs; ++i) {
        const Vec3<float> a = random.point<float>(100);
        const Vec3<float> motion = random.point<float>(1);
        const float time = random.unit_interval<float>();
        ASSERT_EQ(center_at<float>(a, vec3<float>(0, 0, 0), time), a);
        ASSERT_EQ(center_at<float>(a, motion, 0.0F), a);
        const Vec3<float> b = center_at<float>(a, motion, 1.0F);
        const Vec3<float> at = center_at<float>(a, motion, time);
        for (int k = 0; k < 3; ++k) ASSERT_TRUE(at[k] >= std::min(a[k], b[k]) && at[k] <= std::max(a[k], b[k]));
    }
}

TEST(Sky, RunsFromBottomToTopWithHeight) {
    const Sky<float> sky{vec3<float>(0.75F, 0.5F, 1), vec3<float>(-0.25F, 0.25F, 0)};
    EXPECT_EQ(sky_radiance<float>(sky, vec3<float>(0, -1, 0)), vec3<float>(1, 0.25F, 1));
    EXPECT_EQ(sky_radiance<float>(sky, vec3<float>(1, 0, 0)), vec3<float>(0.75F, 0.5F, 1));
    EXPECT_EQ(sky_radiance<float>(sky, vec3<float>(0, 1, 0)), vec3<float>(0.5F, 0.75F, 1));
}

}  // namespace
}  // namespace raypool::test
