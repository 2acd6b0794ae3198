/// Rays and surface points that the cases about shapes start from: aimed at a sphere with a given miss distance, at a
/// surface point as the engines compute it.
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

}  // namespace raypool::stability
