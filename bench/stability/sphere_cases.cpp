// Rows 1a to 1e: far, grazing and huge spheres, and where their hits are put.

#include <algorithm>

#include "bench/naive/spheres.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"

namespace raypool::stability {

namespace {

// Ways to find the distance along a ray to a sphere.
constexpr auto kHalfB = [](const auto&... ray_and_sphere) { return naive::half_b_distance(ray_and_sphere...); };
constexpr auto kInterval = [](const auto&... ray_and_sphere) { return naive::interval_distance(ray_and_sphere...); };
constexpr auto kHaines = [](const auto&... ray_and_sphere) { return naive::haines_distance(ray_and_sphere...); };
constexpr auto kOurs = []<class Real>(const Vec3<Real>& origin, const Vec3<Real>& direction, const Vec3<Real>& center,
                                      const Real& radius) {
    return sphere_distance<Real>(origin, direction, center, radius, Mask<Real>(false));
};
/// Inputs are in single precision, all else is in double.
constexpr auto kDoubleOnFloat = [](const auto& origin, const auto& direction, const auto& center, float radius) {
    return kOurs(wide(origin), wide(direction), wide(center), static_cast<double>(radius));
};

/// Packets of rays around a unit sphere at the origin.
std::vector<Ray<Packet>> packets_around_sphere() {
    RandomInputs random(77);
    std::vector<Ray<Packet>> packets(64);
    for (Ray<Packet>& packet : packets)
        for (int lane = 0; lane < kLanes<Packet>; ++lane) {
            const Ray<float> ray =
                aimed<float>(random, vec3<float>(0, 0, 0), 1, random.uniform(2, 20), random.uniform(0, 2));
            for (int i = 0; i < 3; ++i) {
                packet.origin[i][lane] = ray.origin[i];
                packet.direction[i][lane] = ray.direction[i];
            }
        }
    return packets;
}
/// A call for each ray. The sphere is read from memory: a compiler that knew it would fold half of the test away.
/// Infinite distances are cut, so that the sum depends on every call.
template <class Way>
auto timed(Way way) {
    return [way](std::int64_t calls) {
        static const std::vector<Ray<Packet>> kPackets = packets_around_sphere();
        static volatile float coordinate = 0;
        static volatile float radius = 1;
        const Vec3<Packet> center = Vec3<Packet>::Constant(Packet(coordinate));
        const Packet r(radius);
        Packet sum(0);
        for (std::int64_t i = 0; i < calls / kLanes<Packet>; ++i) {
            const Ray<Packet>& ray = kPackets[static_cast<std::size_t>(i) % kPackets.size()];
            sum += min(way(ray.origin, ray.direction, center, r), Packet(1));
        }
        return static_cast<double>(stdx::reduce(sum));
    };
}

/// A ray against a sphere at the origin: what is true, and what a way finds.
template <class Scalar, class Way>
struct Trial {
    Ray<Scalar> ray;
    ExactSphere exact;
    decltype(std::declval<Way>()(ray.origin, ray.direction, ray.origin, Scalar())) t;

    Trial(const Ray<Scalar>& traced, const Way& way, const Vec3<Scalar>& center, Scalar radius)
        : ray(traced),
          exact(ray.origin, ray.direction, center, radius),
          t(way(ray.origin, ray.direction, center, radius)) {}
    [[nodiscard]] bool is_hit() const { return t < kInfinity<decltype(t)>; }
    [[nodiscard]] Float128 relative_error() const { return (t - exact.first) / exact.first; }
    /// How far the hit is from the true one, which for a unit sphere is the angle between the normals.
    [[nodiscard]] double apart() const {
        const auto point = [&](Float128 at) {
            const ExactVec p = ExactVec::of<Scalar>(ray.origin) + at * ExactVec::of<Scalar>(ray.direction);
            return Vec3<double>(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
        };
        return (point(t) - point(exact.first)).norm();
    }
};
template <class Scalar, class Way>
Trial<Scalar, Way> unit_sphere_trial(const Ray<Scalar>& ray, const Way& way) {
    return {ray, way, vec3<Scalar>(0, 0, 0), Scalar(1)};
}

/// A ray from that far away whose line passes a unit sphere at 0 to 2 radii.
template <class Scalar, class Way>
auto far_trial(RandomInputs& random, double distance, const Way& way) {
    return unit_sphere_trial(aimed<Scalar>(random, vec3<Scalar>(0, 0, 0), 1, distance, random.uniform(0, 2)), way);
}
constexpr auto kFlips = []<class Scalar>(const auto& way, double distance, std::int64_t rays) {
    return share_of(rays, RandomInputs(11), [&](RandomInputs& random) {
        const auto trial = far_trial<Scalar>(random, distance, way);
        return trial.exact.is_met() != trial.is_hit();
    });
};
constexpr auto kDistanceError = []<class Scalar>(const auto& way, double distance, std::int64_t rays) {
    const Errors errors = errors_of(rays, RandomInputs(11), [&](RandomInputs& random, Errors& all) {
        const auto trial = far_trial<Scalar>(random, distance, way);
        if (trial.exact.is_met() && trial.is_hit()) all.add(trial.relative_error());
    });
    return quantile_up_to_one(errors, 0.99);
};
constexpr auto kNormalError = []<class Scalar>(const auto& way, double distance, std::int64_t rays) {
    const Errors errors = errors_of(rays, RandomInputs(11), [&](RandomInputs& random, Errors& all) {
        const auto trial = far_trial<Scalar>(random, distance, way);
        if (trial.exact.is_met() && trial.is_hit()) all.add(trial.apart());
    });
    return quantile_up_to_one(errors, 0.99);
};

/// A ray that passes the centre of a unit sphere, 10 away, at the radius less a part. The direction was rounded, so
/// some rays do not graze by about that part any more: there is no trial of them.
template <class Scalar, class Way>
std::optional<Trial<Scalar, Way>> grazing_trial(RandomInputs& random, double part, const Way& way) {
    const auto trial = unit_sphere_trial(aimed<Scalar>(random, vec3<Scalar>(0, 0, 0), 1, 10, 1 - part), way);
    if (std::abs(1 - static_cast<double>(trial.exact.impact) - part) > 0.5 * part) return {};
    return trial;
}
constexpr auto kGrazingMisses = []<class Scalar>(const auto& way, double part, std::int64_t rays) {
    return share_of(rays, RandomInputs(12), [&](RandomInputs& random) -> std::optional<bool> {
        const auto trial = grazing_trial<Scalar>(random, part, way);
        if (!trial) return {};
        return !trial->is_hit();
    });
};
constexpr auto kGrazingDistance = []<class Scalar>(const auto& way, double part, std::int64_t rays) {
    const Errors errors = errors_of(rays, RandomInputs(12), [&](RandomInputs& random, Errors& all) {
        const auto trial = grazing_trial<Scalar>(random, part, way);
        if (trial && trial->is_hit()) all.add(trial->relative_error());
    });
    return quantile_up_to_one(errors, 1);
};

/// From the eye to a point of the plane y = 0.
template <class Scalar>
Ray<Scalar> ground_ray(RandomInputs& random, const Vec3<Scalar>& eye, double half_edge) {
    Vec3<double> target = random.point<double>(half_edge);
    target[1] = 0;
    return {eye, narrow<Scalar>((target - wide<Scalar>(eye)).normalized()), 0};
}
/// The ground, a sphere whose top is the origin, seen from (13, 2, 3).
constexpr auto kGroundDistance = []<class Scalar>(const auto& way, double radius, std::int64_t rays) {
    const Vec3<Scalar> eye = vec3<Scalar>(13, 2, 3);
    const Vec3<Scalar> center = vec3<Scalar>(0, static_cast<Scalar>(-radius), 0);
    const Errors errors = errors_of(rays, RandomInputs(13), [&](RandomInputs& random, Errors& all) {
        const Trial trial(ground_ray<Scalar>(random, eye, 11), way, center, static_cast<Scalar>(radius));
        if (trial.exact.is_met()) all.add(trial.relative_error());
    });
    return quantile_up_to_one(errors, 0.99);
};

// Ways to make a point of the surface out of a hit.
constexpr auto kAlongRay = [](const Ray<float>& ray, float t, const Vec3<float>&, float) {
    return along<float>(ray.origin, t, ray.direction);
};
constexpr auto kAlwaysReprojected = [](const Ray<float>& ray, float t, const Vec3<float>& center, float radius) {
    return along<float>(center, radius, unit<float>(Vec3<float>(kAlongRay(ray, t, center, radius) - center)));
};
constexpr auto kOurPoint = [](const Ray<float>& ray, float t, const Vec3<float>& center, float radius) {
    return sphere_point<float>(ray, t, center, radius).position;
};
/// Both steps, a distance and its point: how far off the sphere the point is, over the radius.
template <class Distance, class Point>
auto off_sphere(Distance distance, Point point) {
    return [=](const Ray<float>& ray, const Vec3<float>& center, float radius, Errors& errors) {
        const float t = distance(ray.origin, ray.direction, center, radius);
        if (!(t < kInfinity<float>)) return;
        const ExactVec p = ExactVec::of<float>(point(ray, t, center, radius));
        errors.add((p - ExactVec::of<float>(center)).norm() / radius - 1);
    };
}
constexpr auto kFarPoint = []<class Scalar>(const auto& way, double distance, std::int64_t rays) {
    const Vec3<Scalar> center = vec3<Scalar>(0, 0, 0);
    const auto judge = [&](RandomInputs& random, Errors& errors) {
        way(aimed<Scalar>(random, center, 1, distance, random.uniform(0, 1)), center, 1, errors);
    };
    return errors_of(rays, RandomInputs(14), judge).quantile(0.99);
};
constexpr auto kGroundPoint = []<class Scalar>(const auto& way, double radius, std::int64_t rays) {
    const auto r = static_cast<Scalar>(radius);
    const auto judge = [&](RandomInputs& random, Errors& errors) {
        way(ground_ray(random, vec3<Scalar>(1.3F, 0.2F, 0.3F), 1), vec3<Scalar>(0, -r, 0), r, errors);
    };
    return errors_of(rays, RandomInputs(15), judge).quantile(0.99);
};

}  // namespace

CaseMethods sphere_cases() {
    return {{"far-sphere", Methods(kFlips)
                               .naive("half-b, float", kHalfB, timed(kHalfB))
                               .naive("intervals that reject, float", kInterval)
                               .ours("ours, float", kOurs, timed(kOurs))
                               .other("ours, double on float", kDoubleOnFloat)},
            {"far-sphere-distance", Methods(kDistanceError)
                                        .naive("half-b, float", kHalfB)
                                        .ours("ours, float", kOurs)
                                        .other("ours, double on float", kDoubleOnFloat)},
            {"grazing", Methods(kGrazingMisses)
                            .naive("half-b, float", kHalfB)
                            .naive("intervals that reject, float", kInterval)
                            .ours("ours, float", kOurs)
                            .other("ours, double on float", kDoubleOnFloat)},
            {"grazing-distance", Methods(kGrazingDistance)
                                     .naive("half-b, float", kHalfB)
                                     .ours("ours, float", kOurs)
                                     .other("ours, double on float", kDoubleOnFloat)},
            {"ground-sphere", Methods(kGroundDistance)
                                  .naive("half-b, float", kHalfB)
                                  .naive("Haines with f.f - r^2, float", kHaines, timed(kHaines))
                                  .ours("ours, float", kOurs)
                                  .other("ours, double on float", kDoubleOnFloat)},
            {"reprojection", Methods(kFarPoint)
                                 .naive("half-b, along the ray, float", off_sphere(kHalfB, kAlongRay))
                                 .naive("ours, along the ray, float", off_sphere(kOurs, kAlongRay))
                                 .ours("ours, float", off_sphere(kOurs, kOurPoint))},
            {"reprojection-ground", Methods(kGroundPoint)
                                        .naive("always reprojected, float", off_sphere(kOurs, kAlwaysReprojected))
                                        .ours("ours, float", off_sphere(kOurs, kOurPoint))},
            {"far-sphere-double",
             Methods(kFlips).naive<double>("half-b, double", kHalfB).ours<double>("ours, double", kOurs)},
            {"far-sphere-normal",
             Methods(kNormalError).naive<double>("half-b, double", kHalfB).ours<double>("ours, double", kOurs)}};
}

}  // namespace raypool::stability
