// Rows 11a to 11g: lights that touch something, are seen edge-on, from within, from far away, or are tiny; and the
// shadow rays toward them.

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "bench/naive/spheres.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"
#include "core/geometry/any_hit.h"
#include "core/shading/lights.h"

namespace raypool::stability {

namespace {

/// A place somewhere, with directions across and one up.
struct Place {
    Vector3d at, u, v, n;

    Place(RandomInputs& random, double distance)
        : at(distance * random.direction<double>()), n(random.direction<double>()) {
        u = perpendicular(random, n);
        v = n.cross(u);
    }
    [[nodiscard]] Vector3d point(double x, double y, double z) const { return at + x * u + y * v + z * n; }
};

/// Of material 0, which is grey, and 1, which shines.
Scene two_materials() {
    Scene scene;
    scene.textures.resize(2);
    scene.textures[0].even = Vector3d::Constant(0.5);
    scene.textures[1].even = Vector3d::Ones();
    scene.materials.resize(2);
    scene.materials[1] = {.kind = Material::Kind::Emissive, .texture_id = 1};
    return scene;
}
/// A square across the up of the place, around a point on it; its outward side is up.
Quad square(const Place& place, double height, double edge, std::int32_t material_id) {
    return {place.point(-0.5 * edge, -0.5 * edge, height), edge * place.u, edge * place.v, material_id};
}

/// A light sample of a scene with one light.
template <class Scalar>
struct Sample {
    const CompiledScene<Scalar>& scene;
    RayStart<Scalar> start;
    std::array<Scalar, 4> random;

    /// The sampled point of a light that is a quad, seen from where the ray starts.
    [[nodiscard]] Vec3<Scalar> to_point() const {
        using Light = LightRow<Scalar>;
        const Scalar* light = scene.lights[0].value;
        const auto part = [&](int first) { return vec3<Scalar>(light[first], light[first + 1], light[first + 2]); };
        return part(Light::kPoint) + random[1] * part(Light::kEdgeU) + random[2] * part(Light::kEdgeV) - start.origin;
    }
    [[nodiscard]] LightSample<Scalar> ours(LightSurface<Scalar>& surface) const {
        return sample_light<kEverything, Scalar>(scene, start, 0, random, surface);
    }
    [[nodiscard]] Hit<Scalar> closest(const Vec3<Scalar>& direction) const {
        NoTestCount work;
        return closest_hit<kEverything>(scene, Ray<Scalar>{start.origin, direction, 0}, start.leaving_id, work);
    }
};
template <class Scalar>
Sample<Scalar> drawn(RandomInputs& random, const CompiledScene<Scalar>& scene, const Vector3d& from) {
    Sample<Scalar> sample{scene, {narrow<Scalar>(from), kNoPrimitive}, {}};
    for (Scalar& number : sample.random) number = random.unit_interval<Scalar>();
    return sample;
}

// Ways to tell whether the sampled point is seen.
constexpr auto kOurShadow = []<class Scalar>(const Sample<Scalar>& sample) {
    LightSurface<Scalar> surface;
    const LightSample<Scalar> light = sample.ours(surface);
    if (!(light.t < kInfinity<Scalar>)) return false;
    NoTestCount work;
    return !is_occluded<kEverything>(sample.scene, Ray<Scalar>{sample.start.origin, light.direction, 0},
                                     sample.start.leaving_id,
                                     Occlusion<Scalar>{light.t, static_cast<std::int32_t>(light.primitive_id)}, work);
};
/// Anything closer than the point hides it, the lamp itself too.
constexpr auto kWholeRay = []<class Scalar>(const Sample<Scalar>& sample) {
    const Vec3<Scalar> to = sample.to_point();
    return !(sample.closest(unit<Scalar>(to)).t < to.norm());
};
/// The end of the ray does not count.
constexpr auto kShortened = []<class Scalar>(const Sample<Scalar>& sample) {
    const Vec3<Scalar> to = sample.to_point();
    return !(sample.closest(unit<Scalar>(to)).t < (1 - Scalar(1e-4)) * to.norm());
};
/// What the ray meets first must be the light.
constexpr auto kMeetsTheLight = []<class Scalar>(const Sample<Scalar>& sample) {
    LightSurface<Scalar> surface;
    const LightSample<Scalar> light = sample.ours(surface);
    return sample.closest(light.direction).primitive_id == light.primitive_id;
};

/// Samples of scenes that make(random, place) lists, of which is_wrong(is_lit, x) is true: x is where the sampled point
/// lies along the lamp's first edge.
template <class Scalar>
double wrong_share(const auto& is_lit, std::int64_t rays, const auto& make, const auto& is_wrong, double distance = 2) {
    constexpr int kRaysOfScene = 50;
    RandomInputs random(111);
    std::int64_t wrong = 0;
    std::int64_t traced = 0;
    while (traced < rays) {
        const Place place(random, distance);
        const CompiledScene<Scalar> scene = compile<Scalar>(make(place));
        for (int i = 0; i < kRaysOfScene; ++i, ++traced) {
            const double x = random.uniform(-0.2, 2), y = random.uniform(-1, 1), z = random.uniform(0.5, 2);
            const Sample<Scalar> sample = drawn<Scalar>(random, scene, place.point(x, y, z));
            wrong += is_wrong(is_lit(sample), static_cast<double>(sample.random[1])) ? 1 : 0;
        }
    }
    return share(wrong, traced);
}
constexpr auto kIsHidden = [](bool is_lit, double) { return !is_lit; };

/// A lamp whose edge lies in one wall and whose back is that far from another: nothing hides it.
constexpr auto kLampOnWall = []<class Scalar>(const auto& is_lit, double gap, std::int64_t rays) {
    const auto make = [gap](const Place& place) {
        Scene scene = two_materials();
        scene.quads = {square(place, -gap, 8, 0),
                       {place.point(-0.25, -4, -4), 8 * place.v, 8 * place.n, 0},
                       square(place, 0, 0.5, 1)};
        return scene;
    };
    return wrong_share<Scalar>(is_lit, rays, make, kIsHidden);
};
/// A shade that far before all of a lamp: nothing comes through.
constexpr auto kShade = []<class Scalar>(const auto& is_lit, double gap, std::int64_t rays) {
    const auto make = [gap](const Place& place) {
        Scene scene = two_materials();
        scene.quads = {square(place, gap, 8, 0), square(place, 0, 0.5, 1)};
        return scene;
    };
    return wrong_share<Scalar>(is_lit, rays, make, [](bool is_seen, double) { return is_seen; });
};
/// A lamp in a pane of glass that covers its first half and is listed before it: only the other half is there.
constexpr auto kInGlass = []<class Scalar>(const auto& is_lit, double distance, std::int64_t rays) {
    const auto make = [](const Place& place) {
        Scene scene = two_materials();
        scene.materials.push_back({.kind = Material::Kind::Dielectric, .ior = 1.5});
        scene.quads = {{place.point(-1, -1, 0), place.u, 2 * place.v, 2}, square(place, 0, 0.5, 1)};
        return scene;
    };
    const auto is_wrong = [](bool is_seen, double x) { return std::abs(x - 0.5) > 0.01 && is_seen != (x > 0.5); };
    return wrong_share<Scalar>(is_lit, rays, make, is_wrong, distance);
};
/// A shining ball about as far away as things are from the origin, in an empty room: nothing hides it.
constexpr auto kSmallLight = []<class Scalar>(const auto& is_lit, double radius, std::int64_t rays) {
    const auto make = [radius](const Place& place) {
        Scene scene = two_materials();
        scene.spheres = {{place.at, place.at, radius, 1}};
        return scene;
    };
    return wrong_share<Scalar>(is_lit, rays, make, kIsHidden);
};

// Ways to tell how far a sampled point of a quad is.
constexpr auto kOurDistance = []<class Scalar>(const Sample<Scalar>& sample) {
    LightSurface<Scalar> surface;
    return sample.ours(surface).t;
};
constexpr auto kByThePlane = []<class Scalar>(const Sample<Scalar>& sample) {
    const Scalar* row = sample.scene.surfaces[0].value;
    const auto part = [&](int first) { return vec3<Scalar>(row[first], row[first + 1], row[first + 2]); };
    return plane_distance<Scalar>(sample.start.origin, unit<Scalar>(sample.to_point()),
                                  part(SurfaceRow<Scalar>::kMotion), part(SurfaceRow<Scalar>::kCenter), false);
};
/// A lamp at a distance of about 1, seen at an angle of that sine: the distance to the sampled point. Where the origin,
/// as it is stored, lies in the plane or behind it, there may be none: that light is as little as the sine.
constexpr auto kEdgeOn = []<class Scalar>(const auto& distance, double sine, std::int64_t rays) {
    const Errors errors = errors_of(rays, RandomInputs(112), [&](RandomInputs& random, Errors& all) {
        const Place place(random, 2);
        Scene scene = two_materials();
        scene.quads = {square(place, 0, 0.5, 1)};
        const CompiledScene<Scalar> compiled = compile<Scalar>(scene);
        const Sample<Scalar> sample = drawn<Scalar>(random, compiled, place.point(1, 0, sine));
        const Vector3d point = place.point(0.5 * (static_cast<double>(sample.random[1]) - 0.5),
                                           0.5 * (static_cast<double>(sample.random[2]) - 0.5), 0);
        const double exact = (point - wide<Scalar>(sample.start.origin)).norm();
        const auto found = static_cast<double>(distance(sample));
        if (found < kInfinity<double>) all.add(found / exact - 1);
    });
    return quantile_up_to_one(errors, 0.99);
};

// Ways to tell the angle that a sphere fills, from its radius and the square of its distance.
constexpr auto kOurAngle = []<class Scalar>(Scalar radius, Scalar square) -> Scalar {
    const Scalar row[SurfaceRow<Scalar>::kColumns] = {0, 0, 0, radius};
    const Ray<Scalar> ray{vec3<Scalar>(std::sqrt(square), 0, 0), vec3<Scalar>(-1, 0, 0), 0};
    return 1 / light_density<Features{}, Scalar>(ray, Scalar(1), Scalar(1), row);
};
/// pbrt's second edition, chapter 14.6: 1 - cos cancels where the angle is small, and has no root within the sphere.
constexpr auto kOneLessCosine = []<class Scalar>(Scalar radius, Scalar square) -> Scalar {
    return 2 * std::numbers::pi_v<Scalar> * (1 - std::sqrt(1 - radius * radius / square));
};
/// Far from the sphere, on it, and in it.
constexpr auto kAngle = []<class Scalar>(const auto& angle, double distance, std::int64_t) {
    const auto square = static_cast<Scalar>(distance * distance);
    const long double square_sine = 1 / static_cast<long double>(square);
    const long double exact = square_sine >= 1 ? 4 : 2 * square_sine / (1 + std::sqrt(1 - square_sine));
    const auto error = static_cast<double>(angle(Scalar(1), square) / (exact * std::numbers::pi_v<long double>)-1);
    return std::isnan(error) ? 1 : std::min(std::abs(error), 1.0);
};

// Ways to tell whether a sphere hides a light from a point on itself.
constexpr auto kOurHorizon = [](const auto& origin, const auto& direction, const auto& center, auto radius) {
    return sphere_distance(origin, direction, center, radius, true);
};
constexpr auto kBookHorizon = []<class Scalar>(const Vec3<Scalar>& origin, const Vec3<Scalar>& direction,
                                               const Vec3<Scalar>& center, Scalar radius) {
    return naive::haines_distance<Scalar>(origin, direction, center, radius, Scalar(naive::kBookEpsilon));
};
/// Shadow rays that leave a ground sphere at that sine over the horizon, and meet it again, which none can.
constexpr auto kHorizon = []<class Scalar>(const auto& distance, double sine, std::int64_t rays) {
    const Scalar radius = 1000;
    return share_of(rays, RandomInputs(113), [&](RandomInputs& random) {
        const Vec3<Scalar> center = random.point<Scalar>(2);
        const SurfacePoint<Scalar> point = seen_point<Scalar>(random, center, radius);
        const Vec3<double> up = wide<Scalar>(point.normal).normalized();
        const Vec3<double> toward = std::sqrt(1 - sine * sine) * perpendicular(random, up) + sine * up;
        return distance(point.position, narrow<Scalar>(toward), center, radius) < kInfinity<Scalar>;
    });
};

}  // namespace

CaseMethods light_cases() {
    return {
        {"lamp-on-wall", Methods(kLampOnWall)
                             .naive("up to the distance, float", kWholeRay)
                             .other("up to 1 - 1e-4 of it, float", kShortened)
                             .ours_in_both(kOurShadow)},
        {"shade", Methods(kShade).naive("up to 1 - 1e-4 of the distance, float", kShortened).ours_in_both(kOurShadow)},
        {"lamp-edge-on", Methods(kEdgeOn).naive("by the plane alone, float", kByThePlane).ours_in_both(kOurDistance)},
        {"within-light", Methods(kAngle).naive("1 - cos of the cone, float", kOneLessCosine).ours_in_both(kOurAngle)},
        {"far-light", Methods(kAngle).naive("1 - cos of the cone, float", kOneLessCosine).ours_in_both(kOurAngle)},
        {"small-light",
         Methods(kSmallLight).naive("the closest hit is the light, float", kMeetsTheLight).ours_in_both(kOurShadow)},
        {"light-on-horizon",
         Methods(kHorizon).naive("least distance 1e-3, float", kBookHorizon).ours_in_both(kOurHorizon)},
        {"lamp-in-glass",
         Methods(kInGlass).naive("up to 1 - 1e-4 of the distance, float", kShortened).ours_in_both(kOurShadow)}};
}

}  // namespace raypool::stability
