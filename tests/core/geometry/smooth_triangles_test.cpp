/// The normal that light sees at a point of a smooth triangle, and where rays start there.
#include "core/geometry/smooth_triangles.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/geometry/triangles.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

using Vec = Vec3<double>;

/// Of a sphere around the origin, with its normals: edges of about half its radius.
struct SphereTriangle {
    std::array<Vec, 3> vertex, normal;
    Vec outward;

    SphereTriangle(RandomInputs& random, double radius) {
        const Vec middle = random.direction<double>();
        do {
            for (int i = 0; i < 3; ++i) normal[i] = (middle + 0.5 * random.direction<double>()).normalized();
            outward = triangle_normal<double>(normal);
        } while (std::abs(outward.dot(middle)) < 0.7);
        if (outward.dot(middle) < 0) {
            std::swap(normal[1], normal[2]);
            outward = -outward;
        }
        for (int i = 0; i < 3; ++i) vertex[i] = radius * normal[i];
    }
    [[nodiscard]] Vec at(const std::array<double, 3>& weight) const {
        return weight[0] * vertex[0] + weight[1] * vertex[1] + weight[2] * vertex[2];
    }
    [[nodiscard]] SmoothPoint<double> seen(const std::array<double, 3>& weight, const Vec& direction) const {
        return smooth_point<double>(vertex, normal, weight, at(weight), triangle_error<double>(vertex), outward,
                                    direction);
    }
};

std::array<double, 3> random_weights(RandomInputs& random) {
    const double u = random.uniform(0, 1);
    const double v = random.uniform(0, 1);
    const double root = std::sqrt(u);
    return {1 - root, root * (1 - v), root * v};
}

TEST(SmoothPoint, HasTheNormalBetweenThoseOfItsVerticesOnTheSideOfTheRay) {
    RandomInputs random(61);
    for (int i = 0; i < 1000; ++i) {
        const SphereTriangle triangle(random, 3);
        const std::array<double, 3> weight = random_weights(random);
        const Vec between = triangle.at(weight).normalized();  // of a sphere the points are as the normals
        EXPECT_NEAR((triangle.seen(weight, -between).normal - between).norm(), 0, 1e-14);
        EXPECT_NEAR((triangle.seen(weight, between).normal + between).norm(), 0, 1e-14);
        EXPECT_NEAR((triangle.seen({0, 1, 0}, -triangle.outward).normal - triangle.normal[1]).norm(), 0, 1e-14);
    }
}

TEST(SmoothPoint, IsTheSameWhereNormalsPointToTheOtherSide) {
    RandomInputs random(62);
    for (int i = 0; i < 1000; ++i) {
        SphereTriangle triangle(random, 1);
        const std::array<double, 3> weight = random_weights(random);
        const Vec direction = random.direction<double>();
        const SmoothPoint<double> expected = triangle.seen(weight, direction);
        for (Vec& normal : triangle.normal) normal = -normal;
        const SmoothPoint<double> got = triangle.seen(weight, direction);
        EXPECT_EQ(got.normal, expected.normal);
        EXPECT_EQ(got.lift, expected.lift);
    }
}

TEST(SmoothPoint, HasANormalThatFacesTheRayAndLiesOnItsSide) {
    RandomInputs random(63);
    int turned = 0;
    for (int i = 0; i < 10'000; ++i) {
        const SphereTriangle triangle(random, 1);
        const std::array<double, 3> weight = random_weights(random);
        const Vec direction = random.direction<double>();
        const Vec side = triangle.outward.dot(direction) < 0 ? triangle.outward : Vec(-triangle.outward);
        const Vec normal = triangle.seen(weight, direction).normal;
        EXPECT_NEAR(normal.norm(), 1, 1e-14);
        EXPECT_GT(normal.dot(side), 0);
        EXPECT_LT(normal.dot(direction), -0.0099);
        turned += std::abs(std::abs(normal.dot(triangle.at(weight).normalized())) - 1) > 1e-9 ? 1 : 0;
    }
    EXPECT_GT(turned, 100);
    EXPECT_LT(turned, 2000);
}

TEST(SmoothPoint, HasTheTrianglesNormalWhereThoseOfVerticesCancel) {
    const std::array<Vec, 3> vertex{Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 1, 0)};
    const std::array<Vec, 3> normal{Vec(1, 0, 0), Vec(-1, 0, 0), Vec(0, 1, 0)};
    const SmoothPoint<double> point =
        smooth_point<double>(vertex, normal, {0.5, 0.5, 0}, {0.5, 0, 0}, {0, 0, 0}, {0, 0, 1}, {0, 0, -1});
    EXPECT_EQ(point.normal, Vec(0, 0, 1));
}

/// On the outer side of a sphere starts lie between the triangle and the cone of its tangent planes; on the inner side
/// they are not moved.
TEST(SmoothPoint, IsLiftedTowardTheSphereFromOutsideAlone) {
    RandomInputs random(64);
    for (int i = 0; i < 1000; ++i) {
        const SphereTriangle triangle(random, 1);
        const std::array<double, 3> weight = random_weights(random);
        const SmoothPoint<double> outside = triangle.seen(weight, -triangle.outward);
        EXPECT_TRUE(outside.is_lifted);
        EXPECT_GT(outside.lift.dot(triangle.outward), 0);
        const double height = (triangle.at(weight) + outside.lift).norm();
        EXPECT_GT(height, triangle.at(weight).norm());
        EXPECT_LT(height, 1 + (1 - triangle.at(weight).norm()) * 1.5);
        const SmoothPoint<double> inside = triangle.seen(weight, triangle.outward);
        EXPECT_FALSE(inside.is_lifted);
        EXPECT_EQ(inside.lift, Vec(0, 0, 0));
        EXPECT_LT(triangle.seen({0, 0, 1}, -triangle.outward).lift.norm(), 1e-15);
    }
}

/// Whatever the normals: starts lie on the side of the ray, and near.
TEST(SmoothPoint, IsNeverLiftedThroughItsTriangleNorFartherThanItsLongestEdge) {
    RandomInputs random(65);
    int lifted = 0;
    for (int i = 0; i < 10'000; ++i) {
        SphereTriangle triangle(random, 1);
        for (Vec& normal : triangle.normal) normal = random.direction<double>();
        double longest = 0;
        for (int k = 0; k < 3; ++k)
            longest = std::max(longest, (triangle.vertex[(k + 1) % 3] - triangle.vertex[k]).norm());
        const Vec direction = random.direction<double>();
        const SmoothPoint<double> point = triangle.seen(random_weights(random), direction);
        const double height = (triangle.outward.dot(direction) < 0 ? 1 : -1) * point.lift.dot(triangle.outward);
        EXPECT_EQ(height > 0, point.is_lifted);
        EXPECT_GE(height, 0);
        EXPECT_LE(point.lift.norm(), longest);
        lifted += point.is_lifted ? 1 : 0;
    }
    EXPECT_GT(lifted, 3000);
}

/// Triangles that share an edge and its normals agree along it.
TEST(SmoothPoint, IsTheSameFromBothSidesOfAnEdge) {
    RandomInputs random(66);
    for (int i = 0; i < 1000; ++i) {
        const SphereTriangle one(random, 1);
        SphereTriangle other = one;
        other.vertex[2] = other.normal[2] = (one.normal[0] + one.normal[1] - 0.8 * one.normal[2]).normalized();
        std::swap(other.vertex[0], other.vertex[1]);
        std::swap(other.normal[0], other.normal[1]);
        other.outward = triangle_normal<double>(other.vertex);
        const Vec direction = -one.at({0.4, 0.6, 0}).normalized();
        if (other.outward.dot(direction) > -0.1) continue;
        const SmoothPoint<double> a = one.seen({0.4, 0.6, 0}, direction);
        const SmoothPoint<double> b = other.seen({0.6, 0.4, 0}, direction);
        EXPECT_NEAR((a.normal - b.normal).norm(), 0, 1e-14);
        EXPECT_NEAR((a.lift - b.lift).norm(), 0, 1e-14);
    }
}

}  // namespace
}  // namespace raypool::test
