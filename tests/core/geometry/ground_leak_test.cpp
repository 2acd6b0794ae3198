/// Small spheres on the ground: light from beneath them must not pass, on a plane as on a sphere of radius 1000.
#include <gtest/gtest.h>

#include "core/geometry/traverse.h"
#include "core/shading/shade.h"
#include "tests/core/geometry/exact_sphere.h"
#include "tests/physics/test_scene.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

constexpr int kRays = kInputs / 25;

/// Light from the ground beneath a small sphere must not pass it. The ground is a plane, or a sphere of radius 1000.
void expect_no_leak(bool is_ground_flat, double radius) {
    RandomInputs random(8);
    TestScene scene(1, 1, Vector3d::Zero());
    const std::int32_t grey = scene.diffuse(0.5);
    if (is_ground_flat) {
        scene.plane({0, 0, 0}, {0, 1, 0}, grey);
    } else {
        scene.sphere({0, -1000, 0}, 1000, grey);
    }
    const auto first_small = static_cast<std::int32_t>(scene.spheres.size());
    for (int i = 0; i < 20; ++i) {
        Vector3d center = random.point<double>(1);
        center.y() =
            radius + (is_ground_flat ? 0 : std::sqrt(1e6 - center.x() * center.x() - center.z() * center.z()) - 1000);
        scene.sphere(center, radius, grey);
    }
    const CompiledScene<float> compiled = compile<float>(scene);
    const std::int32_t ground_id = is_ground_flat ? 20 : 0;
    int leaks = 0;
    int shadowed = 0;
    for (int i = 0; i < kRays; ++i) {
        const std::int32_t small = first_small + i % 20;
        const auto* row = compiled.surfaces[small].value;
        Vec3<float> from = vec3<float>(row[0], 0, row[2]) + 0.7F * row[3] * random.point<float>(1);
        from[1] = 1;
        const Ray<float> down{from, vec3<float>(0, -1, 0), 0};
        const auto* ground = compiled.surfaces[ground_id].value;
        const float t = is_ground_flat
                            ? 1
                            : sphere_distance<float>(from, down.direction, vec3<float>(ground[0], ground[1], ground[2]),
                                                     ground[3], false);
        const SurfacePoint<float> point = surface_point<kEverything, float>(down, t, ground);
        const auto [u, v] = random.unit_square<float>();
        const Ray<float> ray{point.position, diffuse_direction<float>(point.normal, unit_sphere<float>(u, v)), 0};
        const ExactSphere exact(ray.origin, ray.direction, vec3<float>(row[0], row[1], row[2]), row[3]);
        if (!exact.is_met() || exact.first <= 0) continue;
        ++shadowed;
        NoTestCount work;
        const Hit<float> hit = closest_hit<kEverything>(compiled, ray, ground_id, work);
        if (hit.primitive_id == kNoPrimitive || hit.t > static_cast<float>(exact.first) * 1.01F) ++leaks;
    }
    EXPECT_GT(shadowed, kRays / 2);
    EXPECT_EQ(leaks, 0) << "radius " << radius;
}
TEST(SmallSphereOnTheGround, LetsNoLightThroughBeneathIt) {
    for (const double radius : {1e-4, 1e-3, 0.1}) {
        expect_no_leak(true, radius);
        expect_no_leak(false, radius);
    }
}

}  // namespace
}  // namespace raypool::test
