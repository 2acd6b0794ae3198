// Rows 3a to 3c: boxes that are flat, met in a face, at a corner or beside a pole.

#include <algorithm>

#include "bench/naive/boxes.h"
#include "bench/stability/case.h"
#include "bench/stability/padded.h"
#include "bench/stability/rays.h"

namespace raypool::stability {

namespace {

template <class Scalar>
struct TestBox {
    Vec3<Scalar> low, high;
};

template <class Scalar>
bool our_box(const Vec3<Scalar>& low, const Vec3<Scalar>& high, const Vec3<Scalar>& origin,
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
}

template <class Scalar>
using BoxTest = bool (*)(const Vec3<Scalar>&, const Vec3<Scalar>&, const Vec3<Scalar>&, const Vec3<Scalar>&);

/// Whether a ray meets a closed box, for whole numbers and directions of -1, 0 and 1: exact.
template <class Scalar>
bool is_met_exactly(const TestBox<Scalar>& box, const Vec3<Scalar>& origin, const Vec3<Scalar>& direction) {
    Scalar enter = 0;
    Scalar exit = 1000;
    for (int i = 0; i < 3; ++i) {
        if (direction[i] == 0) {
            if (origin[i] < box.low[i] || origin[i] > box.high[i]) return false;
            continue;
        }
        const Scalar a = (box.low[i] - origin[i]) * direction[i];
        const Scalar b = (box.high[i] - origin[i]) * direction[i];
        enter = std::max(enter, std::min(a, b));
        exit = std::min(exit, std::max(a, b));
    }
    return enter <= exit;
}

/// Boxes and rays of whole numbers, with so many of the box's edges of length zero: those met that are missed.
template <class Scalar, BoxTest<Scalar> is_met>
double lattice_misses(double flat_axes, std::int64_t boxes) {
    RandomInputs random(31);
    std::int64_t met = 0;
    std::int64_t missed = 0;
    for (std::int64_t i = 0; i < boxes; ++i) {
        const Vec3<Scalar> a = random.lattice_point<Scalar>(1);
        const Vec3<Scalar> b = random.lattice_point<Scalar>(1);
        TestBox<Scalar> box{a.cwiseMin(b), a.cwiseMax(b)};
        for (int k = 0; k < 3; ++k) {
            if (box.low[k] == box.high[k]) box.high[k] += 1;
            if (k < flat_axes) box.high[k] = box.low[k];
        }
        const Vec3<Scalar> origin = random.lattice_point<Scalar>(2);
        const Vec3<Scalar> direction = random.lattice_point<Scalar>(1);
        if (direction.isZero() || !is_met_exactly<Scalar>(box, origin, direction)) continue;
        ++met;
        missed += is_met(box.low, box.high, origin, direction) ? 0 : 1;
    }
    return share(missed, met);
}

/// Rays aimed at corners and edges of boxes from a distance: those that are missed, by rounding.
template <class Scalar, BoxTest<Scalar> is_met>
double edge_misses(double distance, std::int64_t rays) {
    RandomInputs random(32);
    std::int64_t missed = 0;
    for (std::int64_t i = 0; i < rays; ++i) {
        TestBox<Scalar> box;
        box.low = random.point<Scalar>(10);
        box.high = (box.low.array() + Scalar(0.1)).matrix() + random.point<Scalar>(1).cwiseAbs();
        Vec3<double> target;
        const int free_axis = random.below(4);  // 3: none, a corner
        for (int k = 0; k < 3; ++k) {
            const bool is_high = random.one_in(2);
            target[k] = static_cast<double>(is_high ? box.high[k] : box.low[k]);
            if (k == free_axis) target[k] = random.uniform(box.low[k], box.high[k]);
        }
        const Vec3<Scalar> origin = narrow<Scalar>(target + distance * random.direction<double>());
        const Vec3<Scalar> direction = narrow<Scalar>((target - wide<Scalar>(origin)).normalized());
        missed += is_met(box.low, box.high, origin, direction) ? 0 : 1;
    }
    return share(missed, rays);
}

/// The sphere's own box: centre -+ radius, rounded; or ours.
enum class Padding : std::uint8_t { None, Slack, Ours };

/// Rays that pass beside a pole of a sphere, so beside the middle of a face of its box: hits that the box loses.
template <class Scalar, Padding padding>
double pole_misses(double translation, std::int64_t rays) {
    RandomInputs random(33);
    std::vector<Sphere> spheres(static_cast<std::size_t>(std::max<std::int64_t>(rays / 100, 10)));
    for (Sphere& sphere : spheres) {
        sphere.center0 = sphere.center1 = wide<Scalar>(random.point<Scalar>(translation));
        sphere.radius = static_cast<double>(static_cast<Scalar>(random.uniform(0.1, 2)));
    }
    const std::vector<PaddedSphere<Scalar>> padded = padded_spheres<Scalar>(spheres);
    std::int64_t hits = 0;
    std::int64_t lost = 0;
    for (std::int64_t i = 0; i < rays; ++i) {
        const PaddedSphere<Scalar>& sphere =
            padded[static_cast<std::size_t>(random.below(static_cast<int>(padded.size())))];
        const Scalar edge = padding == Padding::Ours ? sphere.padded_radius : sphere.radius;
        const int axis = random.below(3);
        Vec3<double> pole = wide<Scalar>(sphere.center);
        pole[axis] += (random.one_in(2) ? 1 : -1) * static_cast<double>(sphere.radius);
        Vec3<double> aside = random.direction<double>();
        aside[axis] = 0;
        const Vec3<Scalar> origin = narrow<Scalar>(pole + 3 * aside.normalized());
        const Vec3<Scalar> direction = narrow<Scalar>((pole - wide<Scalar>(origin)).normalized());
        const Scalar t = sphere_distance<Scalar>(origin, direction, sphere.center, sphere.radius, false);
        if (!(t < kInfinity<Scalar>)) continue;
        ++hits;
        const Vec3<Scalar> low = (sphere.center.array() - edge).matrix();
        const Vec3<Scalar> high = (sphere.center.array() + edge).matrix();
        const bool is_met = padding == Padding::None ? naive::ordered_box<Scalar>(low, high, origin, direction)
                                                     : our_box<Scalar>(low, high, origin, direction);
        lost += is_met ? 0 : 1;
    }
    return share(lost, hits);
}

/// The clock: a ray against a unit box, one at a time; rays are made anew from the call's number.
template <BoxTest<float> is_met>
double time_box(std::int64_t calls) {
    RandomInputs random(34);
    std::vector<Ray<float>> rays(256);
    for (Ray<float>& ray : rays) ray = {random.point<float>(3), random.direction<float>(), 0};
    const Vec3<float> low = vec3<float>(-1, -1, -1);
    const Vec3<float> high = vec3<float>(1, 1, 1);
    std::int64_t met = 0;
    for (std::int64_t i = 0; i < calls; ++i) {
        const Ray<float>& ray = rays[static_cast<std::size_t>(i) % rays.size()];
        met += is_met(low, high, ray.origin, ray.direction) ? 1 : 0;
    }
    return static_cast<double>(met);
}

}  // namespace

std::vector<Case> box_cases() {
    std::vector<Case> cases;
    cases.push_back(
        {.id = "flat-box",
         .row = "3a",
         .parameter = "edges of length zero",
         .values = {0, 1, 2, 3},
         .measure = "boxes met that are missed, share",
         .tolerance = 0,
         .symptom = "walls and floors vanish for rays along the axes",
         .samples = 100'000,
         .methods = {{"max <= min misses, float", Kind::Naive, lattice_misses<float, naive::book_box<float>>,
                      time_box<naive::book_box<float>>},
                     {"fmin and fmax, float", Kind::Naive, lattice_misses<float, naive::fmin_box<float>>,
                      time_box<naive::fmin_box<float>>},
                     {"clamped reciprocal, float", Kind::Naive, lattice_misses<float, naive::clamped_box<float>>,
                      time_box<naive::clamped_box<float>>},
                     {"ours, float", Kind::Ours, lattice_misses<float, our_box<float>>, time_box<our_box<float>>},
                     {"ours, double", Kind::Ours, lattice_misses<double, our_box<double>>}}});
    cases.push_back({.id = "box-edge",
                     .row = "3b",
                     .parameter = "distance of the ray's origin",
                     .values = {1e0, 1e1, 1e2, 1e3},
                     .measure = "rays at corners and edges that are missed, share",
                     .tolerance = 0,
                     .symptom = "holes along the edges of boxes in the tree",
                     .samples = 100'000,
                     .methods = {{"ordered, no slack, float", Kind::Naive,
                                  edge_misses<float, naive::ordered_box<float>>, time_box<naive::ordered_box<float>>},
                                 {"fused, no slack, float", Kind::Naive, edge_misses<float, naive::fused_box<float>>,
                                  time_box<naive::fused_box<float>>},
                                 {"ours, float", Kind::Ours, edge_misses<float, our_box<float>>},
                                 {"ours, double", Kind::Ours, edge_misses<double, our_box<double>>}}});
    cases.push_back({.id = "sphere-pole",
                     .row = "3c",
                     .parameter = "distance from the origin",
                     .values = {1e0, 1e1, 1e2, 1e3},
                     .measure = "hits beside a pole that the sphere's box loses, share",
                     .tolerance = 0,
                     .symptom = "single pixels missing where a sphere touches its box",
                     .samples = 100'000,
                     .methods = {{"centre -+ radius, rounded, float", Kind::Naive, pole_misses<float, Padding::None>},
                                 {"the same with our slack, float", Kind::Naive, pole_misses<float, Padding::Slack>},
                                 {"ours, float", Kind::Ours, pole_misses<float, Padding::Ours>},
                                 {"ours, double", Kind::Ours, pole_misses<double, Padding::Ours>}}});
    return cases;
}

}  // namespace raypool::stability
