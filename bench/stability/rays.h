/// Rays and surface points that the cases about shapes start from: aimed at a sphere with a given miss distance, at a
/// surface point as the engines compute it, and packets of both for the clock.
#pragma once

#include <vector>

#include "bench/stability/methods.h"
#include "core/geometry/shapes.h"
#include "core/shading/shade.h"
#include "tests/core/geometry/aimed_ray.h"
#include "tests/core/geometry/exact_sphere.h"

namespace raypool::stability {

using test::aimed;
using test::ExactSphere;
using test::ExactVec;
using test::Float128;
using test::narrow;
using test::perpendicular;
using test::wide;

/// As many rays at a time as a register holds: what methods are timed with.
using Packet = Wide<float, static_cast<int>(stdx::native_simd<float>::size())>;

/// Where a ray meets a sphere, as the engines compute it.
template <class Scalar>
SurfacePoint<Scalar> sphere_point(const Ray<Scalar>& ray, Scalar t, const Vec3<Scalar>& center, Scalar radius) {
    const Scalar row[16] = {center[0], center[1], center[2], radius};
    return surface_point<Features{}, Scalar>(ray, t, row);
}

/// A surface point that a ray from 10 radii away meets.
template <class Scalar>
SurfacePoint<Scalar> seen_point(RandomInputs& random, const Vec3<Scalar>& center, Scalar radius) {
    for (;;) {
        const Ray<Scalar> ray = aimed<Scalar>(random, center, radius, 10.0 * radius, random.uniform(0, 1));
        const Scalar t = sphere_distance<Scalar>(ray.origin, ray.direction, center, radius, false);
        if (t < kInfinity<Scalar>) return sphere_point<Scalar>(ray, t, center, radius);
    }
}

/// The sum over all lanes and calls of what `test(origin, direction)` gives for packets of rays around a unit sphere at
/// the origin, `calls` rays in all. Infinite distances are cut, so that the sum depends on every call.
template <class Test>
double time_rays(std::int64_t calls, Test test) {
    constexpr int kPackets = 64;
    constexpr int kLanesOf = kLanes<Packet>;
    static const std::vector<Ray<Packet>> kPrepared = [] {
        RandomInputs random(77);
        std::vector<Ray<Packet>> all(kPackets);
        for (Ray<Packet>& packet : all)
            for (int lane = 0; lane < kLanesOf; ++lane) {
                const Ray<float> ray =
                    aimed<float>(random, vec3<float>(0, 0, 0), 1, random.uniform(2, 20), random.uniform(0, 2));
                for (int i = 0; i < 3; ++i) {
                    packet.origin[i][lane] = ray.origin[i];
                    packet.direction[i][lane] = ray.direction[i];
                }
            }
        return all;
    }();
    Packet sum(0);
    for (std::int64_t i = 0; i < calls / kLanesOf; ++i) {
        const Ray<Packet>& ray = kPrepared[static_cast<std::size_t>(i % kPackets)];
        sum += min(test(ray.origin, ray.direction), Packet(1));
    }
    double total = 0;
    for (int lane = 0; lane < kLanesOf; ++lane) total += raypool::lane(sum, lane);
    return total;
}

}  // namespace raypool::stability
