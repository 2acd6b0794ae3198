/// Shapes that are one surface count once, the first listed: none is met twice, none lets light through. What rays and
/// images show.
#include <algorithm>
#include <functional>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "core/geometry/coincidence.h"
#include "core/geometry/traverse.h"
#include "core/shading/shade.h"
#include "tests/core/geometry/coincident_scenes.h"
#include "wavefront/engine.h"

namespace raypool::test {
namespace {

template <class Scalar>
class CoincidentRays : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(CoincidentRays, Scalars, );

/// Flat shapes that all cover the place `frame.at`, and the id that counts there.
struct PlanarPair {
    const char* name;
    std::function<std::int32_t(Scene&, const Frame&)> make;
};
const PlanarPair kPlanarPairs[] = {
    {"quad before plane",
     [](Scene& scene, const Frame& f) {
         scene.quads.push_back(quad_of(f.at - f.u - f.v, 2 * f.u, 2 * f.v));
         scene.planes.push_back({f.at + 3 * f.u - 7 * f.v, f.n, 0});
         return 0;
     }},
    {"plane before quad",
     [](Scene& scene, const Frame& f) {
         scene.planes.push_back({f.at + 3 * f.u - 7 * f.v, f.n, 0, 0});
         scene.quads.push_back(quad_of(f.at - f.u - f.v, 2 * f.u, 2 * f.v));
         return 1;  // quads have the smaller ids
     }},
    {"planes of opposite normals",
     [](Scene& scene, const Frame& f) {
         scene.planes.push_back({f.at + 3 * f.u - 7 * f.v, f.n, 0});
         scene.planes.push_back({f.at - 2 * f.u + 4 * f.v, -3 * f.n, 0});
         return 0;
     }},
    {"quads of another corner and other edges",
     [](Scene& scene, const Frame& f) {
         scene.quads.push_back(quad_of(f.at - f.u - f.v, 2 * f.u, 2 * f.v));
         scene.quads.push_back(quad_of(f.at + f.u + f.v, -2 * f.v, -2 * f.u));
         return 0;
     }},
    {"quads that overlap, turned within the plane and wound the other way",
     [](Scene& scene, const Frame& f) {
         scene.quads.push_back(quad_of(f.at - 0.3 * f.u - 0.4 * f.v, 2 * f.u, 2 * f.v));
         scene.quads.push_back(quad_of(f.at - 0.7 * f.u, 0.9 * f.u - 0.8 * f.v, 0.7 * f.u + 1.1 * f.v));
         return 0;
     }},
    {"a small quad, then the large one that it lies on, in two parts",
     [](Scene& scene, const Frame& f) {
         scene.quads.push_back(quad_of(f.at - 0.1 * f.u - 0.1 * f.v, 0.2 * f.u, 0.2 * f.v));
         scene.quads.push_back(quad_of(f.at - 30 * f.u - 30 * f.v, 30 * f.u, 60 * f.v));
         scene.quads.push_back(quad_of(f.at - 30 * f.v, 30 * f.u, 60 * f.v));
         return 0;
     }},
};

/// Rays at the place from either side: the first listed is met, and what leaves it, to any side, meets nothing more.
template <class Scalar>
void expect_one_surface(const CompiledScene<Scalar>& scene, const Frame& frame, std::int32_t first, const char* name,
                        RandomInputs& random) {
    for (int i = 0; i < 8; ++i) {
        const Vector3d target =
            frame.at + random.uniform(-0.03, 0.03) * frame.u + random.uniform(-0.03, 0.03) * frame.v;
        const Vector3d from = target + std::exp(random.uniform(-3, 6)) * random.direction<double>();
        if (std::abs((from - target).normalized().dot(frame.n)) < 0.1) continue;
        Ray<Scalar> ray{from.cast<Scalar>(), vec3<Scalar>(0, 0, 0), 0};
        ray.direction = (target - ray.origin.template cast<double>()).normalized().template cast<Scalar>();
        NoTestCount work;
        const Hit<Scalar> hit = closest_hit<kEverything>(scene, ray, kNoPrimitive, work);
        ASSERT_EQ(hit.primitive_id, first) << name;
        const Scattered<Scalar> out =
            scatter<kEverything, Scalar>(scene, ray, hit.t, hit.primitive_id, vec3<Scalar>(1, 1, 1),
                                         {static_cast<std::uint32_t>(i), 0}, 0, random_seed(0));
        for (const Vec3<Scalar>& way : {out.direction, ray.direction}) {
            const Hit<Scalar> next = closest_hit<kEverything>(scene, {out.start.origin, way, 0},
                                                              static_cast<std::int32_t>(out.start.leaving_id), work);
            ASSERT_EQ(next.primitive_id, kNoPrimitive) << name << ", again at " << next.t;
        }
    }
}

TYPED_TEST(CoincidentRays, FlatShapesAreMetOnceInAnyPosition) {
    RandomInputs random(1);
    for (const double reach : {0.0, 1.0, 1e3, 1e5}) {
        for (int i = 0; i < 400; ++i) {
            const Frame frame = random_frame(random, reach);
            for (const PlanarPair& pair : kPlanarPairs) {
                TestScene scene(8, 8, Vector3d::Ones());
                scene.diffuse(0.8);
                const std::int32_t first = pair.make(scene, frame);
                expect_one_surface(compile<TypeParam>(scene), frame, first, pair.name, random);
                if (this->HasFatalFailure()) FAIL() << "reach " << reach << ", position " << i;
            }
        }
    }
}

TYPED_TEST(CoincidentRays, ShapesLeftToTheirIdsAloneAreMetTwice) {
    RandomInputs random(1);
    int twice = 0;
    for (int i = 0; i < 200; ++i) {
        const Frame frame = random_frame(random, 1);
        TestScene scene(8, 8, Vector3d::Ones());
        scene.diffuse(0.8);
        kPlanarPairs[0].make(scene, frame);
        const CompiledScene<TypeParam> compiled = compile<TypeParam>(scene, no_coincidence(scene));
        const Ray<TypeParam> ray{(frame.at + 2 * frame.n + frame.u).template cast<TypeParam>(),
                                 (-frame.n).template cast<TypeParam>(), 0};
        NoTestCount work;
        const Hit<TypeParam> hit = closest_hit<kEverything>(compiled, ray, kNoPrimitive, work);
        const Scattered<TypeParam> out = scatter<kEverything, TypeParam>(
            compiled, ray, hit.t, hit.primitive_id, vec3<TypeParam>(1, 1, 1), {7, 0}, 0, random_seed(0));
        const Hit<TypeParam> next = closest_hit<kEverything>(compiled, {out.start.origin, out.direction, 0},
                                                             static_cast<std::int32_t>(out.start.leaving_id), work);
        twice += next.primitive_id != kNoPrimitive ? 1 : 0;
    }
    EXPECT_GT(twice, 20) << "otherwise the tests beside this one see nothing";
}

/// Under a sky of (1 + y) / 2 a surface that looks up gathers 5 / 6 of its albedo.
TYPED_TEST(CoincidentRays, PlaneAndQuadHaveTheRadianceOfOne) {
    for (const bool has_quad : {false, true}) {
        TestScene scene = under_a_sky();
        const std::int32_t grey = scene.diffuse(0.8);
        scene.plane({0, 0, 0}, {0, 1, 0}, grey);
        if (has_quad) scene.quad({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, grey);
        const Rendered rendered = render<TypeParam>(scene, 256, 50);
        EXPECT_NEAR(rendered.mean(0), 0.8 * 5 / 6, 3e-3);
        EXPECT_EQ(rendered.report.segments(), 2 * rendered.report.paths());
    }
}

/// Renders are compared bit by bit: what is hidden changes nothing.
void expect_same_as_first(const std::function<void(TestScene&)>& first, const std::function<void(TestScene&)>& second,
                          const char* name) {
    TestScene alone = under_a_sky();
    first(alone);
    TestScene both = alone;
    second(both);
    EXPECT_EQ(render<float>(both, 16, 50).hash(), render<float>(alone, 16, 50).hash()) << name;
    EXPECT_EQ(render<double>(both, 16, 50).hash(), render<double>(alone, 16, 50).hash()) << name;
}

TEST(CoincidentImages, MakeTheImageOfTheFirst) {
    const auto sphere = [](std::int32_t (*material)(TestScene&)) {
        return [material](TestScene& scene) { scene.sphere({0.1, 0.2, 0.3}, 0.7, material(scene)); };
    };
    const auto grey = [](TestScene& scene) { return scene.diffuse(0.8); };
    const auto glass = [](TestScene& scene) { return scene.glass(1.5); };
    const auto mirror = [](TestScene& scene) { return scene.mirror(0.9); };
    const auto lamp = [](TestScene& scene) { return scene.emitter(3); };
    expect_same_as_first(sphere(grey), sphere(grey), "diffuse twice");
    expect_same_as_first(sphere(glass), sphere(glass), "glass twice");
    expect_same_as_first(sphere(glass), sphere(grey), "glass, then diffuse");
    expect_same_as_first(sphere(grey), sphere(glass), "diffuse, then glass");
    expect_same_as_first(sphere(mirror), sphere(mirror), "a mirror twice");
    expect_same_as_first(sphere(lamp), sphere(lamp), "a lamp twice");
    expect_same_as_first(
        sphere(glass),
        [](TestScene& scene) {
            Sphere other = scene.spheres[0];
            other.radius *= 1 + 1e-16;
            other.center1 = other.center0 + Vector3d(0, 1e-17, 0);
            scene.spheres.push_back(other);
        },
        "glass, and one that moves by nothing");
    const auto moving = [](TestScene& scene) {
        scene.spheres.push_back({{0, 0, 0}, {0.4, 0.3, 0}, 0.7, scene.diffuse(0.6)});
    };
    expect_same_as_first(moving, moving, "moving twice");
    const auto floor = [](TestScene& scene) { scene.plane({0, -0.3, 0}, {0, 1, 0}, scene.diffuse(0.6)); };
    expect_same_as_first(
        floor,
        [](TestScene& scene) {
            scene.plane({4, -0.3, 9}, {0, -2, 0}, scene.mirror(1));
        },
        "planes");
    expect_same_as_first(
        [&](TestScene& scene) {
            floor(scene);
            scene.planes[0].quads_before = 0;
            scene.quad({-0.5, 0.7, -0.5}, {0, 0, 1}, {1, 0, 0}, scene.diffuse(0.7));  // a box on the floor ...
            scene.quad({-0.5, -0.3, -0.5}, {1, 0, 0}, {0, 1, 0}, scene.diffuse(0.7));
        },
        [](TestScene& scene) {  // ... and its bottom
            scene.quad({-0.5, -0.3, -0.5}, {1, 0, 0}, {0, 0, 1}, scene.diffuse(0.7));
        },
        "a box on the floor");
}

/// A slab of glass whose faces are all listed twice, in other words, bends light as a slab does.
TYPED_TEST(CoincidentRays, GlassFacesRefractOnce) {
    const Frame frame{{0.1, 0.2, 0.3}, {0.36, 0.48, 0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, -0.6}};
    const auto slab = [&](bool is_doubled) {
        TestScene scene(24, 16, Vector3d::Ones());
        const std::int32_t glass = scene.glass(1.5);
        for (const double side : {-0.1, 0.1}) {
            const Vector3d at = frame.at + side * frame.n;
            const Vector3d u = side * 80 * frame.u;
            scene.quad(at - u - 8 * frame.v, 2 * u, 16 * frame.v, glass);
            if (is_doubled) scene.quad(at - u + 8 * frame.v, 2 * u, -16 * frame.v, glass);
        }
        scene.look(frame.at + 2 * frame.n + 0.4 * frame.u, frame.at, 30);
        return render<TypeParam>(scene, 16, 50);
    };
    const std::int64_t once = slab(false).report.segments();
    EXPECT_NEAR(static_cast<double>(slab(true).report.segments()), static_cast<double>(once), 2);
}

/// A closed room in a bright sky is black within, whatever its walls are listed as.
TYPED_TEST(CoincidentRays, WallsOfARoomLetNoLightIn) {
    RandomInputs random(3);
    for (int turn = 0; turn < 40; ++turn) {
        const Frame f = random_frame(random, turn % 4 == 0 ? 100 : 1);
        TestScene scene(8, 8, Vector3d::Constant(1e3));
        const std::int32_t grey = scene.diffuse(0.9);
        const Vector3d axis[3] = {f.u, f.v, f.n};
        for (int i = 0; i < 3; ++i) {
            const Vector3d& u = axis[(i + 1) % 3];
            const Vector3d& v = axis[(i + 2) % 3];
            for (const double side : {-1.0, 1.0}) {
                const Vector3d corner = f.at + side * axis[i] - u - v;
                scene.quad(corner, 2 * u, 2 * v, grey);
                if (turn % 3 == 0) scene.quad(corner + 2 * u, 2 * v, -2 * u, grey);
                if (turn % 3 == 1) scene.quad(corner, u, 2 * v, grey), scene.quad(corner + u, u, 2 * v, grey);
                if (turn % 3 == 2 && i == 0) scene.plane(corner, -axis[i], grey);
            }
        }
        scene.look(f.at + 0.3 * f.u, f.at - 0.2 * f.n + 0.1 * f.v, 90);
        const std::vector<double> values = pixel_values(render<TypeParam>(scene, 16, 60));
        EXPECT_EQ(*std::max_element(values.begin(), values.end()), 0) << turn;
    }
}

/// Every kind of pair in one scene.
TEST(CoincidentImages, MakeOneImageInEveryEngine) {
    RandomInputs random(5);
    TestScene scene = under_a_sky();
    scene.diffuse(0.8);
    scene.glass(1.5);
    for (int i = 0; i < 12; ++i) {
        const Frame frame = random_frame(random, 0.8);
        Scene pair;
        kPlanarPairs[i % 6].make(pair, frame);
        for (Quad& quad : pair.quads) quad.material_id = random.below(2), quad.edge_u *= 0.3, quad.edge_v *= 0.3;
        for (Plane& plane : pair.planes) plane.point -= 4 * plane.normal;
        scene.quads.insert(scene.quads.end(), pair.quads.begin(), pair.quads.end());
        scene.planes.insert(scene.planes.end(), pair.planes.begin(), pair.planes.end());
        scene.sphere(frame.at, 0.2, i % 2);
        scene.sphere(frame.at, 0.2, 1 - i % 2);
    }
    const CompiledScene<float> compiled = compile<float>(scene);
    RenderSettings settings;
    settings.end_sample = 16;
    const std::string hash = render(recursive::RecursiveEngine(), compiled, settings).hash();
    for (const auto intersection : {wavefront::Intersection::Stream, wavefront::Intersection::Single}) {
        wavefront::PoolSettings pool;
        pool.intersection = intersection;
        EXPECT_EQ(render(wavefront::WavefrontEngine(pool), compiled, settings).hash(), hash);
    }
}

}  // namespace
}  // namespace raypool::test
