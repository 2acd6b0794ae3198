/// Rays at meshes, many of them: what tests of triangles and of instances share.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/geometry/any_hit.h"
#include "core/shading/shade.h"
#include "tests/core/geometry/brute_force.h"
#include "tests/random_inputs.h"

namespace raypool::test {

template <class Scalar>
Hit<Scalar> hit_of(const CompiledScene<Scalar>& scene, const Ray<Scalar>& ray, std::int32_t leaving_id) {
    NoTestCount work;
    return closest_hit<kEverything>(scene, ray, leaving_id, work);
}
template <class Scalar>
Vec3<Scalar> vertex(const CompiledScene<Scalar>& scene, std::uint32_t triangle, int i) {
    const auto id = static_cast<std::size_t>(bits_of<Scalar>(scene.triangles[triangle].value[i]));
    const Scalar* row = scene.vertices[id].value;
    return vec3<Scalar>(row[0], row[1], row[2]);
}

/// How large the mesh is and how many rays are traced at it: by default what takes a second, else as scripts/leaks
/// says.
inline std::int64_t wanted(const char* name, std::int64_t otherwise) {
    const char* text = std::getenv(name);
    return text == nullptr ? otherwise : std::atoll(text);
}
inline int levels() {
    return static_cast<int>(wanted("RAYPOOL_LEAK_LEVELS", 4));
}
inline std::int64_t ray_count() {
    return wanted("RAYPOOL_LEAK_RAYS", 100'000);
}

/// Of `rays` times those of which visit(random, i) is true, on all cores: the same whatever their number.
template <class Visit>
std::int64_t count_of(std::int64_t rays, std::uint64_t seed, Visit visit) {
    constexpr std::int64_t kBlock = 1 << 12;
    std::int64_t count = 0;
#pragma omp parallel for schedule(dynamic) reduction(+ : count)
    for (std::int64_t first = 0; first < rays; first += kBlock) {
        RandomInputs random(seed + static_cast<std::uint64_t>(first));
        for (std::int64_t i = first; i < std::min(first + kBlock, rays); ++i) count += visit(random, i) ? 1 : 0;
    }
    return count;
}

/// The closest of all triangles, one by one; of a tie the first. Nothing is before it, and it is before what lies
/// behind.
template <class Scalar>
void expect_what_is_found_one_by_one(const CompiledScene<Scalar>& scene, std::int64_t otherwise) {
    const std::int64_t rays = wanted("RAYPOOL_BRUTE_FORCE_RAYS", otherwise);
    const auto ray_of = [](RandomInputs& inputs) {
        const Vec3<Scalar> origin = inputs.point<Scalar>(7);
        return Ray<Scalar>{origin, inputs.direction<Scalar>(), 0};
    };
    const auto differs = [&](RandomInputs& inputs, std::int64_t) {
        const Ray<Scalar> ray = ray_of(inputs);
        const Hit<Scalar> expected = brute_force_hit<Scalar>(scene, ray, kNoPrimitive);
        const Hit<Scalar> hit = hit_of(scene, ray, kNoPrimitive);
        NoTestCount work;
        const auto is_hidden = [&](Scalar t, Int<Scalar> id) {
            const Occlusion<Scalar> light{t, static_cast<std::int32_t>(id)};
            return is_occluded<kEverything>(scene, ray, kNoPrimitive, light, work);
        };
        return hit.primitive_id != expected.primitive_id || hit.t != expected.t || is_hidden(hit.t, hit.primitive_id) ||
               (hit.primitive_id != kNoPrimitive && !is_hidden(2 * hit.t, kNoPrimitive));
    };
    EXPECT_EQ(count_of(rays, 54, differs), 0);
    const auto hits = [&](RandomInputs& inputs, std::int64_t) {
        return hit_of(scene, ray_of(inputs), kNoPrimitive).primitive_id != kNoPrimitive;
    };
    EXPECT_GT(count_of(rays, 54, hits), rays / 4);
}

}  // namespace raypool::test
