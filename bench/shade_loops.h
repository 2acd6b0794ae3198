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
    const Records* rays;
    const float* distance;
    const std::int32_t* primitive_id;
    /// Columns one behind the other, `count` numbers each: origin, direction and throughput, and 1 where the path is
    /// alive, else 0.
    float* results;
    std::size_t count;

    static constexpr std::size_t kResults = 10;
};

/// Shades rays i, i + 1, ... by lane.
template <class Real>
RAYPOOL_INLINE void shade_at(const CompiledScene<float>& scene, const RandomSeed& seed, const ShadeColumns& columns,
                             std::size_t i) {
    const auto load = []<class V>(V& value, const auto* from) {
        if constexpr (Simd<V>) {
            value.copy_from(from, stdx::element_aligned);
        } else {
            value = *from;
        }
    };
    Real distance;
    Int<Real> primitive_id;
    load(distance, columns.distance + i);
    load(primitive_id, columns.primitive_id + i);
    const RayRecord<Real> record = columns.rays->load<Real>(i);
    const Scattered<Real> out = scatter<kPaper, Real>(scene, record.ray, distance, primitive_id, record.throughput,
                                                      record.key, record.step, seed);
    float* to = columns.results + i;
    const auto store = [&](const Real& value) {
        if constexpr (Simd<Real>) {
            value.copy_to(to, stdx::element_aligned);
        } else {
            *to = value;
        }
        to += columns.count;
    };
    for (int k = 0; k < 3; ++k) store(out.start.origin[k]);
    for (int k = 0; k < 3; ++k) store(out.direction[k]);
    for (int k = 0; k < 3; ++k) store(out.throughput[k]);
    store(select(out.is_alive, Real(1), Real(0)));
}

/// Ray by ray, in a loop that asks the compiler for vectors.
void shade_omp_simd(const CompiledScene<float>& scene, const RandomSeed& seed, const ShadeColumns& columns);

}  // namespace raypool
