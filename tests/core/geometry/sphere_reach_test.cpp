/// may_meet_sphere(), the cheap test before the exact one: it loses no hit, and lets few misses through.
#include <gtest/gtest.h>

#include "core/geometry/shape_bounds.h"
#include "core/geometry/shapes.h"
#include "core/runtime/engine.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

/// A ray, a sphere that may move, and whether the ray starts on it; aimed so that rounding decides.
template <class Scalar>
struct HardCase {
    Sphere sphere;
    Vec3<Scalar> origin, direction;
    Scalar time;
    bool is_leaving;
};

template <class Scalar>
Vector3d center_of(const HardCase<Scalar>& hard) {
    return hard.sphere.center0 + double{hard.time} * (hard.sphere.center1 - hard.sphere.center0);
}

/// Small and large, near and far from the origin and from the ray, grazing and central, from outside, inside and off
/// the surface.
template <class Scalar>
HardCase<Scalar> hard_case(RandomInputs& random) {
    HardCase<Scalar> hard;
    constexpr double kEpsilon = std::numeric_limits<Scalar>::epsilon();
    hard.sphere.radius = static_cast<Scalar>(std::abs(random.magnitude<double>(-20, 14)));
    const double reach = random.one_in(4) ? 0 : std::abs(random.magnitude<double>(-10, 20));
    hard.sphere.center0 = random.point<Scalar>(reach).template cast<double>();
    hard.sphere.center1 = hard.sphere.center0;
    if (random.one_in(2))
        hard.sphere.center1 += std::abs(random.magnitude<double>(-10, 6)) * random.direction<double>();
    hard.time = random.unit_interval<Scalar>();
    const Vector3d center = center_of(hard);
    const double radius = hard.sphere.radius;
    hard.is_leaving = random.one_in(3);
    const Vector3d out = random.direction<double>();
    const double from = hard.is_leaving    ? radius * (1 + kEpsilon * random.uniform(-4, 4))
                        : random.one_in(4) ? radius * random.uniform(0, 1)
                        : random.one_in(4) ? radius * (1 + kEpsilon * random.uniform(-8, 8))
                                           : radius + std::abs(random.magnitude<double>(-20, 24));
    const Vector3d origin = center + from * out;
    // Through a point at right angles to the way to the centre: nearly tangent, or at any distance from the centre.
    Vector3d aside = random.direction<double>();
    aside = (aside - aside.dot(out) * out).normalized();
    const double off = random.one_in(2)   ? radius * (1 + kEpsilon * random.magnitude<double>(-2, 6))
                       : random.one_in(2) ? radius * random.uniform(0, 2)
                                          : radius * std::abs(random.magnitude<double>(-24, 0));
    const double sine = std::min(1.0, off / from);
    const Vector3d toward = random.one_in(8) ? out : Vector3d(-out);
    hard.origin = origin.cast<Scalar>();
    hard.direction = unit<Scalar>(Vector3d(std::sqrt(1 - sine * sine) * toward + sine * aside).template cast<Scalar>());
    return hard;
}

template <class Scalar>
class SphereReachOf : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(SphereReachOf, Scalars, );

TYPED_TEST(SphereReachOf, LosesNoHit) {
    using S = TypeParam;
    RandomInputs random(41);
    const FlushDenormals flush;
    int hits = 0;
    int hits_of_leaving = 0;
    for (int i = 0; i < 4 * kInputs; ++i) {
        const HardCase<S> hard = hard_case<S>(random);
        const Vec3<S> center0 = hard.sphere.center0.template cast<S>();
        const Vec3<S> motion = (hard.sphere.center1 - hard.sphere.center0).template cast<S>();
        const S radius = static_cast<S>(hard.sphere.radius);
        const S t = sphere_distance<S>(hard.origin, hard.direction, center_at<S>(center0, motion, hard.time), radius,
                                       hard.is_leaving);
        if (!(t < kInfinity<S>)) continue;
        ++hits;
        hits_of_leaving += hard.is_leaving ? 1 : 0;
        const Vec3<S> toward = toward_sphere<S>(center0, motion, hard.time, hard.origin);
        ASSERT_TRUE(may_meet_sphere<S>(toward, hard.direction, sphere_reach<S>(radius, padded_radius<S>(hard.sphere)),
                                       hard.is_leaving))
            << "case " << i << ": radius " << radius << " at " << center0.transpose() << ", from "
            << hard.origin.transpose() << " to " << hard.direction.transpose() << ", leaving " << hard.is_leaving;
    }
    EXPECT_GT(hits, kInputs);
    EXPECT_GT(hits_of_leaving, kInputs / 4);
}

TYPED_TEST(SphereReachOf, KeepsOutRaysThatPassAtATenthOfTheRadiusAndThoseThatLeaveOutward) {
    using S = TypeParam;
    RandomInputs random(42);
    for (int i = 0; i < kInputs / 10; ++i) {
        Sphere sphere;
        sphere.radius = random.uniform(0.3, 1);
        sphere.center0 = sphere.center1 = random.point<double>(10);
        const Vector3d out = random.direction<double>();
        Vector3d aside = random.direction<double>();
        aside = (aside - aside.dot(out) * out).normalized();
        const auto passes = [&](const Vector3d& origin, const Vector3d& direction, bool is_leaving) {
            const Vec3<S> still = Vec3<S>::Zero();
            return may_meet_sphere<S>(
                toward_sphere<S>(sphere.center0.cast<S>(), still, 0, origin.cast<S>()), direction.cast<S>(),
                sphere_reach<S>(static_cast<S>(sphere.radius), padded_radius<S>(sphere)), is_leaving);
        };
        const Vector3d past = sphere.center0 + 1.1 * sphere.radius * out;
        EXPECT_FALSE(passes(past - 20 * aside, aside, false));
        EXPECT_FALSE(passes(past, out, false)) << "behind the origin";
        const Vector3d on = sphere.center0 + sphere.radius * out;
        EXPECT_FALSE(passes(on, (out + 0.1 * aside).normalized(), true));
        EXPECT_TRUE(passes(on, (aside - 0.1 * out).normalized(), true));
    }
}

}  // namespace
}  // namespace raypool::test
