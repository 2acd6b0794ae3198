/// Rays against planes and quads.
#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "core/geometry/shapes.h"
#include "core/runtime/engine.h"
#include "tests/errors.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

TEST(PlaneDistance, IsAccurateFromBothSides) {
    RandomInputs random(1);
    Errors errors;
    for (int i = 0; i < kInputs; ++i) {
        const Vec3<float> point = random.point<float>(5);
        const Vec3<float> normal = random.direction<float>();
        const Vec3<float> origin = random.point<float>(5);
        const Vec3<float> direction = random.direction<float>();
        const Vec3<double> n = normal.cast<double>();
        const double approach = direction.cast<double>().dot(n);
        const double height = (point.cast<double>() - origin.cast<double>()).dot(n);
        if (std::abs(approach) < 0.01 || std::abs(height) < 0.01) continue;
        const float t = plane_distance<float>(origin, direction, point, normal, false);
        if (height / approach > 0) {
            errors.add((t - height / approach) / (height / approach));
        } else {
            ASSERT_EQ(t, kInfinity<float>);
        }
    }
    EXPECT_GT(errors.count(), static_cast<std::size_t>(kInputs / 3));
    EXPECT_LT(errors.quantile(0.99), 2e-5);
}

/// Before the exact test, with limits that rounding decides: the hit's own distance and its neighbours.
template <class Scalar>
void expect_no_hit_lost_within_its_limit() {
    RandomInputs random(6);
    const FlushDenormals flush;
    int hits = 0;
    for (int i = 0; i < kInputs; ++i) {
        const auto size = static_cast<Scalar>(std::abs(random.magnitude<double>(-20, 20)));
        Vec3<Scalar> origin = size * random.point<Scalar>(1);
        const Vec3<Scalar> direction = random.direction<Scalar>();
        Vec3<Scalar> normal = random.direction<Scalar>();
        Vec3<Scalar> point = random.one_in(2) ? size * random.point<Scalar>(1) : random.point<Scalar>(1);
        if (random.one_in(4)) {  // heights that the processor hardly keeps
            origin = vec3<Scalar>(0, 0, 0);
            normal = vec3<Scalar>(0, 1, 0);
            point = std::numeric_limits<Scalar>::min() * normal;
        }
        const Scalar t = plane_distance<Scalar>(origin, direction, point, normal, false);
        if (!(t < kInfinity<Scalar>)) continue;
        ++hits;
        for (const Scalar limit : {t, std::nextafter(t, kInfinity<Scalar>), 2 * t, kInfinity<Scalar>}) {
            ASSERT_TRUE(may_meet_plane<Scalar>(origin, direction, point, normal, limit))
                << "case " << i << ": at " << t << " from " << origin.transpose() << " to " << direction.transpose();
        }
    }
    EXPECT_GT(hits, kInputs / 4);
}

TEST(PlaneReach, LosesNoHitInFloat) {
    expect_no_hit_lost_within_its_limit<float>();
}
TEST(PlaneReach, LosesNoHitInDouble) {
    expect_no_hit_lost_within_its_limit<double>();
}

TEST(PlaneReach, KeepsOutPlanesBehindTheRayAndBeyondTheLimit) {
    const Vec3<float> origin = vec3<float>(0, 2, 0);
    const Vec3<float> up = vec3<float>(0, 1, 0);
    const Vec3<float> ground = vec3<float>(0, 0, 0);
    const auto passes = [&](const Vec3<float>& direction, float limit) {
        return may_meet_plane<float>(origin, direction, ground, up, limit);
    };
    EXPECT_TRUE(passes(-up, 2.001F));
    EXPECT_FALSE(passes(-up, 1.999F));
    EXPECT_FALSE(passes(up, kInfinity<float>)) << "behind";
    EXPECT_FALSE(passes(vec3<float>(1, 0, 0), kInfinity<float>)) << "along the plane";
}

TEST(PlaneDistance, IsNoneForRaysThatRunAlongLeaveOrStartOnThePlane) {
    const Vec3<float> point = vec3<float>(0, 0, 0);
    const Vec3<float> up = vec3<float>(0, 1, 0);
    const auto distance = [&](const Vec3<float>& origin, const Vec3<float>& direction, bool is_leaving) {
        return plane_distance<float>(origin, direction, point, up, is_leaving);
    };
    const float none = kInfinity<float>;
    EXPECT_EQ(distance(vec3<float>(1, 2, 3), vec3<float>(1, 0, 0), false), none);  // beside it
    EXPECT_EQ(distance(vec3<float>(1, 2, 3), vec3<float>(1, -0.0F, 0), false), none);
    EXPECT_EQ(distance(vec3<float>(1, 0, 3), vec3<float>(1, 0, 0), false), none);      // within it
    EXPECT_EQ(distance(vec3<float>(1, 2, 3), vec3<float>(0, 1, 0), false), none);      // away from it
    EXPECT_EQ(distance(vec3<float>(1, 0, 3), vec3<float>(0, 1, 0), false), none);      // starts on it
    EXPECT_EQ(distance(vec3<float>(1, 1e-6F, 3), vec3<float>(0, -1, 0), true), none);  // left it
    EXPECT_EQ(distance(vec3<float>(1, 1e-6F, 3), vec3<float>(0, -1, 0), false), 1e-6F);
}

/// A quad in the plane y = 1 with corners (1, 1, 1), (3, 1, 1) and (1, 1, 5).
float distance_to_quad(float x, float z, bool is_leaving = false) {
    return quad_distance<float>(vec3<float>(x, 0, z), vec3<float>(0, 1, 0), vec3<float>(1, 1, 1), vec3<float>(0, -1, 0),
                                vec3<float>(1, 1, 1), vec3<float>(0.5F, 0, 0), vec3<float>(0, 0, 0.25F), is_leaving);
}

TEST(QuadDistance, IncludesEdgesAndCornersAndNothingBeyond) {
    const float beyond = 1e-5F;
    for (const float x : {1.0F, 2.0F, 3.0F})
        for (const float z : {1.0F, 3.5F, 5.0F}) EXPECT_EQ(distance_to_quad(x, z), 1) << x << ' ' << z;
    for (const float z : {1.0F, 3.0F, 5.0F}) {
        EXPECT_EQ(distance_to_quad(1 - beyond, z), kInfinity<float>);
        EXPECT_EQ(distance_to_quad(3 + beyond, z), kInfinity<float>);
    }
    for (const float x : {1.0F, 2.0F, 3.0F}) {
        EXPECT_EQ(distance_to_quad(x, 1 - beyond), kInfinity<float>);
        EXPECT_EQ(distance_to_quad(x, 5 + beyond), kInfinity<float>);
    }
}

TEST(QuadDistance, IsNoneForTheQuadLeft) {
    EXPECT_EQ(distance_to_quad(2, 2, true), kInfinity<float>);
}

TEST(QuadDistance, LetsNoRayOutOfABoxOfSixQuads) {
    RandomInputs random(2);
    int escaped = 0;
    for (int i = 0; i < kInputs; ++i) {
        const Vec3<float> origin = random.point<float>(0.9);
        Vec3<float> target = random.lattice_point<float>(1);  // corners, edges, faces; or anywhere
        if (random.one_in(2)) target = random.direction<float>();
        if (target.isZero()) continue;
        const Vec3<float> direction = (target.cast<double>() - origin.cast<double>()).normalized().cast<float>();
        float t = kInfinity<float>;
        for (int axis = 0; axis < 3; ++axis) {
            for (const float side : {-1.0F, 1.0F}) {
                Vec3<float> corner = vec3<float>(-1, -1, -1);
                Vec3<float> normal = vec3<float>(0, 0, 0);
                Vec3<float> dual_u = normal;
                Vec3<float> dual_v = normal;
                corner[axis] = side;
                normal[axis] = 1;
                dual_u[(axis + 1) % 3] = 0.5F;
                dual_v[(axis + 2) % 3] = 0.5F;
                t = std::min(t, quad_distance<float>(origin, direction, corner, normal, corner, dual_u, dual_v, false));
            }
        }
        if (t == kInfinity<float>) ++escaped;
    }
    EXPECT_EQ(escaped, 0);
}

}  // namespace
}  // namespace raypool::test
