// Added to the catalogue: planes far from the origin or met at a grazing angle, and the seam between two quads.

#include <algorithm>

#include <Eigen/Geometry>

#include "bench/stability/case.h"
#include "bench/stability/rays.h"
#include "core/geometry/traverse.h"

namespace raypool::stability {

namespace {

template <class Scalar>
struct PlaneRay {
    Vec3<Scalar> origin, direction, point, normal;

    /// A ray that starts about 1 above a plane through a point that far from the origin, at an angle of that sine.
    PlaneRay(RandomInputs& random, double translation, double sine) {
        const Vec3<double> n = random.direction<double>();
        const Vec3<double> on_plane = translation * random.direction<double>();
        const Vec3<double> side = perpendicular(random, n);
        point = narrow<Scalar>(on_plane + random.uniform(0, 1) * perpendicular(random, n));
        normal = narrow<Scalar>(n);
        origin = narrow<Scalar>(on_plane + n);
        direction = narrow<Scalar>(std::sqrt(1 - sine * sine) * side - sine * n);
    }
    [[nodiscard]] Float128 exact() const {
        const ExactVec n = ExactVec::of<Scalar>(normal);
        return dot(ExactVec::of<Scalar>(point) - ExactVec::of<Scalar>(origin), n) /
               dot(ExactVec::of<Scalar>(direction), n);
    }
};

// Ways to find the distance to the plane.
/// "Ray Tracing: The Next Week", chapter 6.2: a plane as n . p = offset, which cancels far from the origin.
constexpr auto kOffsetPlane = []<class Scalar>(const PlaneRay<Scalar>& ray) {
    const Scalar offset = dot<Scalar>(ray.normal, ray.point);
    return (offset - dot<Scalar>(ray.normal, ray.origin)) / dot<Scalar>(ray.normal, ray.direction);
};
constexpr auto kOurPlane = [](const auto& ray) {
    return plane_distance(ray.origin, ray.direction, ray.point, ray.normal, false);
};
constexpr auto kOurPlaneInDouble = [](const auto& ray) {
    return plane_distance(wide(ray.origin), wide(ray.direction), wide(ray.point), wide(ray.normal), false);
};

template <class Scalar>
double plane_error(const auto& distance, double translation, double sine, std::int64_t rays) {
    const Errors errors = errors_of(rays, RandomInputs(91), [&](RandomInputs& random, Errors& all) {
        const PlaneRay<Scalar> ray(random, translation, sine);
        const Float128 exact = ray.exact();
        // The stored numbers need not be those that were aimed at: keep the rays that still meet the plane in front.
        if (exact > Float128{0.2} / Float128{sine} && exact < Float128{5} / Float128{sine})
            all.add((distance(ray) - exact) / exact);
    });
    return quantile_up_to_one(errors, 0.99);
}
constexpr auto kFarPlane = []<class Scalar>(const auto& distance, double translation, std::int64_t rays) {
    return plane_error<Scalar>(distance, translation, 0.5, rays);
};
constexpr auto kGrazingPlane = []<class Scalar>(const auto& distance, double sine, std::int64_t rays) {
    return plane_error<Scalar>(distance, 0, sine, rays);
};

constexpr Features kPlanar{false, false, true, false, false, false, false, false, false};

// Ways to tell whether a ray meets one of the two quads of a scene.
constexpr auto kOurQuads = []<class Scalar>(const CompiledScene<Scalar>& scene, const Ray<Scalar>& ray) {
    NoTestCount work;
    return closest_hit<kPlanar>(scene, ray, kNoPrimitive, work).primitive_id != kNoPrimitive;
};
/// Coordinates within [0, 1] and not an ulp beyond: quads that share an edge leave a gap where both round outward.
constexpr auto kStrictQuads = []<class Scalar>(const CompiledScene<Scalar>& scene, const Ray<Scalar>& ray) {
    using Planar = PlanarRow<Scalar>;
    const auto part = [](const Scalar* from) { return vec3<Scalar>(from[0], from[1], from[2]); };
    const auto is_met = [&](std::size_t id) {
        const Scalar* planar = scene.planars[id].value;
        const Vec3<Scalar> corner = part(planar + Planar::kCorner);
        const Vec3<Scalar> normal = part(scene.surfaces[id].value + SurfaceRow<Scalar>::kCenter);
        const Scalar t = plane_distance<Scalar>(ray.origin, ray.direction, corner, normal, false);
        const auto [u, v] = plane_coordinates<Scalar>(along<Scalar>(ray.origin, t, ray.direction), corner,
                                                      part(planar + Planar::kDualU), part(planar + Planar::kDualV));
        return u >= 0 && u <= 1 && v >= 0 && v <= 1 && t < kInfinity<Scalar>;
    };
    return is_met(0) || is_met(1);
};
/// Rays from a distance at the seam of two quads that share an edge, in any position: those that pass between the two.
constexpr auto kSeam = []<class Scalar>(const auto& is_met, double distance, std::int64_t rays) {
    RandomInputs random(92);
    constexpr std::int64_t kRaysOfPair = 100;
    std::int64_t passed = 0;
    std::int64_t aimed_at = 0;
    while (aimed_at < rays) {
        const Vec3<double> u = random.uniform(0.5, 2) * random.direction<double>();
        const Vec3<double> v = random.uniform(0.5, 2) * perpendicular(random, u.normalized());
        const Vec3<double> corner = random.point<double>(1);
        Scene scene;
        scene.textures.emplace_back();
        scene.materials.emplace_back();
        scene.quads = {{corner, u, v, 0}, {corner + u, u, v, 0}};
        const CompiledScene<Scalar> compiled = compile<Scalar>(scene);
        const Vec3<double> normal = u.cross(v).normalized();
        for (std::int64_t i = 0; i < kRaysOfPair; ++i, ++aimed_at) {
            const Vec3<double> target = corner + u + random.uniform(0.01, 0.99) * v;
            Vec3<double> away = random.direction<double>();
            if (std::abs(away.dot(normal)) < 0.2) away = normal;
            const Ray<Scalar> ray{narrow<Scalar>(target + distance * away), narrow<Scalar>(-away), 0};
            passed += is_met(compiled, ray) ? 0 : 1;
        }
    }
    return share(passed, aimed_at);
};

}  // namespace

CaseMethods planar_cases() {
    return {{"far-plane", Methods(kFarPlane).naive("n . p = offset, float", kOffsetPlane).ours_in_both(kOurPlane)},
            {"grazing-plane", Methods(kGrazingPlane)
                                  .ours<float>("ours, float", kOurPlane)
                                  .other("ours, double on float", kOurPlaneInDouble)
                                  .ours<double>("ours, double", kOurPlane)},
            {"quad-seam", Methods(kSeam).naive("coordinates in [0, 1], float", kStrictQuads).ours_in_both(kOurQuads)}};
}

}  // namespace raypool::stability
