/// Random rays for walks through trees, one by one and a register at a time.
#pragma once

#include <algorithm>
#include <vector>

#include "core/shading/compiled_scene.h"
#include "tests/random_inputs.h"
#include "wavefront/stream.h"

namespace raypool::wavefront {

template <class Scalar>
using Native = Wide<Scalar, stdx::native_simd<Scalar>::size()>;

template <class Scalar>
struct StartedRay {
    Ray<Scalar> ray;
    std::int32_t leaving_id;
};

template <class Scalar>
Hit<Scalar> single_hit(const CompiledScene<Scalar>& scene, const StartedRay<Scalar>& start) {
    NoTestCount work;
    return closest_hit<kEverything>(scene, start.ray, start.leaving_id, work);
}

/// From anywhere, or, half of them, from where a ray before hit something. One in four along an axis.
template <class Scalar>
std::vector<StartedRay<Scalar>> random_rays(const CompiledScene<Scalar>& scene, std::size_t count,
                                            test::RandomInputs& random) {
    std::vector<StartedRay<Scalar>> rays;
    while (rays.size() < count) {
        const bool is_on_lattice = random.one_in(2);
        StartedRay<Scalar> start;
        start.ray.origin = is_on_lattice ? random.lattice_point<Scalar>(6) : random.point<Scalar>(9);
        start.ray.direction = random.direction<Scalar>();
        if (random.one_in(4)) {
            start.ray.direction = random.lattice_point<Scalar>(0);  // zeros of either sign
            const int axis = random.below(3);
            start.ray.direction[axis] = random.one_in(2) ? 1 : -1;
        }
        start.ray.time = random.unit_interval<Scalar>();
        start.leaving_id = kNoPrimitive;
        if (!rays.empty() && random.one_in(2)) {
            const Ray<Scalar>& before = rays.back().ray;
            const Hit<Scalar> hit = single_hit(scene, rays.back());
            if (hit.primitive_id != kNoPrimitive) {
                start.ray.origin = along<Scalar>(before.origin, hit.t, before.direction);
                start.ray.time = before.time;
                start.leaving_id = static_cast<std::int32_t>(hit.primitive_id);
            }
        }
        rays.push_back(start);
    }
    return rays;
}

template <class V>
void set_lane(V& v, int i, auto value) {
    if constexpr (Simd<V>) {
        v[i] = static_cast<typename V::value_type>(value);
    } else {
        v = static_cast<V>(value);
    }
}

/// Rays first, first + 1, ... by lane; the last ray again in lanes beyond it.
template <class Real>
WideRays<Real> gather(const std::vector<StartedRay<ScalarOf<Real>>>& rays, std::size_t first) {
    WideRays<Real> wide;
    for (int i = 0; i < kLanes<Real>; ++i) {
        const auto& start = rays[std::min(first + static_cast<std::size_t>(i), rays.size() - 1)];
        for (int k = 0; k < 3; ++k) {
            set_lane(wide.ray.origin[k], i, start.ray.origin[k]);
            set_lane(wide.ray.direction[k], i, start.ray.direction[k]);
        }
        set_lane(wide.ray.time, i, start.ray.time);
        set_lane(wide.leaving_id, i, start.leaving_id);
    }
    wide.inverse = ray_inverse<Real>(wide.ray.direction);
    return wide;
}

/// The row of a ray, but for the distance of its hit so far.
template <class Scalar>
void set_row(RayRow<Scalar>& row, const StartedRay<Scalar>& start) {
    using Row = RayRow<Scalar>;
    for (int k = 0; k < 3; ++k) {
        row.value[Row::kOrigin + k] = start.ray.origin[k];
        row.value[Row::kScale + k] = 1 / start.ray.direction[k];
        row.value[Row::kDirection + k] = start.ray.direction[k];
    }
    row.value[Row::kLeaving] = of_bits<Scalar>(start.leaving_id);
    row.value[Row::kTime] = start.ray.time;
}

}  // namespace raypool::wavefront
