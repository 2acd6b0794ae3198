/// The walk through the trees against asking every shape: the same hit to the last bit, in scenes made to go wrong.
#include "core/geometry/traverse.h"

#include <numeric>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "core/scene/scene_reader.h"
#include "core/shading/compiled_scene.h"
#include "tests/core/geometry/brute_force.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

constexpr int kRays = kInputs / 25;

Scene empty_scene() {
    Scene scene;
    scene.textures.emplace_back().even = {0.5, 0.5, 0.5};
    scene.materials.emplace_back();
    scene.camera.shutter_close = 1;
    return scene;
}
void add_sphere(Scene& scene, const Vector3d& center, double radius, const Vector3d& motion = Vector3d::Zero()) {
    scene.spheres.push_back({center, center + motion, radius, 0});
}

Scene still_spheres() {
    RandomInputs random(1);
    Scene scene = empty_scene();
    for (int i = 0; i < 700; ++i) {
        const Vector3d center = random.point<double>(10);
        add_sphere(scene, center, random.uniform(0.05, 0.6));
    }
    return scene;
}
Scene moving_spheres() {
    Scene scene = still_spheres();
    RandomInputs random(2);
    for (Sphere& sphere : scene.spheres)
        if (!random.one_in(3)) sphere.center1 += random.point<double>(2);
    return scene;
}
/// Every sphere several times over, and many around one centre.
Scene coincident_spheres() {
    Scene scene = still_spheres();
    scene.spheres.resize(100);
    for (int i = 0; i < 300; ++i) scene.spheres.push_back(scene.spheres[static_cast<std::size_t>(i % 100)]);
    for (int i = 0; i < 100; ++i) add_sphere(scene, {3, 3, 3}, 1 + i % 10);
    return scene;
}
Scene sizes_a_million_to_one() {
    RandomInputs random(3);
    Scene scene = empty_scene();
    for (int i = 0; i < 500; ++i) {
        const double radius = std::exp(random.uniform(std::log(1e-4), std::log(1e2)));
        add_sphere(scene, random.point<double>(200), radius);
    }
    return scene;
}
/// Each at twice the distance of the one before: trees of any heuristic become lists.
Scene exponentially_spaced_spheres() {
    Scene scene = empty_scene();
    for (int exponent = -60; exponent < 60; ++exponent) {
        for (int axis = 0; axis < 3; ++axis) {
            Vector3d center = Vector3d::Zero();
            center[axis] = std::ldexp(1.0, exponent);
            add_sphere(scene, center, std::ldexp(0.2, exponent));
        }
    }
    return scene;
}
Scene far_from_the_origin() {
    Scene scene = moving_spheres();
    for (Sphere& sphere : scene.spheres) {
        sphere.center0 += Vector3d(1e4, -2e4, 3e4);
        sphere.center1 += Vector3d(1e4, -2e4, 3e4);
    }
    return scene;
}
Scene all_shapes() {
    Scene scene = moving_spheres();
    RandomInputs random(4);
    for (int i = 0; i < 300; ++i) {
        const Vector3d corner = i % 2 == 0 ? random.point<double>(10) : random.lattice_point<double>(5);
        const Vector3d u = i % 2 == 0 ? random.direction<double>() : Vector3d(2, 0, 0);
        scene.quads.push_back({corner, u, i % 2 == 0 ? Vector3d(1.5 * u.unitOrthogonal()) : Vector3d(0, 1, 0), 0});
    }
    for (int i = 0; i < 20; ++i) {
        const Vector3d point = 8 * random.direction<double>();
        scene.planes.push_back({point, point, 0});
    }
    return scene;
}

struct TestScene {
    const char* name;
    Scene (*make)();
};
constexpr TestScene kScenes[] = {{"still_spheres", still_spheres},
                                 {"moving_spheres", moving_spheres},
                                 {"coincident_spheres", coincident_spheres},
                                 {"sizes_a_million_to_one", sizes_a_million_to_one},
                                 {"exponentially_spaced", exponentially_spaced_spheres},
                                 {"far_from_the_origin", far_from_the_origin},
                                 {"all_shapes", all_shapes},
                                 {"paper", [] { return builtin_scene("paper"); }},
                                 {"glass_stack", [] { return builtin_scene("glass_stack"); }},
                                 {"cornell", [] { return builtin_scene("cornell"); }}};

/// Rays between shapes, towards their rims and middles, along axes, and from the hits of rays before.
template <class Scalar>
class RayMaker {
  public:
    RayMaker(const Scene& scene, std::uint64_t seed) : scene_(scene), random_(seed) {}

    Ray<Scalar> next() {
        const Vector3d target = somewhere();
        Ray<Scalar> ray;
        ray.time = random_.unit_interval<Scalar>();
        ray.origin = somewhere().template cast<Scalar>();
        const Vector3d way = target - ray.origin.template cast<double>();
        ray.direction =
            way.norm() > 0 ? Vec3<Scalar>(way.normalized().template cast<Scalar>()) : random_.direction<Scalar>();
        if (random_.one_in(8)) {
            ray.direction = random_.lattice_point<Scalar>(0);
            const int axis = random_.below(3);
            ray.direction[axis] = random_.one_in(2) ? 1 : -1;
        }
        return ray;
    }
    Ray<Scalar> from(const Ray<Scalar>& before, Scalar t) {
        return {along<Scalar>(before.origin, t, before.direction), random_.direction<Scalar>(), before.time};
    }

  private:
    /// On or about a sphere, or, where there is none, a quad.
    Vector3d somewhere() {
        if (scene_.spheres.empty()) return scene_.quads[0].corner + 0.5 * random_.point<double>(500);
        const auto& sphere =
            scene_.spheres[static_cast<std::size_t>(random_.below(static_cast<int>(scene_.spheres.size())))];
        const double reach = random_.one_in(2) ? 1.0 : random_.uniform(0, 3);
        return sphere.center0 + random_.uniform(0, 1) * (sphere.center1 - sphere.center0) +
               reach * sphere.radius * random_.direction<double>();
    }
    const Scene& scene_;
    RandomInputs random_;
};

class Traversal : public testing::TestWithParam<TestScene> {
  protected:
    template <class Scalar>
    static void expect_brute_force_hits() {
        const Scene scene = GetParam().make();
        const CompiledScene<Scalar> compiled = compile<Scalar>(scene);
        RayMaker<Scalar> rays(scene, 5);
        int hits = 0;
        Ray<Scalar> ray = rays.next();
        std::int32_t leaving_id = kNoPrimitive;
        for (int i = 0; i < kRays; ++i) {
            NoTestCount work;
            const Hit<Scalar> hit = closest_hit<kEverything>(compiled, ray, leaving_id, work);
            const Hit<Scalar> expected = brute_force_hit(compiled, ray, leaving_id);
            ASSERT_EQ(hit.primitive_id, expected.primitive_id)
                << i << ": " << ray.origin.transpose() << " + t " << ray.direction.transpose() << " at " << ray.time;
            ASSERT_EQ(hit.t, expected.t);
            const bool is_hit = hit.primitive_id != kNoPrimitive;
            hits += is_hit ? 1 : 0;
            ray = is_hit && i % 4 != 0 ? rays.from(ray, hit.t) : rays.next();
            leaving_id = kNoPrimitive;
            if (is_hit && i % 4 != 0) {
                const auto* surface = compiled.surfaces[static_cast<std::size_t>(hit.primitive_id)].value;
                leaving_id = static_cast<std::int32_t>(
                    PlanarMark<Scalar>::group(surface[SurfaceRow<Scalar>::kRadius], hit.primitive_id));
            }
        }
        EXPECT_GT(hits, kRays / 10);
    }
};

TEST_P(Traversal, FindsWhatAskingEveryShapeFindsInFloat) {
    expect_brute_force_hits<float>();
}
TEST_P(Traversal, FindsWhatAskingEveryShapeFindsInDouble) {
    expect_brute_force_hits<double>();
}

/// The tree of the same scene with its spheres in another order has another shape.
TEST_P(Traversal, DoesNotDependOnTheOrderOfTheSpheres) {
    const Scene scene = GetParam().make();
    const std::size_t count = scene.spheres.size();
    Scene shuffled = scene;
    std::vector<std::int32_t> old_id(scene.spheres.size() + scene.quads.size() + scene.planes.size());
    std::iota(old_id.begin(), old_id.end(), 0);
    RandomInputs random(6);
    for (std::size_t i = count - 1; i > 0 && count > 0; --i) {
        const auto j = static_cast<std::size_t>(random.below(static_cast<int>(i + 1)));
        std::swap(old_id[i], old_id[j]);
        std::swap(shuffled.spheres[i], shuffled.spheres[j]);
    }
    const CompiledScene<float> a = compile<float>(scene);
    const CompiledScene<float> b = compile<float>(shuffled);
    RayMaker<float> rays(scene, 7);
    for (int i = 0; i < kRays; ++i) {
        const Ray<float> ray = rays.next();
        NoTestCount work;
        const Hit<float> in_a = closest_hit<kEverything>(a, ray, kNoPrimitive, work);
        const Hit<float> in_b = closest_hit<kEverything>(b, ray, kNoPrimitive, work);
        ASSERT_EQ(in_a.t, in_b.t);
        if (in_a.primitive_id == kNoPrimitive || in_a.primitive_id == old_id[in_b.primitive_id]) continue;
        // Two shapes at one distance, such as twins: the smaller of the ids of that scene.
        ASSERT_LT(in_a.primitive_id, old_id[in_b.primitive_id]);
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Traversal, testing::ValuesIn(kScenes),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(Ties, GoToTheSmallerIdWhereverTheTwinsAreKept) {
    Scene scene = empty_scene();
    for (int i = 0; i < 40; ++i) add_sphere(scene, {3.0 * i, 0, 0}, 1);
    for (int i = 0; i < 40; ++i) add_sphere(scene, {3.0 * (39 - i), 0, 0}, 1);  // the twin of i is 79 - i
    const CompiledScene<float> compiled = compile<float>(scene);
    for (int i = 0; i < 40; ++i) {
        const Ray<float> ray{vec3<float>(3.0F * static_cast<float>(i), 0, 9), vec3<float>(0, 0, -1), 0};
        NoTestCount work;
        const Hit<float> hit = closest_hit<kEverything>(compiled, ray, kNoPrimitive, work);
        EXPECT_EQ(hit.primitive_id, i);
        EXPECT_EQ(hit.t, 8);
        const Hit<float> far_side = closest_hit<kEverything>(compiled, ray, i, work);
        EXPECT_EQ(far_side.primitive_id, i) << "the twin is not met";
    }
}

/// A sphere touches a quad and a plane from above in one point: equal distances, three kinds of shapes.
TEST(Ties, BetweenKindsOfShapesGoToTheSmallerId) {
    Scene scene = empty_scene();
    add_sphere(scene, {0, -1, 0}, 1);
    scene.quads.push_back({{-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, 0});
    scene.planes.push_back({{0, 0, 0}, {0, 1, 0}, 0});
    const Ray<float> ray{vec3<float>(0, 4, 0), vec3<float>(0, -1, 0), 0};
    const auto hit_of = [&](const Scene& s) {
        NoTestCount work;
        return closest_hit<kEverything>(compile<float>(s), ray, kNoPrimitive, work);
    };
    EXPECT_EQ(hit_of(scene).t, 4);
    EXPECT_EQ(hit_of(scene).primitive_id, 0);
    scene.spheres.clear();
    EXPECT_EQ(hit_of(scene).t, 4);
    EXPECT_EQ(hit_of(scene).primitive_id, 0) << "of the quad, now";
}

TEST(EmptyScene, IsNeverHit) {
    NoTestCount work;
    const Ray<float> ray{vec3<float>(0, 0, 0), vec3<float>(0, 0, 1), 0};
    EXPECT_EQ(closest_hit<kEverything>(compile<float>(empty_scene()), ray, kNoPrimitive, work).primitive_id,
              kNoPrimitive);
    EXPECT_EQ(closest_hit<kEverything>(compile<double>(empty_scene()),
                                       Ray<double>{vec3<double>(0, 0, 0), vec3<double>(0, 0, 1), 0}, kNoPrimitive, work)
                  .primitive_id,
              kNoPrimitive);
}

}  // namespace
}  // namespace raypool::test
