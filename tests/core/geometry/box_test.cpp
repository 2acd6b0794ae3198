/// Rays against boxes: in whole numbers exactly, at corners and edges without a leak, and never out of order.
#include <gtest/gtest.h>

#include "core/geometry/shapes.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

struct TestBox {
    Vec3<float> low, high;
};

template <class Scalar>
Interval<Scalar> interval(const TestBox& box, const Vec3<Scalar>& origin, const RayInverse<Scalar>& inverse) {
    Vec3<Scalar> near;
    Vec3<Scalar> far;
    for (int i = 0; i < 3; ++i) {
        near[i] = inverse.is_negative[i] ? box.high[i] : box.low[i];
        far[i] = inverse.is_negative[i] ? box.low[i] : box.high[i];
    }
    return box_interval<Scalar>(near, far, origin, inverse, kInfinity<Scalar>);
}
bool is_met(const TestBox& box, const Vec3<float>& origin, const RayInverse<float>& inverse) {
    const Interval<float> inside = interval<float>(box, origin, inverse);
    return inside.enter <= inside.exit;
}

/// Whether the ray meets the closed box, for whole numbers and directions of -1, 0 and 1.
bool is_met_exactly(const TestBox& box, const Vec3<float>& origin, const Vec3<float>& direction) {
    float enter = 0;
    float exit = 1000;
    for (int i = 0; i < 3; ++i) {
        if (direction[i] == 0) {
            if (origin[i] < box.low[i] || origin[i] > box.high[i]) return false;
            continue;
        }
        const float a = (box.low[i] - origin[i]) * direction[i];
        const float b = (box.high[i] - origin[i]) * direction[i];
        enter = std::max(enter, std::min(a, b));
        exit = std::min(exit, std::max(a, b));
    }
    return enter <= exit;
}

/// Boxes of whole coordinates, flat and even single points, and rays that often run in a face or along an edge.
TestBox lattice_box(RandomInputs& random) {
    const Vec3<float> a = random.lattice_point<float>(1);
    const Vec3<float> b = random.lattice_point<float>(1);
    return {a.cwiseMin(b), a.cwiseMax(b)};
}

TEST(BoxTest, IsExactOnALattice) {
    RandomInputs random(1);
    int met = 0;
    for (int i = 0; i < kInputs; ++i) {
        const TestBox box = lattice_box(random);
        const Vec3<float> origin = random.lattice_point<float>(2);
        const Vec3<float> direction = random.lattice_point<float>(1);
        if (direction.isZero()) continue;
        const bool expected = is_met_exactly(box, origin, direction);
        met += expected ? 1 : 0;
        ASSERT_EQ(is_met(box, origin, ray_inverse<float>(direction)), expected)
            << box.low.transpose() << " to " << box.high.transpose() << ", " << origin.transpose() << " towards "
            << direction.transpose();
    }
    EXPECT_GT(met, kInputs / 10);
}

/// A denormal component takes a ray nowhere within reach, so what is met with a zero there must be met.
TEST(BoxTest, MissesNothingWithDenormalDirections) {
    RandomInputs random(2);
    for (int i = 0; i < kInputs; ++i) {
        const TestBox box = lattice_box(random);
        const Vec3<float> origin = random.lattice_point<float>(2);
        const Vec3<float> direction = random.lattice_point<float>(1);
        if (direction.isZero()) continue;
        Vec3<float> bent = direction;
        for (int k = 0; k < 3; ++k)
            if (direction[k] == 0) bent[k] = std::copysign(static_cast<float>(random.below(3)) * 1e-45F, direction[k]);
        if (!is_met_exactly(box, origin, direction)) continue;
        ASSERT_TRUE(is_met(box, origin, ray_inverse<float>(bent))) << bent.transpose();
    }
}

TEST(BoxTest, DoesNotLeakAtCornersAndEdges) {
    RandomInputs random(3);
    int lost = 0;
    int lost_without_slack = 0;
    for (int i = 0; i < kInputs; ++i) {
        TestBox box;
        box.low = random.point<float>(10);
        box.high = (box.low.array() + 0.1F).matrix() + random.point<float>(1).cwiseAbs();
        Vec3<double> target;
        const int free_axis = random.below(4);  // 3: none, a corner
        for (int k = 0; k < 3; ++k) {
            const bool is_high = random.one_in(2);
            target[k] = is_high ? box.high[k] : box.low[k];
            if (k == free_axis) target[k] = random.uniform(box.low[k], box.high[k]);
        }
        const Vec3<float> origin = random.point<float>(20);
        const Vec3<float> direction = (target - origin.cast<double>()).normalized().cast<float>();
        RayInverse<float> inverse = ray_inverse<float>(direction);
        if (!is_met(box, origin, inverse)) ++lost;
        inverse.near_scale = inverse.far_scale = direction.cwiseInverse();
        if (!is_met(box, origin, inverse)) ++lost_without_slack;
    }
    EXPECT_EQ(lost, 0);
    EXPECT_GT(lost_without_slack, kInputs / 100);
}

TEST(BoxTest, EntersABoxNoLaterThanABoxWithinIt) {
    RandomInputs random(4);
    for (int i = 0; i < kInputs; ++i) {
        const bool is_lattice = random.one_in(2);
        const auto point = [&] { return is_lattice ? random.lattice_point<float>(2) : random.point<float>(4); };
        const Vec3<float> a = point();
        const Vec3<float> b = point();
        const TestBox inner{a.cwiseMin(b), a.cwiseMax(b)};
        TestBox outer = inner;
        for (int k = 0; k < 3; ++k) {
            if (random.one_in(2)) outer.low[k] -= std::abs(point()[k]);
            if (random.one_in(2)) outer.high[k] = std::nextafter(outer.high[k], kInfinity<float>);
        }
        const Vec3<float> origin = point();
        const Vec3<float> direction = is_lattice ? random.lattice_point<float>(1) : random.direction<float>();
        const RayInverse<float> inverse = ray_inverse<float>(direction);
        const Interval<float> in_inner = interval<float>(inner, origin, inverse);
        const Interval<float> in_outer = interval<float>(outer, origin, inverse);
        ASSERT_LE(in_outer.enter, in_inner.enter);
        ASSERT_GE(in_outer.exit, in_inner.exit);
    }
}

TEST(BoxTest, HoldsAPointBetweenEntryAndTheEndOfTheRayOnly) {
    const Vec3<float> low = vec3<float>(1, -1, -1);
    const Vec3<float> high = vec3<float>(2, 1, 1);
    const Vec3<float> origin = vec3<float>(0, 0, 0);
    const RayInverse<float> inverse = ray_inverse<float>(vec3<float>(1, 0, -0.0F));
    EXPECT_FALSE(is_inside_box<float>(low, high, origin, inverse, 0.5F));
    EXPECT_TRUE(is_inside_box<float>(low, high, origin, inverse, 1.5F));
    const RayInverse<float> away = ray_inverse<float>(vec3<float>(-1, 0, 0));
    EXPECT_FALSE(is_inside_box<float>(low, high, origin, away, 1.5F));
}

TEST(BoxTest, NeverMeetsAnEmptyBox) {
    const float inf = kInfinity<float>;
    const TestBox empty{vec3<float>(inf, inf, inf), vec3<float>(-inf, -inf, -inf)};
    RandomInputs random(5);
    for (int i = 0; i < kInputs / 10; ++i) {
        const Vec3<float> origin = random.lattice_point<float>(2);
        const Vec3<float> direction = random.one_in(2) ? random.lattice_point<float>(1) : random.direction<float>();
        ASSERT_FALSE(is_met(empty, origin, ray_inverse<float>(direction)));
    }
}

}  // namespace
}  // namespace raypool::test
