// Rows 3a to 3c: boxes that are flat, met in a face, at a corner or beside a pole.

#include <algorithm>

#include "bench/naive/boxes.h"
#include "bench/stability/case.h"
#include "bench/stability/padded.h"
#include "bench/stability/rays.h"

namespace raypool::stability {

namespace {

constexpr auto kOurs = []<class Scalar>(const Vec3<Scalar>& low, const Vec3<Scalar>& high, const Vec3<Scalar>& origin,
                                        const Vec3<Scalar>& direction) {
    const RayInverse<Scalar> inverse = ray_inverse<Scalar>(direction);
    Vec3<Scalar> near;
    Vec3<Scalar> far;
    for (int i = 0; i < 3; ++i) {
        near[i] = inverse.is_negative[i] ? high[i] : low[i];
        far[i] = inverse.is_negative[i] ? low[i] : high[i];
    }
    const Interval<Scalar> inside = box_interval<Scalar>(near, far, origin, inverse, kInfinity<Scalar>);
    return inside.enter <= inside.exit;
};

/// Whether a ray meets a closed box, for whole numbers and directions of -1, 0 and 1: exact.
template <class Scalar>
bool is_met_exactly(const Vec3<Scalar>& low, const Vec3<Scalar>& high, const Vec3<Scalar>& origin,
                    const Vec3<Scalar>& direction) {
    Scalar enter = 0;
    Scalar exit = 1000;
    for (int i = 0; i < 3; ++i) {
        if (direction[i] == 0) {
            if (origin[i] < low[i] || origin[i] > high[i]) return false;
            continue;
        }
        const Scalar a = (low[i] - origin[i]) * direction[i];
        const Scalar b = (high[i] - origin[i]) * direction[i];
        enter = std::max(enter, std::min(a, b));
        exit = std::min(exit, std::max(a, b));
    }
    return enter <= exit;
}

/// Boxes and rays of whole numbers, with so many of the box's edges of length zero: those met that are missed.
constexpr auto kLatticeMisses = []<class Scalar>(const auto& is_met, double flat_axes, std::int64_t boxes) {
    return share_of(boxes, RandomInputs(31), [&](RandomInputs& random) -> std::optional<bool> {
        const Vec3<Scalar> a = random.lattice_point<Scalar>(1);
        const Vec3<Scalar> b = random.lattice_point<Scalar>(1);
        const Vec3<Scalar> low = a.cwiseMin(b);
        Vec3<Scalar> high = a.cwiseMax(b);
        for (int k = 0; k < 3; ++k) {
            if (low[k] == high[k]) high[k] += 1;
            if (k < flat_axes) high[k] = low[k];
        }
        const Vec3<Scalar> origin = random.lattice_point<Scalar>(2);
        const Vec3<Scalar> direction = random.lattice_point<Scalar>(1);
        if (direction.isZero() || !is_met_exactly(low, high, origin, direction)) return {};
        return !is_met(low, high, origin, direction);
    });
};

/// Rays aimed at corners and edges of boxes from a distance: those that are missed, by rounding.
constexpr auto kEdgeMisses = []<class Scalar>(const auto& is_met, double distance, std::int64_t rays) {
    return share_of(rays, RandomInputs(32), [&](RandomInputs& random) {
        const Vec3<Scalar> low = random.point<Scalar>(10);
        const Vec3<Scalar> high = (low.array() + Scalar(0.1)).matrix() + random.point<Scalar>(1).cwiseAbs();
        Vec3<double> target;
        const int free_axis = random.below(4);  // 3: none, a corner
        for (int k = 0; k < 3; ++k) {
            target[k] = static_cast<double>(random.one_in(2) ? high[k] : low[k]);
            if (k == free_axis) target[k] = random.uniform(low[k], high[k]);
        }
        const Vec3<Scalar> origin = narrow<Scalar>(target + distance * random.direction<double>());
        const Vec3<Scalar> direction = narrow<Scalar>((target - wide<Scalar>(origin)).normalized());
        return !is_met(low, high, origin, direction);
    });
};

/// A test of the box from the centre of a sphere to its radius, or to our padded one, on both sides.
template <class Test>
auto around_sphere(Test is_met, bool is_padded) {
    return [=](const auto& sphere, const auto& origin, const auto& direction) {
        const auto edge = is_padded ? sphere.padded_radius : sphere.radius;
        const std::decay_t<decltype(origin)> low = (sphere.center.array() - edge).matrix();
        const std::decay_t<decltype(origin)> high = (sphere.center.array() + edge).matrix();
        return is_met(low, high, origin, direction);
    };
}
/// Rays that pass beside a pole of a sphere, so beside the middle of a face of its box: hits that the box loses.
constexpr auto kPoleMisses = []<class Scalar>(const auto& is_met, double translation, std::int64_t rays) {
    RandomInputs inputs(33);
    std::vector<Sphere> spheres(static_cast<std::size_t>(std::max<std::int64_t>(rays / 100, 10)));
    for (Sphere& sphere : spheres) {
        sphere.center0 = sphere.center1 = wide<Scalar>(inputs.point<Scalar>(translation));
        sphere.radius = static_cast<double>(static_cast<Scalar>(inputs.uniform(0.1, 2)));
    }
    const std::vector<PaddedSphere<Scalar>> padded = padded_spheres<Scalar>(spheres);
    return share_of(rays, inputs, [&](RandomInputs& random) -> std::optional<bool> {
        const PaddedSphere<Scalar>& sphere = any_of(padded, random);
        const int axis = random.below(3);
        Vec3<double> pole = wide<Scalar>(sphere.center);
        pole[axis] += (random.one_in(2) ? 1 : -1) * static_cast<double>(sphere.radius);
        Vec3<double> aside = random.direction<double>();
        aside[axis] = 0;
        const Vec3<Scalar> origin = narrow<Scalar>(pole + 3 * aside.normalized());
        const Vec3<Scalar> direction = narrow<Scalar>((pole - wide<Scalar>(origin)).normalized());
        const Scalar t = sphere_distance<Scalar>(origin, direction, sphere.center, sphere.radius, false);
        if (!(t < kInfinity<Scalar>)) return {};
        return !is_met(sphere, origin, direction);
    });
};

/// The clock: a ray against a box with edges of 2, one at a time.
template <class Test>
auto timed(Test is_met) {
    return [is_met](std::int64_t calls) {
        RandomInputs random(34);
        std::vector<Ray<float>> rays(256);
        for (Ray<float>& ray : rays) ray = {random.point<float>(3), random.direction<float>(), 0};
        const Vec3<float> low = vec3<float>(-1, -1, -1);
        const Vec3<float> high = vec3<float>(1, 1, 1);
        return sum_over(rays, calls, [&](const auto& ray) { return is_met(low, high, ray.origin, ray.direction); });
    };
}

}  // namespace

CaseMethods box_cases() {
    constexpr auto kBook = [](const auto&... box_and_ray) { return naive::book_box(box_and_ray...); };
    constexpr auto kFmin = [](const auto&... box_and_ray) { return naive::fmin_box(box_and_ray...); };
    constexpr auto kClamped = [](const auto&... box_and_ray) { return naive::clamped_box(box_and_ray...); };
    constexpr auto kOrdered = [](const auto&... box_and_ray) { return naive::ordered_box(box_and_ray...); };
    constexpr auto kFused = [](const auto&... box_and_ray) { return naive::fused_box(box_and_ray...); };
    return {{"flat-box", Methods(kLatticeMisses)
                             .naive("max <= min misses, float", kBook, timed(kBook))
                             .naive("fmin and fmax, float", kFmin, timed(kFmin))
                             .naive("clamped reciprocal, float", kClamped, timed(kClamped))
                             .ours_in_both(kOurs, timed(kOurs))},
            {"box-edge", Methods(kEdgeMisses)
                             .naive("ordered, no slack, float", kOrdered, timed(kOrdered))
                             .naive("fused, no slack, float", kFused, timed(kFused))
                             .ours_in_both(kOurs)},
            {"sphere-pole", Methods(kPoleMisses)
                                .naive("centre -+ radius, rounded, float", around_sphere(kOrdered, false))
                                .naive("the same with our slack, float", around_sphere(kOurs, false))
                                .ours_in_both(around_sphere(kOurs, true))}};
}

}  // namespace raypool::stability
