/// Instances let no ray through between triangles, and are met where their placed triangles are.
#include "core/geometry/instances.h"

#include <gtest/gtest.h>

#include <concepts>

#include <Eigen/Geometry>

#include "tests/core/geometry/mesh_rays.h"
#include "tests/meshes.h"

namespace raypool::test {
namespace {

template <class Scalar>
class InstancesOf : public testing::Test {};
using ScalarsOfInstances = testing::Types<float, double>;
TYPED_TEST_SUITE(InstancesOf, ScalarsOfInstances);

/// Triangles at random in five instances that are turned, stretched and mirrored, of which the last two are the same.
Scene instances_of_soup() {
    RandomInputs random(53);
    Scene scene = scene_of(triangle_soup(500, random));
    for (int i = 0; i < 4; ++i) {
        MeshShape shape = scene.meshes[0];
        shape.is_instance = true;
        shape.transform = (Eigen::Translation3d(random.point<double>(1)) *
                           Eigen::AngleAxisd(random.uniform(0, 6), random.direction<double>()) *
                           Eigen::Scaling(random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(-1, 1)))
                              .affine();
        scene.meshes.push_back(shape);
    }
    scene.meshes.push_back(scene.meshes.back());
    scene.meshes.erase(scene.meshes.begin());
    return scene;
}

TYPED_TEST(InstancesOf, AreFoundByTreesAsOneByOne) {
    expect_what_is_found_one_by_one(compile<TypeParam>(instances_of_soup()), 2'000);
}

/// A closed mesh that is turned, stretched and, every other time, mirrored, at many places: of rays from within toward
/// its vertices and points of its edges, and of those that leave it, none gets through.
TYPED_TEST(InstancesOf, LetNothingThroughWhereTheyAreInstances) {
    using Scalar = TypeParam;
    using Row = InstanceRow<Scalar>;
    RandomInputs places(55);
    const auto mesh = std::make_shared<const Mesh>(icosphere(std::min(levels(), 5)));
    for (int round = 0; round < 8; ++round) {
        Scene described = scene_of(*mesh, Vector3d(1e6, 0, 0));
        MeshShape shape{mesh};
        shape.is_instance = true;
        const Vector3d middle = (round < 4 ? 1 : 8000) * places.direction<double>();
        shape.transform =
            (Eigen::Translation3d(middle) * Eigen::AngleAxisd(places.uniform(0, 6), places.direction<double>()) *
             Eigen::Scaling(places.uniform(0.2, 4), places.uniform(0.2, 4),
                            (round % 2 == 0 ? 1 : -1) * places.uniform(0.2, 4)))
                .affine();
        described.meshes.push_back(shape);
        const CompiledScene<Scalar> scene = compile<Scalar>(described);
        const Row& instance = scene.instance_tree.blocks[0];
        const auto placing = Placing<Scalar>::of(instance.value + Row::kTransform);
        const auto first = static_cast<std::uint32_t>(instance.number(Row::kFirstTriangle));
        const auto within = [&](RandomInputs& random) {
            const Vec3<Scalar> p = random.point<Scalar>(1);
            return placing.point(static_cast<Scalar>(0.5) * p);
        };
        const auto passes = [&](RandomInputs& random, std::int64_t i) {
            const auto triangle =
                first + static_cast<std::uint32_t>(random.below(static_cast<int>(mesh->triangles.size())));
            const Vec3<Scalar> from = within(random);
            const Vec3<Scalar> a = placing.point(vertex(scene, triangle, 0));
            const Vec3<Scalar> b = placing.point(vertex(scene, triangle, 1));
            const auto s = i % 3 == 0 ? Scalar(0) : random.unit_interval<Scalar>();
            const Vec3<Scalar> target = a + s * (b - a);
            const Ray<Scalar> ray{from, unit<Scalar>(target - from), 0};
            const Hit<Scalar> hit = hit_of(scene, ray, kNoPrimitive);
            if (hit.primitive_id < scene.first_instanced) return true;
            const Scattered<Scalar> out = scatter<kEverything, Scalar>(
                scene, ray, hit.t, hit.primitive_id, vec3<Scalar>(1, 1, 1), {static_cast<std::uint32_t>(i), 0}, 0, {});
            const Hit<Scalar> next = hit_of(scene, Ray<Scalar>{out.start.origin, out.direction, 0},
                                            static_cast<std::int32_t>(out.start.leaving_id));
            return next.primitive_id < scene.first_instanced || next.primitive_id == hit.primitive_id;
        };
        EXPECT_EQ(count_of(ray_count() / 8, 56, passes), 0) << shape.transform;

        // From far away, where the origin is all of the rounding, toward a place within.
        const auto misses = [&](RandomInputs& random, std::int64_t) {
            const Vec3<Scalar> to = within(random);
            const Vec3<Scalar> from = to + static_cast<Scalar>(1e4) * random.direction<Scalar>();
            return hit_of(scene, Ray<Scalar>{from, unit<Scalar>(to - from), 0}, kNoPrimitive).primitive_id <
                   scene.first_instanced;
        };
        if (std::same_as<Scalar, double> || round < 4) {
            EXPECT_EQ(count_of(ray_count() / 8, 57, misses), 0) << shape.transform;
        }
    }
}

/// Where rounding leaves a placed triangle no area, shading has a normal all the same: that toward the ray.
TYPED_TEST(InstancesOf, HaveANormalWhereRoundingLeavesNoArea) {
    using Scalar = TypeParam;
    Scene described = scene_of(icosphere(0));
    described.meshes[0].is_instance = true;
    described.meshes[0].transform.leftCols<3>() *= 1e-9;
    described.meshes[0].transform.col(3).setConstant(1e9);
    const CompiledScene<Scalar> scene = compile<Scalar>(described);
    const Ray<Scalar> ray{vec3<Scalar>(0, 0, 0), unit<Scalar>(vec3<Scalar>(1, 1, 1)), 0};
    Scalar row[SurfaceRow<Scalar>::kColumns];
    load_surface<kEverything, Scalar>(scene, ray, Int<Scalar>(scene.first_instanced), row);
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(row[axis], -ray.direction[axis]);
}

}  // namespace
}  // namespace raypool::test
