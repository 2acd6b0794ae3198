// Added to the catalogue: planes far from the origin or met at a grazing angle, and the seam between two quads.

#include <algorithm>

#include <Eigen/Geometry>

#include "bench/naive/flats.h"
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

struct OffsetPlane {
    template <class Scalar>
    static Scalar distance(const PlaneRay<Scalar>& ray) {
        return naive::offset_plane_distance<Scalar>(ray.origin, ray.direction, ray.normal,
                                                    dot<Scalar>(ray.normal, ray.point));
    }
};
struct OurPlane {
    template <class Scalar>
    static Scalar distance(const PlaneRay<Scalar>& ray) {
        return plane_distance<Scalar>(ray.origin, ray.direction, ray.point, ray.normal, false);
    }
};
struct OurPlaneInDouble {
    template <class Scalar>
    static double distance(const PlaneRay<Scalar>& ray) {
        return plane_distance<double>(wide(ray.origin), wide(ray.direction), wide(ray.point), wide(ray.normal), false);
    }
};

template <class Scalar, class Plane>
double plane_error(double translation, double sine, std::int64_t rays) {
    RandomInputs random(91);
    Errors errors;
    for (std::int64_t i = 0; i < rays; ++i) {
        const PlaneRay<Scalar> ray(random, translation, sine);
        const Float128 exact = ray.exact();
        // The stored numbers need not be those that were aimed at: keep the rays that still meet the plane in front.
        if (exact > Float128{0.2} / Float128{sine} && exact < Float128{5} / Float128{sine})
            errors.add((Plane::template distance<Scalar>(ray) - exact) / exact);
    }
    return std::min(errors.quantile(0.99), 1.0);
}
template <class Scalar, class Plane>
double far_plane(double translation, std::int64_t rays) {
    return plane_error<Scalar, Plane>(translation, 0.5, rays);
}
template <class Scalar, class Plane>
double grazing_plane(double sine, std::int64_t rays) {
    return plane_error<Scalar, Plane>(0, sine, rays);
}

constexpr Features kPlanar{false, false, true, false, false, false, false, false, false};

/// Rays from a distance at the seam of two quads that share an edge, in any position: those that pass between the two.
template <class Scalar, bool is_ours>
double seam(double distance, std::int64_t rays) {
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
            bool is_met = false;
            if constexpr (is_ours) {
                NoTestCount work;
                is_met = closest_hit<kPlanar>(compiled, ray, kNoPrimitive, work).primitive_id != kNoPrimitive;
            } else {
                using Planar = PlanarRow<Scalar>;
                for (std::size_t id = 0; id < 2; ++id) {
                    const auto part = [](const Scalar* from) { return vec3<Scalar>(from[0], from[1], from[2]); };
                    const Scalar* planar = compiled.planars[id].value;
                    is_met =
                        is_met || naive::strict_quad_distance<Scalar>(
                                      ray.origin, ray.direction, part(planar + Planar::kCorner),
                                      part(compiled.surfaces[id].value + SurfaceRow<Scalar>::kCenter),
                                      part(planar + Planar::kDualU), part(planar + Planar::kDualV)) < kInfinity<Scalar>;
                }
            }
            passed += is_met ? 0 : 1;
        }
    }
    return share(passed, aimed_at);
}

}  // namespace

std::vector<Case> flat_cases() {
    std::vector<Case> cases;
    cases.push_back({.id = "far-plane",
                     .row = "+",
                     .parameter = "distance of the scene from the origin",
                     .values = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5},
                     .measure = "distance to the hit, relative error that 1 % exceed",
                     .tolerance = 1e-6,
                     .symptom = "floors and walls float; shadows come loose",
                     .samples = 20'000,
                     .methods = {{"n . p = offset, float", Kind::Naive, far_plane<float, OffsetPlane>},
                                 {"ours, float", Kind::Ours, far_plane<float, OurPlane>},
                                 {"ours, double", Kind::Ours, far_plane<double, OurPlane>}}});
    cases.push_back(
        {.id = "grazing-plane",
         .row = "+",
         .parameter = "sine of the angle between ray and plane",
         .values = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5},
         .measure = "distance to the hit, relative error that 1 % exceed",
         .tolerance = 1e-4,
         .symptom = "the horizon of a floor is ragged",
         .samples = 20'000,
         .methods = {{"ours, float", Kind::Ours, grazing_plane<float, OurPlane>},
                     {"ours, double on float", Kind::Alternative, grazing_plane<float, OurPlaneInDouble>},
                     {"ours, double", Kind::Ours, grazing_plane<double, OurPlane>}},
         .held = 3,
         .limit = "direction . normal cancels to a part of an ulp over the sine: the wider type is the cure"});
    cases.push_back({.id = "quad-seam",
                     .row = "+",
                     .parameter = "distance of the ray's origin, edges about 1",
                     .values = {1e0, 1e1, 1e2, 1e3},
                     .measure = "rays at the seam of two quads that pass between them, share",
                     .tolerance = 0,
                     .symptom = "bright or dark dots along the edges of a room",
                     .samples = 100'000,
                     .methods = {{"coordinates in [0, 1], float", Kind::Naive, seam<float, false>},
                                 {"ours, float", Kind::Ours, seam<float, true>},
                                 {"ours, double", Kind::Ours, seam<double, true>}}});
    return cases;
}

}  // namespace raypool::stability
