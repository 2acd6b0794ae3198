// Rows 1a to 1e: far, grazing and huge spheres, and where their hits are put.

#include <algorithm>

#include "bench/naive/spheres.h"
#include "bench/stability/case.h"
#include "bench/stability/rays.h"

namespace raypool::stability {

namespace {

struct HalfB {
    template <class Real>
    static Real distance(const Vec3<Real>& o, const Vec3<Real>& d, const Vec3<Real>& center, const Real& radius) {
        return naive::half_b_distance<Real>(o, d, center, radius, Real(0));
    }
};
struct Interval {
    template <class Real>
    static Real distance(const Vec3<Real>& o, const Vec3<Real>& d, const Vec3<Real>& center, const Real& radius) {
        return naive::interval_distance<Real>(o, d, center, radius, Real(0));
    }
};
struct Haines {
    template <class Real>
    static Real distance(const Vec3<Real>& o, const Vec3<Real>& d, const Vec3<Real>& center, const Real& radius) {
        return naive::haines_distance<Real>(o, d, center, radius, Real(0));
    }
};
struct Ours {
    template <class Real>
    static Real distance(const Vec3<Real>& o, const Vec3<Real>& d, const Vec3<Real>& center, const Real& radius) {
        return sphere_distance<Real>(o, d, center, radius, Mask<Real>(false));
    }
};

/// The sphere is read from memory: a compiler that knew it would fold half of the test away.
template <class Test>
double time_test(std::int64_t calls) {
    static volatile float coordinate = 0;
    static volatile float radius = 1;
    const Vec3<Packet> center = Vec3<Packet>::Constant(Packet(coordinate));
    const Packet r(radius);
    return time_rays(calls, [&](const Vec3<Packet>& o, const Vec3<Packet>& d) {
        return Test::template distance<Packet>(o, d, center, r);
    });
}

/// A hit as `Test` finds it in Compute, for a ray and a sphere whose numbers are Input.
template <class Input, class Compute, class Test>
Compute found(const Ray<Input>& ray, const Vec3<Input>& center, Input radius) {
    return Test::template distance<Compute>(ray.origin.template cast<Compute>(), ray.direction.template cast<Compute>(),
                                            center.template cast<Compute>(), static_cast<Compute>(radius));
}

/// What became of rays whose lines pass a unit sphere at 0 to 2 radii.
struct Judgement {
    std::int64_t misses = 0;  ///< false ones
    std::int64_t hits = 0;    ///< false ones
    Errors distance;          ///< of the true hits, relative
    Errors normal;            ///< of the true hits, radians
};
template <class Input, class Compute, class Test>
Judgement judge(double distance, std::int64_t rays) {
    RandomInputs random(11);
    Judgement judgement;
    const Vec3<Input> center = vec3<Input>(0, 0, 0);
    for (std::int64_t i = 0; i < rays; ++i) {
        const Ray<Input> ray = aimed<Input>(random, center, 1, distance, random.uniform(0, 2));
        const ExactSphere exact(ray.origin, ray.direction, center, Input(1));
        const Compute t = found<Input, Compute, Test>(ray, center, 1);
        const bool is_hit = t < kInfinity<Compute>;
        judgement.misses += exact.is_met() && !is_hit ? 1 : 0;
        judgement.hits += !exact.is_met() && is_hit ? 1 : 0;
        if (!exact.is_met() || !is_hit) continue;
        judgement.distance.add((t - exact.first) / exact.first);
        const auto point = [&](Float128 at) {
            const ExactVec p = ExactVec::of<Input>(ray.origin) + at * ExactVec::of<Input>(ray.direction);
            return Vec3<double>(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
        };
        judgement.normal.add((point(t) - point(exact.first)).norm());
    }
    return judgement;
}

template <class Input, class Compute, class Test>
double flips(double distance, std::int64_t rays) {
    const Judgement judgement = judge<Input, Compute, Test>(distance, rays);
    return share(judgement.misses + judgement.hits, rays);
}
/// The error that one hit in a hundred exceeds; 1 where nothing was hit.
template <class Input, class Compute, class Test>
double distance_error(double distance, std::int64_t rays) {
    const Errors errors = judge<Input, Compute, Test>(distance, rays).distance;
    return errors.count() == 0 ? 1 : std::min(errors.quantile(0.99), 1.0);
}
template <class Input, class Compute, class Test>
double normal_error(double distance, std::int64_t rays) {
    const Errors errors = judge<Input, Compute, Test>(distance, rays).normal;
    return errors.count() == 0 ? 1 : errors.quantile(0.99);
}

/// Rays that pass the centre of a unit sphere, 10 away, at the radius less a part: those missed, and what is wrong of
/// the others' distance.
struct Grazing {
    std::int64_t rays = 0;
    std::int64_t missed = 0;
    Errors distance;
};
template <class Input, class Compute, class Test>
Grazing graze(double part, std::int64_t rays) {
    RandomInputs random(12);
    Grazing grazing;
    const Vec3<Input> center = vec3<Input>(0, 0, 0);
    for (std::int64_t i = 0; i < rays; ++i) {
        const Ray<Input> ray = aimed<Input>(random, center, 1, 10, 1 - part);
        const ExactSphere exact(ray.origin, ray.direction, center, Input(1));
        // The direction was rounded: take the rays that still graze by about that part.
        if (std::abs(1 - static_cast<double>(exact.impact) - part) > 0.5 * part) continue;
        ++grazing.rays;
        const Compute t = found<Input, Compute, Test>(ray, center, 1);
        if (t < kInfinity<Compute>) {
            grazing.distance.add((t - exact.first) / exact.first);
        } else {
            ++grazing.missed;
        }
    }
    return grazing;
}
template <class Input, class Compute, class Test>
double grazing_misses(double part, std::int64_t rays) {
    const Grazing grazing = graze<Input, Compute, Test>(part, rays);
    return share(grazing.missed, grazing.rays);
}
template <class Input, class Compute, class Test>
double grazing_distance(double part, std::int64_t rays) {
    const Grazing grazing = graze<Input, Compute, Test>(part, rays);
    return grazing.distance.count() == 0 ? 1 : std::min(grazing.distance.max(), 1.0);
}

/// The ground, a sphere whose top is the origin, seen from (13, 2, 3).
template <class Input, class Compute, class Test>
double ground_distance(double radius, std::int64_t rays) {
    RandomInputs random(13);
    const Vec3<Input> eye = vec3<Input>(13, 2, 3);
    const Vec3<Input> center = vec3<Input>(0, static_cast<Input>(-radius), 0);
    Errors errors;
    for (std::int64_t i = 0; i < rays; ++i) {
        Vec3<double> target = random.point<double>(11);
        target[1] = 0;
        const Ray<Input> ray{eye, narrow<Input>((target - wide<Input>(eye)).normalized()), 0};
        const ExactSphere exact(eye, ray.direction, center, static_cast<Input>(radius));
        if (!exact.is_met()) continue;
        const Compute t = found<Input, Compute, Test>(ray, center, static_cast<Input>(radius));
        errors.add((t - exact.first) / exact.first);
    }
    return std::min(errors.quantile(0.99), 1.0);
}

/// How a hit becomes a point of the surface.
struct AlongRay {
    static Vec3<float> point(const Ray<float>& ray, float t, const Vec3<float>&, float) {
        return along<float>(ray.origin, t, ray.direction);
    }
};
struct AlwaysReprojected {
    static Vec3<float> point(const Ray<float>& ray, float t, const Vec3<float>& center, float radius) {
        const Vec3<float> p = along<float>(ray.origin, t, ray.direction);
        return along<float>(center, radius, unit<float>(Vec3<float>(p - center)));
    }
};
struct OurPoint {
    static Vec3<float> point(const Ray<float>& ray, float t, const Vec3<float>& center, float radius) {
        return sphere_point<float>(ray, t, center, radius).position;
    }
};

/// How far off the sphere the point is, over the radius.
double off_sphere(const Vec3<float>& p, const Vec3<float>& center, float radius) {
    const Float128 distance = (ExactVec::of<float>(p) - ExactVec::of<float>(center)).norm();
    return std::abs(static_cast<double>(distance / radius - 1));
}
template <class Test, class Point>
double far_point(double distance, std::int64_t rays) {
    RandomInputs random(14);
    const Vec3<float> center = vec3<float>(0, 0, 0);
    Errors errors;
    for (std::int64_t i = 0; i < rays; ++i) {
        const Ray<float> ray = aimed<float>(random, center, 1, distance, random.uniform(0, 1));
        const float t = found<float, float, Test>(ray, center, 1.0F);
        if (t < kInfinity<float>) errors.add(off_sphere(Point::point(ray, t, center, 1), center, 1));
    }
    return errors.quantile(0.99);
}
template <class Point>
double ground_point(double radius, std::int64_t rays) {
    RandomInputs random(15);
    const auto r = static_cast<float>(radius);
    const Vec3<float> eye = vec3<float>(1.3F, 0.2F, 0.3F);
    const Vec3<float> center = vec3<float>(0, -r, 0);
    Errors errors;
    for (std::int64_t i = 0; i < rays; ++i) {
        Vec3<double> target = random.point<double>(1);
        target[1] = 0;
        const Ray<float> ray{eye, narrow<float>((target - wide<float>(eye)).normalized()), 0};
        const float t = found<float, float, Ours>(ray, center, r);
        if (t < kInfinity<float>) errors.add(off_sphere(Point::point(ray, t, center, r), center, r));
    }
    return errors.quantile(0.99);
}

}  // namespace

std::vector<Case> sphere_cases() {
    const std::vector<double> distances{1e1, 1e2, 1e3, 1e4, 1e5, 1e6};
    std::vector<Case> cases;
    cases.push_back({.id = "far-sphere",
                     .row = "1a",
                     .parameter = "distance / radius",
                     .values = distances,
                     .measure = "rays that miss or hit falsely, share",
                     .tolerance = 0,
                     .symptom = "far spheres fray, swell or vanish",
                     .samples = 20'000,
                     .methods = {{"half-b, float", Kind::Naive, flips<float, float, HalfB>, time_test<HalfB>},
                                 {"intervals that reject, float", Kind::Naive, flips<float, float, Interval>},
                                 {"ours, float", Kind::Ours, flips<float, float, Ours>, time_test<Ours>},
                                 {"ours, double on float", Kind::Alternative, flips<float, double, Ours>}},
                     .held = 3,
                     .limit = "a direction rounded to float misses its aim by a part of the radius"});
    cases.push_back({.id = "far-sphere-distance",
                     .row = "1a",
                     .parameter = "distance / radius",
                     .values = distances,
                     .measure = "distance to the hit, relative error that 1 % exceed",
                     .tolerance = 4e-7,
                     .symptom = "far spheres are shaded with wrong normals",
                     .samples = 20'000,
                     .methods = {{"half-b, float", Kind::Naive, distance_error<float, float, HalfB>},
                                 {"ours, float", Kind::Ours, distance_error<float, float, Ours>},
                                 {"ours, double on float", Kind::Alternative, distance_error<float, double, Ours>}}});
    cases.push_back({.id = "grazing",
                     .row = "1b",
                     .parameter = "part of the radius inside the edge",
                     .values = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6},
                     .measure = "true hits that are missed, share",
                     .tolerance = 0,
                     .symptom = "silhouettes lose their edge",
                     .samples = 20'000,
                     .methods = {{"half-b, float", Kind::Naive, grazing_misses<float, float, HalfB>},
                                 {"intervals that reject, float", Kind::Naive, grazing_misses<float, float, Interval>},
                                 {"ours, float", Kind::Ours, grazing_misses<float, float, Ours>},
                                 {"ours, double on float", Kind::Alternative, grazing_misses<float, double, Ours>}}});
    cases.push_back({.id = "grazing-distance",
                     .row = "1b",
                     .parameter = "part of the radius inside the edge",
                     .values = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6},
                     .measure = "distance to the hit, greatest relative error",
                     .tolerance = 5e-5,
                     .symptom = "edges are shaded with wrong normals",
                     .samples = 20'000,
                     .methods = {{"half-b, float", Kind::Naive, grazing_distance<float, float, HalfB>},
                                 {"ours, float", Kind::Ours, grazing_distance<float, float, Ours>},
                                 {"ours, double on float", Kind::Alternative, grazing_distance<float, double, Ours>}}});
    cases.push_back({.id = "ground-sphere",
                     .row = "1c",
                     .parameter = "radius of the ground",
                     .values = {1e1, 1e2, 1e3, 1e4, 1e5, 1e6},
                     .measure = "distance to the hit, relative error that 1 % exceed",
                     .tolerance = 1e-5,
                     .symptom = "the ground breaks into steps; shadows and checkers shift",
                     .samples = 20'000,
                     .methods = {{"half-b, float", Kind::Naive, ground_distance<float, float, HalfB>},
                                 {"Haines with f.f - r^2, float", Kind::Naive, ground_distance<float, float, Haines>,
                                  time_test<Haines>},
                                 {"ours, float", Kind::Ours, ground_distance<float, float, Ours>},
                                 {"ours, double on float", Kind::Alternative, ground_distance<float, double, Ours>}}});
    cases.push_back({.id = "reprojection",
                     .row = "1d",
                     .parameter = "distance / radius",
                     .values = {1, 1e1, 1e2, 1e3, 1e4},
                     .measure = "hit off the sphere over the radius, that 1 % exceed",
                     .tolerance = 1.5e-7,
                     .symptom = "bounces start inside or above the surface: acne, leaks",
                     .samples = 20'000,
                     .methods = {{"half-b, along the ray, float", Kind::Naive, far_point<HalfB, AlongRay>},
                                 {"ours, along the ray, float", Kind::Naive, far_point<Ours, AlongRay>},
                                 {"ours, float", Kind::Ours, far_point<Ours, OurPoint>}}});
    cases.push_back({.id = "reprojection-ground",
                     .row = "1d",
                     .parameter = "radius of the ground",
                     .values = {1e1, 1e2, 1e3},
                     .measure = "hit off the sphere over the radius, that 1 % exceed",
                     .tolerance = 6e-8,
                     .symptom = "what stands on a huge ground floats or sinks",
                     .samples = 20'000,
                     .methods = {{"always reprojected, float", Kind::Naive, ground_point<AlwaysReprojected>},
                                 {"ours, float", Kind::Ours, ground_point<OurPoint>}}});
    cases.push_back({.id = "far-sphere-double",
                     .row = "1e",
                     .parameter = "distance / radius",
                     .values = {1e3, 1e4, 1e5, 1e6, 1e7},
                     .measure = "rays that miss or hit falsely, share",
                     .tolerance = 0,
                     .symptom = "double moves the failure away, no more",
                     .samples = 20'000,
                     .methods = {{"half-b, double", Kind::Naive, flips<double, double, HalfB>},
                                 {"ours, double", Kind::Ours, flips<double, double, Ours>}}});
    cases.push_back({.id = "far-sphere-normal",
                     .row = "1e",
                     .parameter = "distance / radius",
                     .values = {1e3, 1e4, 1e5, 1e6, 1e7},
                     .measure = "error of the normal, radians, that 1 % exceed",
                     .tolerance = 1e-8,
                     .symptom = "far spheres are shaded with wrong normals",
                     .samples = 20'000,
                     .methods = {{"half-b, double", Kind::Naive, normal_error<double, double, HalfB>},
                                 {"ours, double", Kind::Ours, normal_error<double, double, Ours>}}});
    return cases;
}

}  // namespace raypool::stability
