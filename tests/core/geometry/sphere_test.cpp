/// Rays against spheres, judged by 128-bit arithmetic: far, grazing, huge, tiny, translated, and left again.
#include <gtest/gtest.h>

#include "core/geometry/shapes.h"
#include "core/shading/materials.h"
#include "core/shading/shade.h"
#include "tests/core/geometry/aimed_ray.h"
#include "tests/core/geometry/exact_sphere.h"
#include "tests/errors.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

constexpr int kRays = kInputs / 20;  // 128-bit arithmetic is slow

struct Verdict {
    int false_misses = 0;
    int false_hits = 0;
    int hits = 0;
    Errors distance;  ///< relative
};

/// Against unit spheres up to `center_edge` off the origin, missed as often as hit. Only rays whose distance from a
/// tangent is within the rounding of origin minus centre are let off.
template <class Scalar>
Verdict judge(double distance, double center_edge) {
    RandomInputs random(1);
    Verdict verdict;
    const double undecided = center_edge > 0 ? distance * std::numeric_limits<Scalar>::epsilon() : 0;
    for (int i = 0; i < kRays; ++i) {
        const Vec3<Scalar> center = random.point<Scalar>(center_edge);
        const Ray<Scalar> ray = aimed<Scalar>(random, center, 1, distance, random.uniform(0, 2));
        const ExactSphere exact(ray.origin, ray.direction, center, Scalar(1));
        const Scalar t = sphere_distance<Scalar>(ray.origin, ray.direction, center, Scalar(1), false);
        const bool is_hit = t < kInfinity<Scalar>;
        if (exact.is_met() && is_hit) {
            ++verdict.hits;
            verdict.distance.add((t - exact.first) / exact.first);
        } else if (std::abs(static_cast<double>(exact.impact) - 1) >= undecided) {
            verdict.false_misses += exact.is_met() && !is_hit ? 1 : 0;
            verdict.false_hits += !exact.is_met() && is_hit ? 1 : 0;
        }
    }
    return verdict;
}

TEST(SphereDistance, IsRightAboutFarSpheres) {
    for (const double distance : {3.0, 10.0, 100.0, 1e3}) {
        for (const double center_edge : {0.0, 1.0}) {
            const Verdict verdict = judge<float>(distance, center_edge);
            EXPECT_EQ(verdict.false_misses, 0) << distance;
            EXPECT_EQ(verdict.false_hits, 0) << distance;
            EXPECT_GT(verdict.hits, kRays / 3);
            EXPECT_LT(verdict.distance.quantile(0.99), 4e-7) << distance;
        }
    }
}

TEST(SphereDistance, IsRightAboutVeryFarSpheresInDouble) {
    for (const double distance : {1e3, 1e7}) {
        const Verdict verdict = judge<double>(distance, 1);
        EXPECT_EQ(verdict.false_misses, 0) << distance;
        EXPECT_EQ(verdict.false_hits, 0) << distance;
        EXPECT_GT(verdict.hits, kRays / 3);
        EXPECT_LT(verdict.distance.quantile(0.99), 1e-15) << distance;
    }
}

TEST(SphereDistance, MeetsGrazedSpheres) {
    RandomInputs random(2);
    int grazed = 0;
    int missed = 0;
    Errors errors;
    for (int i = 0; i < kRays; ++i) {
        const Vec3<float> center = vec3<float>(0, 0, 0);
        const Ray<float> ray = aimed<float>(random, center, 1, 10, 1 - 1e-6);
        const ExactSphere exact(ray.origin, ray.direction, center, 1.0F);
        if (std::abs(static_cast<double>(exact.impact) - (1 - 1e-6)) > 0.5e-6) continue;  // the direction was rounded
        ++grazed;
        const float t = sphere_distance<float>(ray.origin, ray.direction, center, 1.0F, false);
        if (t == kInfinity<float>)
            ++missed;
        else
            errors.add((t - exact.first) / exact.first);
    }
    EXPECT_GT(grazed, kRays / 4);
    EXPECT_EQ(missed, 0);
    EXPECT_LT(errors.max(), 5e-5);
}

TEST(SphereDistance, IsAccurateOnAHugeGroundSphere) {
    const Vec3<float> eye = vec3<float>(13, 2, 3);
    for (const float radius : {1e3F, 1e4F, 1e5F, 1e6F}) {
        RandomInputs random(3);
        const Vec3<float> center = vec3<float>(0, -radius, 0);
        Errors errors;
        for (int i = 0; i < kRays; ++i) {
            Vec3<double> target = random.point<double>(11);
            target[1] = 0;
            const Vec3<float> direction = narrow<float>((target - wide<float>(eye)).normalized());
            const ExactSphere exact(eye, direction, center, radius);
            const float t = sphere_distance<float>(eye, direction, center, radius, false);
            errors.add((t - exact.first) / exact.first);
        }
        EXPECT_LT(errors.quantile(0.99), 1e-5) << radius;
    }
}

TEST(SphereDistance, GivesTheFarSideFromInsideAndNothingBehind) {
    const Vec3<float> center = vec3<float>(1, 2, 3);
    RandomInputs random(4);
    for (int i = 0; i < kRays; ++i) {
        const Vec3<float> direction = random.direction<float>();
        const auto from = [&](const Vec3<double>& offset) {
            const Vec3<float> origin = narrow<float>(wide<float>(center) + offset);
            return std::pair(ExactSphere(origin, direction, center, 2.0F),
                             sphere_distance<float>(origin, direction, center, 2.0F, false));
        };
        const auto [exact, t] = from(random.point<double>(1));
        ASSERT_NEAR(t, static_cast<double>(exact.second), 4e-6);
        ASSERT_EQ(from(2.1 * wide<float>(direction)).second, kInfinity<float>);
    }
    for (const float zero : {0.0F, -0.0F})  // across the centre's plane, where b is zero of either sign
        EXPECT_EQ(
            sphere_distance<float>(vec3<float>(zero, 0, 0), vec3<float>(1, 0, 0), vec3<float>(0, 0, 0), 2.0F, false),
            2);
}

TEST(SphereDistance, LeavesOutASphereThatIsNone) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const bool is_leaving : {false, true})
        EXPECT_EQ(
            sphere_distance<float>(vec3<float>(0, 0, 5), vec3<float>(0, 0, -1), vec3<float>(0, 0, 0), nan, is_leaving),
            kInfinity<float>);
}

/// A surface point that a ray from 10 radii away meets, as the engines compute it.
template <class Scalar>
SurfacePoint<Scalar> seen_point(RandomInputs& random, const Vec3<Scalar>& center, Scalar radius) {
    for (;;) {
        const Ray<Scalar> ray = aimed<Scalar>(random, center, radius, 10.0 * radius, random.uniform(0, 1));
        const Scalar t = sphere_distance<Scalar>(ray.origin, ray.direction, center, radius, false);
        if (!(t < kInfinity<Scalar>)) continue;
        const Scalar row[16] = {center[0], center[1], center[2], radius};
        return surface_point<Features{}, Scalar>(ray, t, row);
    }
}

struct Acne {
    int rehits = 0;
    int naive = 0;  ///< with a least distance of 0.001 instead of the knowledge of where the ray starts
};
Acne diffuse_acne(float radius, double translation) {
    RandomInputs random(5);
    Acne acne;
    for (int i = 0; i < kInputs / 2; ++i) {
        const Vec3<float> center = narrow<float>(translation * random.direction<double>());
        const SurfacePoint<float> point = seen_point<float>(random, center, radius);
        const auto [u, v] = random.unit_square<float>();
        const Vec3<float> direction = diffuse_direction<float>(point.normal, unit_sphere<float>(u, v));
        const auto distance = [&](bool is_leaving) {
            return sphere_distance<float>(point.position, direction, center, radius, is_leaving);
        };
        if (distance(true) < kInfinity<float>) ++acne.rehits;
        const float t = distance(false);
        if (t > 1e-3F && t < kInfinity<float>) ++acne.naive;
    }
    return acne;
}

TEST(SphereLeft, IsNotMetAgainByDiffuseLight) {
    for (const double translation : {0.0, 1e4, 1e6}) {
        const Acne large = diffuse_acne(1000, translation);
        EXPECT_EQ(large.rehits, 0) << translation;
        EXPECT_GT(large.naive, kInputs / 5000) << translation;
    }
    EXPECT_EQ(diffuse_acne(1, 0).rehits, 0);
    EXPECT_EQ(diffuse_acne(1, 1e4).rehits, 0);
    EXPECT_GT(diffuse_acne(1, 1e4).naive, kInputs / 500);
    // Across the diameter float has only 32 positions there.
    EXPECT_LE(diffuse_acne(1, 1e6).rehits, kInputs / 5000);
    EXPECT_GT(diffuse_acne(1, 1e6).naive, kInputs / 10);
}

TEST(SphereLeft, IsMetAgainByLightThatWasRefractedIn) {
    for (const float radius : {1e-4F, 1.0F, 1000.0F}) {
        RandomInputs random(6);
        int lost = 0;
        Errors errors;
        for (int i = 0; i < kRays; ++i) {
            const Vec3<float> center = random.point<float>(2);
            const SurfacePoint<float> point = seen_point<float>(random, center, radius);
            Vec3<float> arriving = random.direction<float>();
            if (dot<float>(arriving, point.normal) > 0) arriving = -arriving;
            const Vec3<float> inward = fresnel_split<float>(arriving, point.normal, 1 / 1.5F).refracted;
            const float t = sphere_distance<float>(point.position, inward, center, radius, true);
            if (!(t < kInfinity<float>))
                ++lost;
            else
                errors.add(t / (-2 * (wide<float>(point.position) - wide<float>(center)).dot(wide<float>(inward))) - 1);
        }
        EXPECT_EQ(lost, 0) << radius;
        EXPECT_LT(errors.max(), 1e-5) << radius;
    }
}

}  // namespace
}  // namespace raypool::test
