/// Meshes let no ray through between triangles, and no ray meets again the surface that it left.
#include "core/geometry/triangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/core/geometry/mesh_rays.h"
#include "tests/meshes.h"

namespace raypool::test {
namespace {

constexpr Vector3d (*kNowhere)() = [] { return Vector3d(0, 0, 0); };
constexpr Vector3d (*kFarAway)() = [] { return Vector3d(8000, -5000, 4000); };

template <class Scalar>
class TrianglesOf : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(TrianglesOf, Scalars);

/// A closed, convex mesh around a point: a sphere so large that its triangles are as large for any number of levels.
template <class Scalar>
struct Ball {
    Vector3d middle;
    double radius = std::ldexp(1.0, levels() - 4);
    CompiledScene<Scalar> scene;

    explicit Ball(const Vector3d& around) : middle(around), scene(compiled()) {}
    /// At most half a radius from the middle along each axis.
    [[nodiscard]] Vec3<Scalar> place_within(RandomInputs& random) const {
        return middle.cast<Scalar>() + static_cast<Scalar>(radius / 2) * random.point<Scalar>(1);
    }
    /// At two radii.
    [[nodiscard]] Vec3<Scalar> place_outside(RandomInputs& random) const {
        return middle.cast<Scalar>() + static_cast<Scalar>(radius * 2) * random.direction<Scalar>();
    }

  private:
    [[nodiscard]] CompiledScene<Scalar> compiled() const {
        Scene described = scene_of(icosphere(levels()), middle);
        described.meshes[0].transform.leftCols<3>() *= radius;
        return compile<Scalar>(described);
    }
};

/// Rays from within a closed mesh toward its vertices and points of edges.
TYPED_TEST(TrianglesOf, LetNothingThroughAtVerticesAndEdges) {
    using Scalar = TypeParam;
    for (const auto& middle : {kNowhere(), kFarAway()}) {
        const Ball<Scalar> ball(middle);
        const CompiledScene<Scalar>& scene = ball.scene;
        const auto passes = [&](RandomInputs& random, std::int64_t i) {
            const auto triangle = static_cast<std::uint32_t>(random.below(static_cast<int>(scene.triangles.size())));
            const Vec3<Scalar> from = ball.place_within(random);
            const Vec3<Scalar> a = vertex(scene, triangle, 0);
            const Vec3<Scalar> b = vertex(scene, triangle, 1);
            const auto s = i % 3 == 0 ? Scalar(0) : random.unit_interval<Scalar>();
            const Vec3<Scalar> target = a + s * (b - a);
            return hit_of(scene, Ray<Scalar>{from, unit<Scalar>(target - from), 0}, kNoPrimitive).primitive_id ==
                   kNoPrimitive;
        };
        EXPECT_EQ(count_of(ray_count(), 51, passes), 0) << "around " << middle.transpose();
    }
}

/// Of a convex mesh: what leaves it outward meets nothing, what leaves it inward meets something, and that is not what
/// it left.
TYPED_TEST(TrianglesOf, AreNotMetAgainByWhatLeavesThem) {
    using Scalar = TypeParam;
    for (const auto& middle : {kNowhere(), kFarAway()}) {
        const Ball<Scalar> ball(middle);
        const CompiledScene<Scalar>& scene = ball.scene;
        const auto fails = [&](RandomInputs& random, std::int64_t i) {
            const Vec3<Scalar> from = ball.place_outside(random);
            const Vec3<Scalar> to = ball.place_within(random);
            const bool is_inside = i % 2 == 0;
            const Ray<Scalar> ray{is_inside ? to : from, unit<Scalar>(is_inside ? from - to : to - from), 0};
            const Hit<Scalar> hit = hit_of(scene, ray, kNoPrimitive);
            if (hit.primitive_id == kNoPrimitive) return true;
            const PathKey<Scalar> key{static_cast<std::uint32_t>(i), 0};
            const Scattered<Scalar> out =
                scatter<kEverything, Scalar>(scene, ray, hit.t, hit.primitive_id, vec3<Scalar>(1, 1, 1), key, 0, {});
            const Hit<Scalar> next = hit_of(scene, Ray<Scalar>{out.start.origin, out.direction, 0}, kNoPrimitive);
            return is_inside ? next.primitive_id == kNoPrimitive || next.primitive_id == hit.primitive_id
                             : next.primitive_id != kNoPrimitive;
        };
        EXPECT_EQ(count_of(ray_count(), 52, fails), 0) << "around " << middle.transpose();
    }
}

/// Of a smooth convex mesh, of any material: what leaves it outward may meet it again from without, where its normals
/// send rays toward it, and never from within; what leaves it inward meets it from within.
TYPED_TEST(TrianglesOf, LetNothingThroughThatLeavesThemSmooth) {
    using Scalar = TypeParam;
    for (const auto kind : {Material::Kind::Diffuse, Material::Kind::Metal, Material::Kind::Dielectric}) {
        for (const auto& offset : {kNowhere(), kFarAway()}) {
            Scene described = scene_of(smooth_icosphere(2), offset);
            described.materials[0].kind = kind;
            described.materials[0].fuzz = 0.3;
            described.materials[0].ior = 1.5;
            const CompiledScene<Scalar> scene = compile<Scalar>(described);
            RandomInputs random(54);
            int wrong_sides = 0, lost = 0, met_again = 0;
            constexpr int kRays = 50'000;
            for (int i = 0; i < kRays; ++i) {
                const Vec3<Scalar> middle = offset.template cast<Scalar>();
                const Vec3<Scalar> from = middle + static_cast<Scalar>(2) * random.direction<Scalar>();
                const Vec3<Scalar> to = middle + static_cast<Scalar>(0.5) * random.point<Scalar>(1);
                const bool is_inside = i % 2 == 0;
                const Ray<Scalar> ray{is_inside ? to : from, unit<Scalar>(is_inside ? from - to : to - from), 0};
                const Hit<Scalar> hit = hit_of(scene, ray, kNoPrimitive);
                const PathKey<Scalar> key{static_cast<std::uint32_t>(i), 0};
                const Scattered<Scalar> out = scatter<kEverything, Scalar>(scene, ray, hit.t, hit.primitive_id,
                                                                           vec3<Scalar>(1, 1, 1), key, 0, {});
                if (!out.is_alive) {
                    ++lost;
                    continue;
                }
                const auto triangle = static_cast<std::uint32_t>(hit.primitive_id - scene.first_triangle);
                const auto outward_of = [&](std::uint32_t id) {
                    return triangle_normal<Scalar>({vertex(scene, id, 0), vertex(scene, id, 1), vertex(scene, id, 2)});
                };
                const bool is_through =
                    ((out.start.origin - vertex(scene, triangle, 0)).dot(outward_of(triangle)) < 0) != is_inside;
                const Hit<Scalar> next = hit_of(scene, Ray<Scalar>{out.start.origin, out.direction, 0},
                                                static_cast<std::int32_t>(out.start.leaving_id));
                if (is_inside != is_through) {
                    const auto id = static_cast<std::uint32_t>(next.primitive_id - scene.first_triangle);
                    wrong_sides += next.primitive_id == kNoPrimitive || out.direction.dot(outward_of(id)) < 0 ? 1 : 0;
                } else if (next.primitive_id != kNoPrimitive) {
                    const auto id = static_cast<std::uint32_t>(next.primitive_id - scene.first_triangle);
                    wrong_sides += out.direction.dot(outward_of(id)) > 0 ? 1 : 0;
                    ++met_again;
                }
            }
            EXPECT_EQ(wrong_sides, 0) << static_cast<int>(kind) << " around " << offset.transpose();
            EXPECT_LT(lost, kRays / 20);
            EXPECT_LT(met_again, kRays / 50);
        }
    }
}

TYPED_TEST(TrianglesOf, AreFoundByTreesAsOneByOne) {
    RandomInputs random(53);
    expect_what_is_found_one_by_one(compile<TypeParam>(scene_of(triangle_soup(500, random))), std::min(kInputs / 4, 20'000));
}

/// By the determinant of Moeller and Trumbore, in long double.
TEST(Triangle, IsMetWhereTheDeterminantSays) {
    RandomInputs random(54);
    int met = 0;
    for (int i = 0; i < 100'000; ++i) {
        std::array<Vec3<double>, 3> vertices;
        for (auto& v : vertices) v = random.point<double>(2);
        const Vec3<double> origin = random.point<double>(4);
        const Vec3<double> direction = random.direction<double>();
        const auto wide = [](const Vec3<double>& v) { return v.cast<long double>().eval(); };
        const auto e1 = (wide(vertices[1]) - wide(vertices[0])).eval();
        const auto e2 = (wide(vertices[2]) - wide(vertices[0])).eval();
        const auto p = wide(direction).cross(e2).eval();
        const long double det = e1.dot(p);
        const auto s = (wide(origin) - wide(vertices[0])).eval();
        const long double u = s.dot(p) / det;
        const auto q = s.cross(e1).eval();
        const long double v = wide(direction).dot(q) / det;
        const long double t = e2.dot(q) / det;
        const long double inside = std::min({u, v, 1 - u - v});
        if (std::abs(inside) < 1e-9L || std::abs(det) < 1e-6L) continue;
        const double got = triangle_distance<double>(origin, ray_shear<double>(direction), vertices, false);
        if (inside > 0 && t > 0) {
            EXPECT_NEAR(got, static_cast<double>(t), 1e-7 * static_cast<double>(t));
            ++met;
        } else {
            EXPECT_EQ(got, kInfinity<double>);
        }
    }
    EXPECT_GT(met, 1000);
}

TEST(Triangle, HasTheNormalOfItsOrder) {
    const std::array<Vec3<float>, 3> tiny{vec3<float>(0, 0, 0), vec3<float>(1e-12F, 0, 0), vec3<float>(0, 1e-12F, 0)};
    EXPECT_EQ(triangle_normal<float>(tiny), vec3<float>(0, 0, 1));
    const std::array<Vec3<float>, 3> line{vec3<float>(0, 0, 0), vec3<float>(1, 1, 1), vec3<float>(2, 2, 2)};
    EXPECT_FALSE(triangle_normal<float>(line).allFinite());
    const std::array<Vec3<float>, 3> point{vec3<float>(3, 3, 3), vec3<float>(3, 3, 3), vec3<float>(3, 3, 3)};
    EXPECT_FALSE(triangle_normal<float>(point).allFinite());
}

}  // namespace
}  // namespace raypool::test
