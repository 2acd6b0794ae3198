/// The per-pixel tracer: one path from the camera to its end, as a function that calls itself or as a loop.
///
/// Both forms are here, and differ in nothing but that. All physics is in core/: a step is "what is hit, and what
/// then". Throughput is handed down the path and radiance handed back unchanged, so both forms, and any other engine,
/// multiply in the same order and agree to the last bit.
#pragma once

#include <limits>

#include "core/shade.h"
#include "core/traverse.h"
#include "recursive/stack.h"

namespace raypool::recursive {

enum class Form : bool { Recursive, Iterative };

/// A path between two segments.
template <class Scalar>
struct Path {
    Ray<Scalar> ray;
    Vec3<Scalar> throughput;
    PathKey<Scalar> key;
    std::int32_t leaving_id;  ///< the primitive the ray starts on
    std::int32_t bounce;      ///< segments already traced
};

/// Traces paths for one thread. `Work` counts box and primitive tests, or nothing.
template <SceneNeeds needs, class Scalar, class Work>
class Tracer {
  public:
    Tracer(const CompiledScene<Scalar>& scene, RandomSeed seed, std::int32_t depth)
        : scene_(scene), seed_(seed), depth_(depth) {}

    /// The radiance of one sample.
    template <Form form>
    Vec3<Scalar> sample(std::int64_t x, std::int64_t y, std::int64_t sample_id) {
        const PathKey<Scalar> key{static_cast<std::uint32_t>(y * scene_.width + x),
                                  static_cast<std::uint32_t>(sample_id)};
        const Ray<Scalar> ray = camera_ray<needs, Scalar>(scene_.camera, static_cast<Scalar>(x), static_cast<Scalar>(y),
                                                          key.pixel, key.sample, seed_);
        const Path<Scalar> path{ray, vec3<Scalar>(1, 1, 1), key, kNoPrimitive, 0};
        return form == Form::Recursive ? recurse(path) : iterate(path);
    }

    [[nodiscard]] std::int64_t segments() const { return segments_; }
    [[nodiscard]] const Work& work() const { return work_; }
    [[nodiscard]] std::uintptr_t deepest_stack() const { return deepest_stack_; }

  private:
    /// What is to be done after a segment.
    struct Step {
        bool goes_on;
        Vec3<Scalar> radiance;  ///< of a path that does not go on
    };

    /// Radiance by recursion, as in the paper: a bounce is a call.
    [[gnu::noinline]] Vec3<Scalar> recurse(Path<Scalar> path) {
        const Step step = advance(path);
        if (!step.goes_on) {
            deepest_stack_ = std::min(deepest_stack_, stack_pointer());
            return step.radiance;
        }
        return recurse(path);
    }

    /// The same with a loop in place of the call.
    Vec3<Scalar> iterate(Path<Scalar> path) {
        for (;;) {
            const Step step = advance(path);
            if (!step.goes_on) return step.radiance;
        }
    }

    /// Traces one segment and turns the path around its end.
    RAYPOOL_INLINE Step advance(Path<Scalar>& path) {
        const Vec3<Scalar> black = vec3<Scalar>(0, 0, 0);
        if (path.bounce == depth_) return {false, black};
        ++segments_;
        const Hit<Scalar> hit = closest_hit<needs>(scene_, path.ray, path.leaving_id, work_);
        if (hit.primitive_id == kNoPrimitive) {
            const Vec3<Scalar> sky = sky_radiance<Scalar>(scene_.sky, path.ray.direction);
            return {false, path.throughput.cwiseProduct(sky)};
        }
        const Scattered<Scalar> out =
            scatter<needs, Scalar>(scene_, path.ray, hit.t, static_cast<Int<Scalar>>(hit.primitive_id), path.throughput,
                                   path.key, static_cast<std::uint32_t>(path.bounce), seed_);
        if (out.is_emitter) return {false, out.throughput};
        if (!out.is_alive) return {false, black};
        path.ray.origin = out.origin;
        path.ray.direction = out.direction;
        path.throughput = out.throughput;
        path.leaving_id = static_cast<std::int32_t>(hit.primitive_id);
        ++path.bounce;
        return {true, black};
    }

    const CompiledScene<Scalar>& scene_;
    RandomSeed seed_;
    std::int32_t depth_;
    std::int64_t segments_ = 0;
    Work work_;
    std::uintptr_t deepest_stack_ = std::numeric_limits<std::uintptr_t>::max();
};

}  // namespace raypool::recursive
