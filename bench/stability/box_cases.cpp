// Rows 3a to 3c: boxes that are flat, met in a face, at a corner or beside a pole.

#include <algorithm>
#include <cmath>

#include "bench/stability/case.h"
#include "bench/stability/padded.h"
#include "bench/stability/rays.h"

namespace raypool::stability {

namespace {

// Ways to tell whether a ray meets the closed box [low, high]; a component of the direction may be zero.
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

/// The other ways: clip(low, high, origin, direction, inside) cuts the part of the ray that is `inside` to what lies
/// between the box's two faces along an axis, and tells whether the next axis is worth a look.
template <class Clip>
constexpr auto slab_test(Clip clip) {
    return [clip]<class Scalar>(const Vec3<Scalar>& low, const Vec3<Scalar>& high, const Vec3<Scalar>& origin,
                                const Vec3<Scalar>& direction) {
        Interval<Scalar> inside{0, kInfinity<Scalar>};
        for (int i = 0; i < 3; ++i)
            if (!clip(low[i], high[i], origin[i], direction[i], inside)) return false;
        return inside.enter <= inside.exit;
    };
}
/// "Ray Tracing: The Next Week", chapter 3.5: an interval of length zero is a miss, so flat boxes and rays within a
/// face vanish; comparisons see NaN where a ray runs in a face.
constexpr auto kBook =
    slab_test([]<class Scalar>(Scalar low, Scalar high, Scalar origin, Scalar direction, Interval<Scalar>& inside) {
        const Scalar inverse = 1 / direction;
        Scalar t0 = (low - origin) * inverse;
        Scalar t1 = (high - origin) * inverse;
        if (inverse < 0) std::swap(t0, t1);
        inside = {t0 > inside.enter ? t0 : inside.enter, t1 < inside.exit ? t1 : inside.exit};
        return inside.exit > inside.enter;
    });
/// Near and far by fmin and fmax, which drop a NaN and so turn "in the face" into "infinitely far".
constexpr auto kFmin =
    slab_test([]<class Scalar>(Scalar low, Scalar high, Scalar origin, Scalar direction, Interval<Scalar>& inside) {
        const Scalar inverse = 1 / direction;
        const Scalar t0 = (low - origin) * inverse;
        const Scalar t1 = (high - origin) * inverse;
        inside = {std::fmax(inside.enter, std::fmin(t0, t1)), std::fmin(inside.exit, std::fmax(t0, t1))};
        return true;
    });
/// No division by zero: a small number in its place, which moves rays that run beside or in a face.
constexpr auto kClamped =
    slab_test([]<class Scalar>(Scalar low, Scalar high, Scalar origin, Scalar direction, Interval<Scalar>& inside) {
        const Scalar d = std::abs(direction) < Scalar(1e-8) ? Scalar(1e-8) : direction;
        const Scalar t0 = (low - origin) / d;
        const Scalar t1 = (high - origin) / d;
        inside = {std::max(inside.enter, std::min(t0, t1)), std::min(inside.exit, std::max(t0, t1))};
        return inside.exit > inside.enter;
    });
/// Near and far by the sign of the direction, as ours, but without slack for rounding.
constexpr auto kOrdered =
    slab_test([]<class Scalar>(Scalar low, Scalar high, Scalar origin, Scalar direction, Interval<Scalar>& inside) {
        const Scalar inverse = 1 / direction;
        if (std::signbit(direction)) std::swap(low, high);
        inside = {max((low - origin) * inverse, inside.enter), min((high - origin) * inverse, inside.exit)};
        return true;
    });
/// The same with bound / d - origin / d in one fused operation: the rounded origin / d moves each plane.
constexpr auto kFused =
    slab_test([]<class Scalar>(Scalar low, Scalar high, Scalar origin, Scalar direction, Interval<Scalar>& inside) {
        const Scalar inverse = 1 / direction;
        const Scalar shift = -(origin * inverse);
        if (std::signbit(direction)) std::swap(low, high);
        inside = {max(std::fma(low, inverse, shift), inside.enter), min(std::fma(high, inverse, shift), inside.exit)};
        return true;
    });
/// For whole numbers and directions of -1, 0 and 1: exact.
constexpr auto kExact =
    slab_test([]<class Scalar>(Scalar low, Scalar high, Scalar origin, Scalar direction, Interval<Scalar>& inside) {
        if (direction == 0) return origin >= low && origin <= high;
        const Scalar a = (low - origin) * direction;
        const Scalar b = (high - origin) * direction;
        inside = {std::max(inside.enter, std::min(a, b)), std::min(inside.exit, std::max(a, b))};
        return true;
    });

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
        if (direction.isZero() || !kExact(low, high, origin, direction)) return {};
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
    const auto draw = [](RandomInputs& random) {
        const Vec3<float> origin = random.point<float>(3);
        return Ray<float>{origin, random.direction<float>(), 0};
    };
    return sum_over(RandomInputs(34), draw, [=](const Ray<float>& ray) {
        return is_met(vec3<float>(-1, -1, -1), vec3<float>(1, 1, 1), ray.origin, ray.direction);
    });
}

}  // namespace

CaseMethods box_cases() {
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
