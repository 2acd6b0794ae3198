/// Shapes that are one surface count once, the first listed, and what is further apart than rounding stays two: what is
/// found in the description of a scene.
#include "core/geometry/coincidence.h"

#include <gtest/gtest.h>

#include "core/scene/scene_hash.h"
#include "core/scene/scene_parser.h"
#include "tests/core/geometry/coincident_scenes.h"

namespace raypool::test {
namespace {

template <class Scalar>
class Coincident : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Coincident, Scalars, );

TEST(CoincidentShapes, ThatMoveApartStayTwo) {
    TestScene scene = under_a_sky();
    const std::int32_t grey = scene.diffuse(0.8);
    scene.spheres.push_back({{0, 0, 0}, {0, 0, 0}, 0.5, grey});
    scene.spheres.push_back({{0, 0, 0}, {1, 0, 0}, 0.5, grey});
    EXPECT_FALSE(find_coincidence<float>(scene).is_hidden[1]);
    scene.camera.shutter_close = 0;
    EXPECT_TRUE(find_coincidence<float>(scene).is_hidden[1]) << "nothing has moved yet";
}

TYPED_TEST(Coincident, FacesOfASmallBoxStayTheirOwnHoweverLargeTheScene) {
    TestScene scene = under_a_sky();
    const std::int32_t grey = scene.diffuse(0.8);
    constexpr double kEdge = 0.02;
    const Vector3d low(-0.01, 0, -0.01);
    for (int axis = 0; axis < 3; ++axis) {
        const Vector3d u = kEdge * Vector3d::Unit((axis + 1) % 3);
        const Vector3d v = kEdge * Vector3d::Unit((axis + 2) % 3);
        scene.quad(low, u, v, grey);
        scene.quad(low + kEdge * Vector3d::Unit(axis), u, v, grey);
    }
    scene.spheres.push_back({{0, 1.5e11, 0}, {0, 1.5e11, 0}, 6.9e8, scene.emitter(5)});
    const Coincidence found = find_coincidence<TypeParam>(scene);
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t k = 0; k < i; ++k)
            EXPECT_NE(found.planars[i].group, found.planars[k].group) << i << " and " << k;
}

TYPED_TEST(Coincident, PlanesAreOneWhicheverPointTheyAreGivenBy) {
    RandomInputs random(5);
    for (int i = 0; i < 200; ++i) {
        const Vector3d normal =
            Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1)).normalized();
        const Vector3d along = normal.unitOrthogonal();
        const Plane far{Vector3d(normal + 1e6 * along), normal, 0};
        const Plane near{normal, normal, 0};
        for (const bool far_first : {true, false}) {
            Scene scene = under_a_sky();
            scene.planes = far_first ? std::vector{far, near} : std::vector{near, far};
            EXPECT_TRUE(find_coincidence<TypeParam>(scene).is_hidden[1])
                << i << (far_first ? " far first" : " near first");
        }
    }
}

TYPED_TEST(Coincident, WhatIsFurtherApartThanRoundingStaysTwo) {
    constexpr bool kIsFloat = sizeof(TypeParam) == 4;
    const double gap = kIsFloat ? 1e-6 : 1e-13;
    TestScene alone = under_a_sky();
    const std::int32_t grey = alone.diffuse(0.8);
    alone.quad({-9, 1 + gap, -9}, {0, 0, 18}, {18, 0, 0}, grey);
    TestScene both = alone;
    both.plane({0, 1, 0}, {0, 1, 0}, grey);
    const Coincidence found = find_coincidence<TypeParam>(both);
    EXPECT_NE(found.planars[0].group, found.planars[1].group);
    EXPECT_FALSE(found.is_hidden[1]);
    both.look({0.3, 3, 2}, {0, 1, 0}, 20);
    EXPECT_NEAR(render<TypeParam>(both, 64, 50).mean(0), 0.8 * 5 / 6, 6e-3) << "the lower one stays hidden";

    TestScene spheres = under_a_sky();
    spheres.sphere({0, 0, 0}, 1, spheres.diffuse(0.8));
    spheres.sphere({0, 0, 0}, 1 + 10 * gap, 0);
    EXPECT_FALSE(find_coincidence<TypeParam>(spheres).is_hidden[1]);

    TestScene at_zero = under_a_sky();
    at_zero.plane({0, 0, 0}, {0, 1, 0}, at_zero.diffuse(0.8));
    at_zero.quad({-1, 0.1 * gap, -1}, {2, 0, 0}, {0, 0, 2}, 0);
    EXPECT_FALSE(find_coincidence<TypeParam>(at_zero).is_hidden[0]);
}

/// Quads of one plane, but not of one place, keep the planes that they were given.
TEST(CoincidentShapes, AreNotMovedByMoreThanTheirOwnRounding) {
    RandomInputs random(4);
    for (int i = 0; i < 200; ++i) {
        const Frame f = random_frame(random, 1);
        TestScene scene(8, 8, Vector3d::Ones());
        scene.diffuse(0.8);
        scene.quad(f.at + 1e6 * f.u, 1e5 * f.u, 1e5 * f.v, 0);  // far away and large
        scene.quad(f.at - 900 * f.u - 900 * f.v, 1800 * f.u, 1800 * f.v, 0);
        scene.quad(f.at - 0.1 * f.u - 0.1 * f.v, 0.2 * f.u, 0.2 * f.v, 0);
        const Coincidence found = find_coincidence<float>(scene);
        EXPECT_NE(found.planars[0].group, found.planars[1].group);
        EXPECT_EQ(found.planars[1].group, found.planars[2].group);
        const Coincidence::Planar& planar = found.planars[2];
        const Vec3<double> point = planar.point.cast<float>().cast<double>();
        const Vec3<double> normal = planar.normal.cast<float>().cast<double>();
        EXPECT_LT(std::abs(normal.dot(scene.quads[2].corner - point)), 1e-6);
    }
}

TYPED_TEST(Coincident, QuadsAreHiddenByAnEarlierOneThatCoversThem) {
    RandomInputs random(31);
    for (int round = 0; round < 200; ++round) {
        const Frame f = random_frame(random, round % 2 == 0 ? 1 : 1e3);
        const Quad ceiling = quad_of(f.at - f.u - f.v, 2 * f.u, 2 * f.v);
        const Quad lamp = quad_of(f.at - 0.3 * f.u + 0.2 * f.v, 0.4 * f.v, -0.5 * f.u);
        const Quad beyond = quad_of(f.at, 2 * f.u, 0.5 * f.v);
        Scene scene;
        scene.quads = {beyond, ceiling, lamp, quad_of(f.at + f.u + f.v, -2 * f.v, -2 * f.u), beyond};
        EXPECT_EQ(find_coincidence<TypeParam>(scene).is_hidden, (std::vector<bool>{false, false, true, true, true}));
        scene.quads = {lamp, ceiling};
        EXPECT_EQ(find_coincidence<TypeParam>(scene).is_hidden, std::vector<bool>(2)) << "the smaller one is first";
        const Quad across = quad_of(f.at - 0.2 * f.u - 0.2 * f.v, 0.4 * f.u, 0.4 * f.v);
        scene.quads = {quad_of(f.at - f.u - f.v, f.u, 2 * f.v), quad_of(f.at - f.v, f.u, 2 * f.v), across};
        EXPECT_EQ(find_coincidence<TypeParam>(scene).is_hidden, std::vector<bool>(3))
            << "no single one covers the lamp";
    }
}

TEST(CoincidentShapes, KeepTheirOwnOutwardSides) {
    TestScene scene(8, 8, Vector3d::Ones());
    scene.diffuse(0.8);
    scene.quad({0, 0, 0}, {1, 0.5, 0}, {0, 0.25, 1}, 0);
    scene.quad({0, 0, 0}, {0, 0.25, 1}, {1, 0.5, 0}, 0);
    const Coincidence found = find_coincidence<float>(scene);
    EXPECT_EQ(found.planars[0].group, found.planars[1].group);
    EXPECT_EQ(found.planars[0].normal, -found.planars[1].normal);
}

TEST(CoincidentShapes, CountInTheOrderOfTheFile) {
    const auto scene_of = [](const std::string& shapes) {
        return parse_scene(
            R"({"description": "A quad in a plane.", "camera": {"look_from": [0, 2, 0], "look_at": [0, 0, 0],
            "up": [1, 0, 0]}, "background": [1, 1, 1], "materials": {"a": {"type": "diffuse", "albedo": [1, 1, 1]}},
            "shapes": [)" +
                shapes + "]}",
            "test.json", "");
    };
    const std::string quad =
        R"({"type": "quad", "corner": [-1, 0, -1], "edge_u": [2, 0, 0], "edge_v": [0, 0, 2], "material": "a"})";
    const std::string plane = R"({"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "a"})";
    const Scene quad_first = scene_of(quad + "," + plane);
    const Scene plane_first = scene_of(plane + "," + quad);
    EXPECT_FALSE(find_coincidence<float>(quad_first).is_hidden[0]);
    EXPECT_TRUE(find_coincidence<float>(plane_first).is_hidden[0]);
    EXPECT_NE(scene_hash(quad_first), scene_hash(plane_first));
}

}  // namespace
}  // namespace raypool::test
