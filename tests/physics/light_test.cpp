// Irradiance in closed form: a spot of a diffuse plane, lit by one emitter above it, has the radiance
// albedo * E / pi, E being the irradiance of the emitter's shape.

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "tests/physics/agreement.h"
#include "tests/physics/test_scene.h"

namespace raypool {
namespace {

constexpr double kAlbedo = 0.8;
constexpr double kRadiance = 3;

/// A diffuse plane at y = 0 below a black sky; the camera sees no more than a spot at the origin.
TestScene lit_spot(const Vector3d& look_from) {
    TestScene scene(256, 256, Vector3d::Zero());
    scene.plane({0, 0, 0}, {0, 1, 0}, scene.diffuse(kAlbedo));
    scene.look(look_from, {0, 0, 0}, 0.01);
    return scene;
}

template <class Scalar>
void expect_spot(const Scene& scene, double form_factor) {
    const Rendered rendered = render<Scalar>(scene, 4, 50);
    EXPECT_EQ(rendered.report.segments(), 2 * rendered.report.paths()) << "one hit on the plane, and one segment more";
    EXPECT_TRUE(mean_agrees(pixel_values(rendered), kAlbedo * kRadiance * form_factor)) << form_factor;
}

template <class Scalar>
void expect_black(const Scene& scene) {
    for (const double value : pixel_values(render<Scalar>(scene, 1, 50))) ASSERT_EQ(value, 0);
}

template <class Scalar>
class Irradiance : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(Irradiance, Precisions);

/// Of a sphere that is wholly above the horizon: (r / d)^2 cos, as if it were a point.
TYPED_TEST(Irradiance, OfASphereFallsWithTheSquareOfItsDistanceAndTheCosine) {
    for (const Vector3d& center : {Vector3d(0, 2, 0), Vector3d(2, 2, 1), Vector3d(-3, 1.6, 0)}) {
        TestScene scene = lit_spot({0.5, 1, 8});
        constexpr double kRadius = 1.5;
        scene.sphere(center, kRadius, scene.emitter(kRadiance));
        const double distance = center.norm();
        expect_spot<TypeParam>(scene, std::pow(kRadius / distance, 2) * center.y() / distance);
    }
}

/// Of any polygon above the horizon (Lambert, Photometria, 1760): half the sum, over its edges seen from the spot, of
/// the angle that the edge spans times the height of the unit normal of the edge's plane with the spot, over pi.
double polygon_form_factor(const std::vector<Vector3d>& corners) {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vector3d a = corners[i].normalized();
        const Vector3d b = corners[(i + 1) % corners.size()].normalized();
        sum += std::acos(a.dot(b)) * a.cross(b).normalized().y();
    }
    return std::abs(sum) / (2 * std::numbers::pi);
}

TYPED_TEST(Irradiance, OfAQuadIsLambertsFormula) {
    struct Case {
        Vector3d corner, edge_u, edge_v;
    };
    const std::vector<Case> cases{
        {{-1, 1, -0.5}, {2, 0, 0}, {0, 0, 2}},       // overhead, parallel to the plane
        {{1, 0.01, -2}, {0, 3, 0}, {0, 0, 4}},       // a wall that nearly stands on the plane
        {{-2, 0.5, -1}, {1, 1, 0.5}, {-0.5, 1, 2}},  // askew, a parallelogram
    };
    for (const Case& test : cases) {
        TestScene scene = lit_spot({0.2, 0.8, 8});
        scene.quad(test.corner, test.edge_u, test.edge_v, scene.emitter(kRadiance));
        const Vector3d& c = test.corner;
        expect_spot<TypeParam>(
            scene, polygon_form_factor({c, c + test.edge_u, c + test.edge_u + test.edge_v, c + test.edge_v}));
    }
}

/// A lamp of one side, whose texture is half as bright as it shines.
TYPED_TEST(Irradiance, OfALampOfOneSideComesFromItsFront) {
    const Vector3d corner(-1, 1, -0.5);
    const Vector3d edges[] = {{2, 0, 0}, {0, 0, 2}};  // in this order the front looks down
    for (const bool looks_down : {true, false}) {
        TestScene scene = lit_spot({0.2, 0.8, 8});
        const std::int32_t lamp = scene.emitter(kRadiance / 2);
        scene.materials.back().strength = 2;
        scene.materials.back().front_only = true;
        scene.quad(corner, edges[looks_down ? 0 : 1], edges[looks_down ? 1 : 0], lamp);
        if (looks_down) {
            expect_spot<TypeParam>(scene, polygon_form_factor({corner, corner + edges[0], corner + edges[0] + edges[1],
                                                               corner + edges[1]}));
        } else {
            expect_black<TypeParam>(scene);
        }
    }
}

TYPED_TEST(Irradiance, OfASphereThatShinesOutwardIsNoneWithinIt) {
    TestScene scene = lit_spot({0.5, 1, 8});
    const std::int32_t lamp = scene.emitter(kRadiance);
    scene.materials.back().front_only = true;
    scene.sphere({0, 0, 0}, 20, lamp);
    expect_black<TypeParam>(scene);
}

}  // namespace
}  // namespace raypool
