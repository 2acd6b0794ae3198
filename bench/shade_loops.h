/// Shading alone: scatter() of core/shading/shade.h over columns, one ray at a time, or a register at a time.
///
/// shade_at() is the body of all the loops, so the loops differ in nothing but their width. The loop that is left to
/// the compiler is in shade_loop_omp_simd.cpp, which is compiled with flags of its own.
#pragma once

#include "bench/paper_scene.h"
#include "core/math/random.h"
#include "core/shading/shade.h"

namespace raypool {

/// Columns of rays that hit something, and of what becomes of them. All have room for whole registers.
struct ShadeColumns {
    const float* origin[3];
    const float* direction[3];
    const float* time;
    const float* throughput[3];
    const std::uint32_t* pixel;
    const std::uint32_t* sample;
    const std::uint32_t* step;
    const float* distance;
    const std::int32_t* primitive_id;

    float* next_origin[3];
    float* next_direction[3];
    float* next_throughput[3];
    float* is_alive;  ///< 1 or 0
};

namespace detail {

template <class V, class T>
RAYPOOL_INLINE V load_at(const T* column, std::size_t i) {
    if constexpr (Simd<V>) {
        return V(column + i, stdx::element_aligned);
    } else {
        return column[i];
    }
}
template <class Real>
RAYPOOL_INLINE Vec3<Real> load_vec3_at(const float* const (&columns)[3], std::size_t i) {
    return vec3<Real>(load_at<Real>(columns[0], i), load_at<Real>(columns[1], i), load_at<Real>(columns[2], i));
}
template <class V, class T>
RAYPOOL_INLINE void store_at(T* column, std::size_t i, const V& value) {
    if constexpr (Simd<V>) {
        value.copy_to(column + i, stdx::element_aligned);
    } else {
        column[i] = value;
    }
}

}  // namespace detail

/// Shades rays i, i + 1, ... by lane.
template <class Real>
RAYPOOL_INLINE void shade_at(const CompiledScene<float>& scene, const RandomSeed& seed, const ShadeColumns& columns,
                             std::size_t i) {
    using namespace detail;
    using U = Uint32<Real>;
    const Ray<Real> ray{load_vec3_at<Real>(columns.origin, i), load_vec3_at<Real>(columns.direction, i),
                        load_at<Real>(columns.time, i)};
    const PathKey<Real> key{load_at<U>(columns.pixel, i), load_at<U>(columns.sample, i)};
    const Scattered<Real> out = scatter<kPaper, Real>(
        scene, ray, load_at<Real>(columns.distance, i), load_at<Int<Real>>(columns.primitive_id, i),
        load_vec3_at<Real>(columns.throughput, i), key, load_at<U>(columns.step, i), seed);
    for (int k = 0; k < 3; ++k) {
        store_at(columns.next_origin[k], i, out.start.origin[k]);
        store_at(columns.next_direction[k], i, out.direction[k]);
        store_at(columns.next_throughput[k], i, out.throughput[k]);
    }
    store_at(columns.is_alive, i, select(out.is_alive, Real(1), Real(0)));
}

/// Ray by ray, in a loop that asks the compiler for vectors.
void shade_omp_simd(const CompiledScene<float>& scene, const RandomSeed& seed, const ShadeColumns& columns,
                    std::size_t count);

}  // namespace raypool
