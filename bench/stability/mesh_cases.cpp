// Rows 12a to 12c: what passes between the triangles of a closed mesh, what meets again the mesh that it left, and what
// a smooth mesh hides from itself.

#include <cmath>

#include <Eigen/Geometry>

#include "bench/naive/triangles.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"
#include "core/geometry/traverse.h"
#include "tests/meshes.h"

namespace raypool::stability {

namespace {

/// A closed, convex mesh of 1280 triangles, of radius 1, as far from the origin as is said along every axis.
template <class Scalar>
CompiledScene<Scalar> ball(double distance) {
    return compile<Scalar>(test::scene_of(test::icosphere(3), Vector3d::Constant(distance)));
}
template <class Scalar>
std::array<Vec3<Scalar>, 3> vertices_of(const CompiledScene<Scalar>& scene, std::size_t triangle) {
    std::array<Vec3<Scalar>, 3> vertices;
    for (int i = 0; i < 3; ++i) {
        const auto id = static_cast<std::size_t>(bits_of<Scalar>(scene.triangles[triangle].value[i]));
        const Scalar* row = scene.vertices[id].value;
        vertices[static_cast<std::size_t>(i)] = vec3<Scalar>(row[0], row[1], row[2]);
    }
    return vertices;
}
template <class Scalar>
Hit<Scalar> hit_of(const CompiledScene<Scalar>& scene, const Vec3<Scalar>& origin, const Vec3<Scalar>& direction,
                   std::int32_t leaving_id) {
    NoTestCount work;
    return closest_hit<kEverything>(scene, Ray<Scalar>{origin, direction, 0}, leaving_id, work);
}

// Ways to tell whether a ray meets any triangle.
constexpr auto kOurTest = []<class Scalar>(const CompiledScene<Scalar>& scene, const Ray<Scalar>& ray) {
    return hit_of(scene, ray.origin, ray.direction, kNoPrimitive).primitive_id != kNoPrimitive;
};
constexpr auto kMoellerTrumbore = []<class Scalar>(const CompiledScene<Scalar>& scene, const Ray<Scalar>& ray) {
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
        if (naive::moeller_trumbore_distance<Scalar>(ray.origin, ray.direction, vertices_of(scene, i)) <
            kInfinity<Scalar>)
            return true;
    }
    return false;
};
/// Rays from within toward vertices and points of edges, which all must meet the mesh.
constexpr auto kAtEdges = []<class Scalar>(const auto& is_met, double distance, std::int64_t rays) {
    const CompiledScene<Scalar> scene = ball<Scalar>(distance);
    return share_of(rays, RandomInputs(121), [&](RandomInputs& random) {
        const auto triangle = static_cast<std::size_t>(random.below(static_cast<int>(scene.triangles.size())));
        const std::array<Vec3<Scalar>, 3> vertices = vertices_of(scene, triangle);
        const Scalar part = random.one_in(2) ? Scalar(0) : random.unit_interval<Scalar>();
        const Vec3<Scalar> target = vertices[0] + part * (vertices[1] - vertices[0]);
        const Vec3<Scalar> origin =
            Vec3<Scalar>::Constant(static_cast<Scalar>(distance)) + Scalar(0.5) * random.point<Scalar>(1);
        return !is_met(scene, Ray<Scalar>{origin, unit<Scalar>(target - origin), 0});
    });
};

/// A ray that met the mesh, and what came of it.
template <class Scalar>
struct Bounce {
    Ray<Scalar> ray;
    Hit<Scalar> hit;
    Scattered<Scalar> out;
};

// Ways to find what a scattered ray meets.
constexpr auto kOurStart = []<class Scalar>(const CompiledScene<Scalar>& scene, const Bounce<Scalar>& bounce) {
    return hit_of(scene, bounce.out.start.origin, bounce.out.direction, bounce.out.start.leaving_id);
};
constexpr auto kById = []<class Scalar>(const CompiledScene<Scalar>& scene, const Bounce<Scalar>& bounce) {
    return hit_of(scene, along<Scalar>(bounce.ray.origin, bounce.hit.t, bounce.ray.direction), bounce.out.direction,
                  bounce.hit.primitive_id);
};
constexpr auto kLeastDistance = []<class Scalar>(const CompiledScene<Scalar>& scene, const Bounce<Scalar>& bounce) {
    const Vec3<Scalar> from = along<Scalar>(bounce.ray.origin, bounce.hit.t, bounce.ray.direction);
    return hit_of(scene, along<Scalar>(from, Scalar(1e-4), bounce.out.direction), bounce.out.direction, kNoPrimitive);
};
/// Rays that leave the mesh outward, which meet nothing, and inward, which do.
constexpr auto kLeaving = []<class Scalar>(const auto& next_hit, double distance, std::int64_t rays) {
    const CompiledScene<Scalar> scene = ball<Scalar>(distance);
    std::uint32_t sample = 0;
    return share_of(rays, RandomInputs(122), [&](RandomInputs& random) {
        const Vec3<Scalar> middle = Vec3<Scalar>::Constant(static_cast<Scalar>(distance));
        const Vec3<Scalar> outside = middle + Scalar(2) * random.direction<Scalar>();
        const Vec3<Scalar> inside = middle + Scalar(0.5) * random.point<Scalar>(1);
        const bool is_inside = random.one_in(2);
        Bounce<Scalar> bounce;
        bounce.ray = {is_inside ? inside : outside, unit<Scalar>(is_inside ? outside - inside : inside - outside), 0};
        bounce.hit = hit_of(scene, bounce.ray.origin, bounce.ray.direction, kNoPrimitive);
        if (bounce.hit.primitive_id == kNoPrimitive) return true;
        bounce.out = scatter<kEverything, Scalar>(scene, bounce.ray, bounce.hit.t, bounce.hit.primitive_id,
                                                  vec3<Scalar>(1, 1, 1), PathKey<Scalar>{sample++, 0}, 0, {});
        return (next_hit(scene, bounce).primitive_id != kNoPrimitive) != is_inside;
    });
};

/// A point of a smooth mesh that a ray met.
template <class Scalar>
struct SmoothHit {
    TrianglePoint<Scalar> triangle;
    SurfacePoint<Scalar> point;
    RayStart<Scalar> start;

    SmoothHit(const CompiledScene<Scalar>& scene, const Ray<Scalar>& ray, const Hit<Scalar>& hit) {
        Scalar row[SurfaceRow<Scalar>::kColumns];
        triangle = load_surface<kEverything, Scalar>(scene, ray, hit.primitive_id, row);
        point = surface_point<kEverything, Scalar>(ray, hit.t, row);
        triangle.place(point);
        set_ray_start<kEverything, Scalar>(start, point, triangle, hit.primitive_id, row);
    }
};

// Ways to tell whether a point sees a light in some direction.
constexpr auto kLifted = []<class Scalar>(const CompiledScene<Scalar>& scene, const SmoothHit<Scalar>& at,
                                          const Vec3<Scalar>& light) {
    return !at.point.loses(light, false) &&
           hit_of(scene, at.start.origin, light, static_cast<std::int32_t>(at.start.leaving_id)).primitive_id ==
               kNoPrimitive;
};
constexpr auto kFromThePoint = []<class Scalar>(const CompiledScene<Scalar>& scene, const SmoothHit<Scalar>& at,
                                                const Vec3<Scalar>& light) {
    return hit_of(scene, triangle_start<Scalar>(at.point.position, at.triangle, at.point.side()), light, kNoPrimitive)
               .primitive_id == kNoPrimitive;
};
/// Of lights above the horizon of a ball, which hides none of them; triangles have edges of about `edge` of its radius.
constexpr auto kSelfShadow = []<class Scalar>(const auto& is_seen, double edge, std::int64_t rays) {
    const int levels = static_cast<int>(std::lround(std::log2(1.0515 / edge)));  // an icosahedron's edge
    const CompiledScene<Scalar> scene = compile<Scalar>(test::scene_of(test::smooth_icosphere(levels)));
    return share_of(rays, RandomInputs(123), [&](RandomInputs& random) {
        const Vec3<Scalar> outside = Scalar(2) * random.direction<Scalar>();
        // A cube so small lies within an icosahedron, so that every ray meets the ball.
        const Ray<Scalar> ray{outside, unit<Scalar>(Scalar(0.4) * random.point<Scalar>(1) - outside), 0};
        const SmoothHit<Scalar> at(scene, ray, hit_of(scene, ray.origin, ray.direction, kNoPrimitive));
        const Vec3<Scalar> light = random.direction<Scalar>();
        return light.dot(at.point.position) > 0 && !is_seen(scene, at, light);
    });
};

}  // namespace

CaseMethods mesh_cases() {
    return {{"mesh-edge", Methods(kAtEdges).naive("Moeller-Trumbore, float", kMoellerTrumbore).ours_in_both(kOurTest)},
            {"mesh-leaving", Methods(kLeaving)
                                 .naive("the triangle's id alone, float", kById)
                                 .naive("least distance 1e-4, float", kLeastDistance)
                                 .ours_in_both(kOurStart)},
            {"mesh-terminator",
             Methods(kSelfShadow).naive("from the point of the triangle, float", kFromThePoint).ours_in_both(kLifted)}};
}

}  // namespace raypool::stability
