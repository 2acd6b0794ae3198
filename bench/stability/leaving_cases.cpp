// Rows 2a to 2d: rays that start on a surface, which they must neither meet again nor lose the other side of.

#include <cmath>

#include "bench/naive/spheres.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"
#include "core/shading/materials.h"

namespace raypool::stability {

namespace {

// Ways to find the distance from a surface point to a sphere, which the point may be on. The naive ones have the same
// roots as ours, and do not count hits closer than a least distance.
constexpr auto kNoEpsilon = [](const auto& at, const auto& direction, const auto& center, auto radius, bool) {
    return naive::haines_distance(at.position, direction, center, radius);
};
constexpr auto kBookEpsilon = []<class Scalar>(const SurfacePoint<Scalar>& at, const Vec3<Scalar>& direction,
                                               const Vec3<Scalar>& center, Scalar radius, bool) {
    return naive::haines_distance<Scalar>(at.position, direction, center, radius, Scalar(naive::kBookEpsilon));
};
/// The origin is moved off the surface, to the side that the ray goes to.
constexpr auto kOffset = [](const SurfacePoint<float>& at, const Vec3<float>& direction, const Vec3<float>& center,
                            float radius, bool) {
    const Vec3<float> side = dot<float>(direction, at.outward) > 0 ? at.outward : Vec3<float>(-at.outward);
    return naive::haines_distance(naive::offset_origin(at.position, side), direction, center, radius);
};
constexpr auto kOurs = [](const auto& at, const auto& direction, const auto& center, auto radius, bool is_on) {
    return sphere_distance(at.position, direction, center, radius, is_on);
};

template <class Scalar>
Vec3<Scalar> diffuse(RandomInputs& random, const Vec3<Scalar>& normal) {
    const auto [u, v] = random.unit_square<Scalar>();
    return diffuse_direction<Scalar>(normal, unit_sphere<Scalar>(u, v));
}

/// Diffuse rays that leave a sphere and meet it again, which none can.
template <class Scalar>
double acne(const auto& distance, double radius, double translation, std::int64_t rays) {
    const auto r = static_cast<Scalar>(radius);
    return share_of(rays, RandomInputs(21), [&](RandomInputs& random) {
        const Vec3<Scalar> center = narrow<Scalar>(translation * random.direction<double>());
        const SurfacePoint<Scalar> point = seen_point<Scalar>(random, center, r);
        return distance(point, diffuse<Scalar>(random, point.normal), center, r, true) < kInfinity<Scalar>;
    });
}
constexpr auto kAcneByTranslation = []<class Scalar>(const auto& distance, double translation, std::int64_t rays) {
    return acne<Scalar>(distance, 1, translation, rays);
};
constexpr auto kAcneByRadius = []<class Scalar>(const auto& distance, double radius, std::int64_t rays) {
    return acne<Scalar>(distance, radius, 0, rays);
};

/// Rays refracted into a sphere of glass that do not meet its far side, which all do.
constexpr auto kLostFarSide = []<class Scalar>(const auto& distance, double radius, std::int64_t rays) {
    const auto r = static_cast<Scalar>(radius);
    return share_of(rays, RandomInputs(22), [&](RandomInputs& random) {
        const Vec3<Scalar> center = random.point<Scalar>(2);
        const SurfacePoint<Scalar> point = seen_point<Scalar>(random, center, r);
        Vec3<Scalar> arriving = random.direction<Scalar>();
        if (dot<Scalar>(arriving, point.normal) > 0) arriving = -arriving;
        const Vec3<Scalar> inward = fresnel_split<Scalar>(arriving, point.normal, 1 / Scalar(1.5)).refracted;
        return !(distance(point, inward, center, r, true) < kInfinity<Scalar>);
    });
};

/// Light that comes through a sphere resting on the ground to the ground beneath it.
constexpr auto kLeak = []<class Scalar>(const auto& distance, double radius, std::int64_t rays) {
    const auto r = static_cast<Scalar>(radius);
    const Vec3<Scalar> center = vec3<Scalar>(0, r, 0);
    return share_of(rays, RandomInputs(23), [&](RandomInputs& random) -> std::optional<bool> {
        SurfacePoint<Scalar> ground{};
        ground.position = random.point<Scalar>(radius);
        ground.position[1] = 0;
        ground.normal = ground.outward = vec3<Scalar>(0, 1, 0);
        const Vec3<Scalar> up = diffuse<Scalar>(random, ground.normal);
        if (!ExactSphere(ground.position, up, center, r).is_met()) return {};
        return !(distance(ground, up, center, r, false) < kInfinity<Scalar>);
    });
};

/// A closed sphere whose wall shines with 1 and reflects 99 %: every path brings home 100. What is missing, as a part.
/// A path that leaves through the wall is lost. One that meets the wall where it stands is not seen, so this is a test
/// beside those for hits and never in their place.
constexpr auto kFurnace = []<class Scalar>(const auto& distance, double translation, std::int64_t paths) {
    constexpr double kAlbedo = 0.99;
    RandomInputs random(24);
    double sum = 0;
    for (std::int64_t i = 0; i < paths; ++i) {
        const Vec3<Scalar> center = narrow<Scalar>(translation * random.direction<double>());
        SurfacePoint<Scalar> point{};
        point.position = center;
        Vec3<Scalar> direction = random.direction<Scalar>();
        double throughput = 1;
        for (bool is_on = false; throughput > 1e-9; is_on = true) {
            const Scalar t = distance(point, direction, center, Scalar(1), is_on);
            if (!(t < kInfinity<Scalar>)) break;
            sum += throughput;
            throughput *= kAlbedo;
            point = sphere_point<Scalar>({point.position, direction, 0}, t, center, Scalar(1));
            direction = diffuse<Scalar>(random, point.normal);
        }
        if (throughput <= 1e-9) sum += throughput / (1 - kAlbedo);
    }
    return std::abs(sum * (1 - kAlbedo) / static_cast<double>(paths) - 1);
};

}  // namespace

CaseMethods leaving_cases() {
    return {{"acne-far", Methods(kAcneByTranslation)
                             .naive("least distance 0, float", kNoEpsilon)
                             .naive("least distance 1e-3, float", kBookEpsilon)
                             .other("offset origin, float", kOffset)
                             .ours_in_both(kOurs)},
            {"acne-large", Methods(kAcneByRadius)
                               .naive("least distance 0, float", kNoEpsilon)
                               .naive("least distance 1e-3, float", kBookEpsilon)
                               .other("offset origin, float", kOffset)
                               .ours_in_both(kOurs)},
            {"far-side", Methods(kLostFarSide).naive("least distance 1e-3, float", kBookEpsilon).ours_in_both(kOurs)},
            {"leak", Methods(kLeak).naive("least distance 1e-3, float", kBookEpsilon).ours_in_both(kOurs)},
            {"furnace-far", Methods(kFurnace).naive("least distance 1e-3, float", kBookEpsilon).ours_in_both(kOurs)}};
}

}  // namespace raypool::stability
