/// Lights: which is chosen, and that directions are sampled at the density that is said of them.
#include "core/shading/lights.h"

#include <numeric>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "core/geometry/traverse.h"
#include "core/scene/emission.h"
#include "tests/core/math/lane_agreement.h"
#include "tests/meshes.h"
#include "tests/physics/agreement.h"
#include "tests/physics/test_scene.h"

namespace raypool::test {
namespace {

TEST(LightTable, SaysWithWhichProbabilityEachLightIsChosenWhichIsItsShareOfThePower) {
    RandomInputs random(1);
    TestScene scene(1, 1, Vector3d::Zero());
    const std::int32_t grey = scene.diffuse(0.5);
    const std::int32_t dark = scene.emitter(0);
    for (int i = 0; i < 60; ++i) {
        const std::int32_t lamp = random.one_in(4)   ? grey
                                  : random.one_in(6) ? dark
                                                     : scene.emitter(std::exp(random.uniform(-9, 9)));
        scene.materials.back().front_only = random.one_in(2);
        if (random.one_in(2)) {
            scene.sphere(random.point<double>(10), random.uniform(0.01, 2), lamp);
        } else {
            scene.quad(random.point<double>(10), random.point<double>(1), random.point<double>(1), lamp);
        }
    }
    scene.plane({0, -20, 0}, {0, 1, 0}, scene.emitter(3));
    scene.mesh(triangle_soup(10, random), grey);
    scene.mesh(triangle_soup(30, random), scene.emitter(0.02));
    const EmittedPower emitted(scene);
    std::vector<double> power;
    for (const Sphere& sphere : scene.spheres) power.push_back(emitted.of(sphere));
    for (const Quad& quad : scene.quads) power.push_back(emitted.of(quad));
    power.push_back(0);  // of the plane
    std::vector<double> areas(power.size(), 1.0);
    for (std::size_t i = 0; i < scene.quads.size(); ++i)
        areas[scene.spheres.size() + i] = scene.quads[i].edge_u.cross(scene.quads[i].edge_v).norm();
    const std::vector<bool> is_hidden(power.size());
    for (const MeshShape& mesh : scene.meshes) {
        for (const auto& triangle : mesh.mesh->triangles) {
            std::array<Vector3d, 3> at;
            for (std::size_t i = 0; i < 3; ++i) at[i] = mesh.placed(mesh.mesh->positions[triangle[i]]);
            areas.push_back((at[1] - at[0]).cross(at[2] - at[0]).norm() / 2);
            power.push_back(emitted.of(mesh, areas.back()));
        }
    }
    const double sum = std::accumulate(power.begin(), power.end(), 0.0);

    using Row = LightRow<float>;
    const LightTable<float> table = light_table<float>(scene, is_hidden);
    const auto primitive = [&](std::size_t i) {
        return static_cast<std::size_t>(bits_of<float>(table.rows[i].value[Row::kPrimitive]));
    };
    // What sample_light() makes of each random number.
    constexpr double kSteps = 1 << 24;
    const auto count = static_cast<float>(table.rows.size());
    std::vector<double> drawn(table.rows.size());
    for (int step = 0; step < 1 << 24; ++step)
        drawn[static_cast<std::size_t>(std::min(std::floor(static_cast<float>(step) * 0x1p-24F * count), count - 1))]++;
    std::vector<double> chosen(power.size());
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const double kept = std::ceil(table.rows[i].value[Row::kThreshold] * kSteps) / kSteps;
        const auto alias = static_cast<std::size_t>(bits_of<float>(table.rows[i].value[Row::kAlias]));
        chosen[primitive(i)] += drawn[i] / kSteps * kept;
        chosen[primitive(alias)] += drawn[i] / kSteps * (1 - kept);
    }
    ASSERT_EQ(table.weights.size(), power.size());
    for (std::size_t id = 0; id < power.size(); ++id) {
        EXPECT_NEAR(chosen[id], power[id] / sum, 1e-5) << id;
        EXPECT_NEAR(table.weights[id] * areas[id], chosen[id], 1e-7 * chosen[id]) << id;
    }
}

TEST(LightTable, IsEmptyWhereNothingShines) {
    TestScene scene(1, 1, Vector3d::Ones());
    scene.sphere({0, 0, 0}, 1, scene.diffuse(0.5));
    scene.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, scene.emitter(0));
    scene.plane({0, 0, 0}, {0, 1, 0}, scene.emitter(1));
    EXPECT_FALSE(compile<float>(scene).features.lights);
    EXPECT_TRUE(compile<float>(scene).lights.empty());
}

/// Of two lamps that are one surface the first listed is there.
TEST(LightTable, HasNothingThatIsHidden) {
    TestScene scene(1, 1, Vector3d::Zero());
    const std::int32_t lamp = scene.emitter(1);
    for (int i = 0; i < 2; ++i) scene.sphere({0, 0, 0}, 1, lamp);
    for (int i = 0; i < 2; ++i) scene.quad({3, 0, 0}, {1, 0, 0}, {0, 1, 0}, lamp);
    const CompiledScene<float> compiled = compile<float>(scene);
    ASSERT_EQ(compiled.lights.size(), 2U);
    EXPECT_GT(compiled.light_weights[0], 0);
    EXPECT_EQ(compiled.light_weights[1], 0);
    EXPECT_GT(compiled.light_weights[2], 0);
    EXPECT_EQ(compiled.light_weights[3], 0);
}

/// Of a triangle, seen from the origin (Van Oosterom and Strackee, 1983).
double solid_angle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const Vector3d x = a.normalized(), y = b.normalized(), z = c.normalized();
    return 2 * std::abs(std::atan2(x.dot(y.cross(z)), 1 + x.dot(y) + y.dot(z) + z.dot(x)));
}

/// The mean of 1 / density over what is sampled is the angle that the light fills.
template <class Scalar>
void expect_solid_angle(const TestScene& scene, const Vector3d& from, double expected) {
    const CompiledScene<Scalar> compiled = compile<Scalar>(scene);
    const RayStart<Scalar> start{from.cast<Scalar>(), kNoPrimitive};
    std::vector<double> angles;
    for (std::uint32_t i = 0; i < 20000; ++i) {
        const std::array<Scalar, 4> random = random_block<Scalar>({1, i}, 0, RandomPurpose::Light, random_seed(0));
        LightSurface<Scalar> surface;
        const LightSample<Scalar> sample = sample_light<kEverything, Scalar>(compiled, start, 0, random, surface);
        ASSERT_EQ(sample.primitive_id, 0);
        ASSERT_NEAR(sample.direction.norm(), 1, 1e-6);
        ASSERT_LT(sample.t, kInfinity<Scalar>);
        const Ray<Scalar> ray{start.origin, sample.direction, 0};
        angles.push_back(1 / static_cast<double>(light_density<kEverything, Scalar>(
                                 ray, sample.t, compiled.light_weights[0], surface.row)));
        // The light is where it is said to be.
        NoTestCount work;
        const Hit<Scalar> hit = closest_hit<kEverything>(compiled, ray, kNoPrimitive, work);
        if (hit.primitive_id == 0) {
            ASSERT_EQ(hit.t, sample.t);
        }
    }
    if (scene.spheres.empty()) {
        EXPECT_TRUE(mean_agrees(angles, expected)) << from.transpose();
    } else {  // the same in every direction
        for (const double angle : angles) ASSERT_NEAR(angle / expected, 1, 1e-6) << from.transpose();
    }
}

template <class Scalar>
class LightDirections : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(LightDirections, Precisions);

TYPED_TEST(LightDirections, FillTheAngleOfAQuad) {
    const Vector3d corner(-1, 2, -0.5), u(2, 0.2, 0), v(0.5, 0.1, 3);
    TestScene scene(1, 1, Vector3d::Zero());
    scene.quad(corner, u, v, scene.emitter(1));
    for (const Vector3d& from : {Vector3d(0, 0, 0), Vector3d(3, 1, -2), Vector3d(0.3, 1.5, 0.4)}) {
        const Vector3d a = corner - from;
        expect_solid_angle<TypeParam>(scene, from, solid_angle(a, a + u, a + u + v) + solid_angle(a, a + u + v, a + v));
    }
}

TYPED_TEST(LightDirections, FillTheAngleOfATriangle) {
    const Vector3d a(-1, 2, -0.5), b(1, 2.25, -0.5), c(-0.5, 2.125, 2.5);
    Mesh mesh;
    mesh.positions = {{-1, 2, -0.5}, {1, 2.25, -0.5}, {-0.5, 2.125, 2.5}};
    mesh.triangles = {{0, 1, 2}};
    TestScene scene(1, 1, Vector3d::Zero());
    scene.mesh(std::move(mesh), scene.emitter(1));
    for (const Vector3d& from : {Vector3d(0, 0, 0), Vector3d(3, 1, -2), Vector3d(-0.3, 1.75, 0.4)})
        expect_solid_angle<TypeParam>(scene, from, solid_angle(a - from, b - from, c - from));
}

TYPED_TEST(LightDirections, FillTheAngleOfASphere) {
    constexpr double kPi = std::numbers::pi;
    TestScene scene(1, 1, Vector3d::Zero());
    scene.sphere({1, 2, 3}, 0.5, scene.emitter(1));
    const auto from_distance = [&](double distance, double expected) {
        expect_solid_angle<TypeParam>(scene, Vector3d(1, 2, 3) + distance * Vector3d(0.48, -0.6, 0.64), expected);
    };
    for (const double distance : {0.51, 0.6, 2.0, 100.0}) {
        const double sine = 0.5 / distance;
        from_distance(distance, 2 * kPi * sine * sine / (1 + std::sqrt(1 - sine * sine)));
    }
    from_distance(0.2, 4 * kPi);
}

/// A light that rounding makes too small to be met: it is still sampled, at the density that its size gives.
TEST(LightDirections, LeadToWhatIsTooFarToBeMet) {
    TestScene scene(1, 1, Vector3d::Zero());
    scene.sphere({3e5, 8e5, -5e5}, 1e-6, scene.emitter(1));
    const double sine = 1e-6 / Vector3d(3e5, 8e5, -5e5).norm();
    expect_solid_angle<float>(scene, {0, 0, 0}, std::numbers::pi * sine * sine);
}

TEST(LightDirections, AreNoneWithinThePlaneOfTheLight) {
    TestScene scene(1, 1, Vector3d::Zero());
    scene.quad({1, 0, 0}, {1, 0, 0}, {0, 0, 1}, scene.emitter(1));
    const CompiledScene<float> compiled = compile<float>(scene);
    LightSurface<float> surface;
    const RayStart<float> start{vec3<float>(0, 0, 0.5F), 0};  // leaves a shape in the same plane
    for (std::uint32_t i = 0; i < 100; ++i) {
        const auto random = random_block<float>({1, i}, 0, RandomPurpose::Light, random_seed(0));
        EXPECT_EQ((sample_light<kEverything, float>(compiled, start, 0, random, surface).t), kInfinity<float>);
    }
}

/// Quads, triangles, spheres and moving spheres, from anywhere: inside, beside and far.
template <class Scalar, class... Reals>
void expect_lanes_agree_on_lights() {
    RandomInputs inputs(3);
    TestScene scene(1, 1, Vector3d::Zero());
    scene.camera.shutter_close = 1;
    for (int i = 0; i < 40; ++i) {
        const std::int32_t lamp = scene.emitter(inputs.uniform(0.1, 9));
        if (i % 2 == 0) {
            scene.sphere(inputs.point<double>(3), inputs.uniform(0.01, 2), lamp);
            if (i % 4 == 0) scene.spheres.back().center1 += inputs.point<double>(1);
        } else {
            scene.quad(inputs.point<double>(3), inputs.point<double>(1), inputs.point<double>(1), lamp);
        }
    }
    scene.mesh(triangle_soup(40, inputs), scene.emitter(1));
    const CompiledScene<Scalar> compiled = compile<Scalar>(scene);
    expect_lanes_agree_for<Scalar, Reals...>(
        kInputs / 8,
        [&](RandomInputs& random, Row<Scalar>& row) {
            row.vec(random.point<Scalar>(4)), row.real(random.unit_interval<Scalar>());
            row.word(static_cast<std::uint32_t>(random.below(1 << 20)));
            row.word(static_cast<std::uint32_t>(random.below(40)));
        },
        [&]<class Real>(Arguments<Real>& in, Results<Real>& out) {
            RayStart<Real> start;
            start.origin = in.vec();
            const Real time = in.real();
            const Uint32<Real> sample = in.word();
            start.leaving_id = in.index();
            const std::array<Real, 4> random =
                random_block<Real>({Uint32<Real>(0U), sample}, Uint32<Real>(0U), RandomPurpose::Light, random_seed(0));
            LightSurface<Real> surface;
            const LightSample<Real> light = sample_light<kEverything, Real>(compiled, start, time, random, surface);
            const Ray<Real> ray{start.origin, light.direction, time};
            const Mask<Real> is_seen = light.t < Real(kInfinity<Real>);
            out(light.direction), out(light.t);
            out(select(is_seen, light_density<kEverything, Real>(ray, light.t, Real(1), surface.row), Real(0)));
            out(select<Real>(is_seen, emitted_radiance<kEverything, Real>(compiled, ray, light, surface, is_seen),
                             ray.origin));
        });
}
TEST(LightAgreement, HoldsInFloat) {
    expect_lanes_agree_on_lights<float, stdx::native_simd<float>, Wide<float, kTreeWidth<float>>>();
}
TEST(LightAgreement, HoldsInDouble) {
    expect_lanes_agree_on_lights<double, stdx::native_simd<double>>();
}

}  // namespace
}  // namespace raypool::test
