/// The per-pixel tracer: one path from the camera to its end, as a function that calls itself or as a loop.
///
/// Both forms are here, and differ in nothing but that. All physics is in core/: a step is "what is hit, and what
/// then". Throughput is handed down the path and multiplied in one order, and a path's end adds its radiance, as an
/// integer, to the sum of its pixel. So both forms, and any other engine, agree to the last bit.
#pragma once

#include <algorithm>
#include <limits>

#include "core/geometry/any_hit.h"
#include "core/geometry/traverse.h"
#include "core/runtime/engine.h"
#include "core/shading/shade.h"
#include "recursive/stack.h"

namespace raypool::recursive {

enum class Form : bool { Recursive, Iterative };

/// What a path carries where lights are sampled.
template <class Scalar, bool has_lights>
struct PathLight {};
template <class Scalar>
struct PathLight<Scalar, true> {
    Scalar density = 0;  ///< of the ray's direction, where lights were sampled too; else 0
};

/// A path between two segments.
template <class Scalar, bool has_lights>
struct Path : PathLight<Scalar, has_lights> {
    Ray<Scalar> ray;
    Vec3<Scalar> throughput;
    PathKey<Scalar> key;
    std::int32_t leaving_id;  ///< what the ray starts on: RayStart::leaving_id
    std::uint32_t step;       ///< path_step: hits so far, and the branch
};

/// What follows a segment.
enum class Next : std::uint8_t { End, OnePath, TwoPaths };

/// What is decided when compiling: independent numbers and no roulette (whose branches and registers this engine would
/// feel, and the paper's tracer has not), or whatever the settings say.
enum class Rules : bool { Plain, Any };

constexpr bool are_plain(const ImageSettings& settings) {
    return settings.sampler == Sampler::Independent && !settings.roulette;
}

/// Traces paths for one thread. `Work` counts box and primitive tests, or nothing; a `Work` with a closest_hit() of its
/// own finds hits in another way (bench/peers/).
template <Features features, class Scalar, class Work, Splitting splitting, Rules rules = Rules::Any>
class Tracer {
    using Path = recursive::Path<Scalar, features.lights>;

  public:
    Tracer(const SceneView<Scalar>& scene, const ImageSettings& settings, const FixedPoint& fixed,
           const Work& work = {})
        : scene_(scene),
          seed_(random_seed(settings.seed, settings.sampler)),
          depth_(settings.depth),
          split_depth_(settings.split_depth),
          roulette_(settings.roulette),
          light_sampling_(needed_light_sampling(scene.features, settings)),
          converter_(fixed),
          work_(work) {}

    /// One sample, whole.
    template <Form form>
    const FixedRgb& sample(std::int64_t x, std::int64_t y, std::int64_t sample_id) {
        const PathKey<Scalar> key{static_cast<std::uint32_t>(y * scene_.width + x),
                                  static_cast<std::uint32_t>(sample_id)};
        const Ray<Scalar> ray = camera_ray<features, Scalar>(scene_.camera, static_cast<Scalar>(x),
                                                             static_cast<Scalar>(y), key.pixel, key.sample, seed());
        sum_ = {};
        const Path path{{}, ray, vec3<Scalar>(1, 1, 1), key, kNoPrimitive, 0};
        if constexpr (form == Form::Recursive) {
            recurse(path);
        } else {
            iterate(path);
        }
        return sum_;
    }

    [[nodiscard]] std::int64_t segments() const { return segments_; }
    [[nodiscard]] std::int64_t shadow_rays() const { return shadow_rays_; }
    [[nodiscard]] const Work& work() const { return work_; }
    [[nodiscard]] const SampleStatistics& statistics() const { return converter_.statistics(); }
    [[nodiscard]] std::uintptr_t deepest_stack() const { return deepest_stack_; }

  private:
    /// By recursion, as in the paper: a bounce is a call. What follows a segment is made in its own frame and handed on
    /// by reference: a copy would be read before the stores of its parts have ended, which takes a few nanoseconds.
    [[gnu::noinline]] void recurse(const Path& path) {
        Path after;
        if constexpr (splitting == Splitting::Off) {
            if (advance(path, after, nullptr) == Next::OnePath) return recurse(after);
        } else {
            Path reflected;
            const Next next = advance(path, after, &reflected);
            if (next == Next::TwoPaths) recurse(reflected);
            if (next != Next::End) return recurse(after);
        }
        deepest_stack_ = std::min(deepest_stack_, stack_pointer());
    }

    /// The same with a loop in place of the call.
    void iterate(Path path) {
        if constexpr (splitting == Splitting::Off) {
            while (advance(path, path, nullptr) != Next::End) {
            }
        } else {
            Path waiting[path_step::kMostSplits + 1];
            for (int count = 0;;) {
                const Next next = advance(path, path, &waiting[count]);
                if (next == Next::TwoPaths) ++count;
                if (next == Next::End && count == 0) return;
                if (next == Next::End) path = waiting[--count];
            }
        }
    }

    /// Traces one segment and sets the path after it, which may take the place of `path`; `reflected` is set when there
    /// is a second one.
    RAYPOOL_INLINE Next advance(const Path& path, Path& after, Path* reflected) {
        if (path_step::bounce(path.step) == static_cast<std::uint32_t>(depth_)) return Next::End;
        ++segments_;
        work_.begin_segment();
        const Hit<Scalar> hit = closest_hit<features>(scene_, path.ray, path.leaving_id, work_);
        if (hit.primitive_id == kNoPrimitive) {
            Scalar density = 0;
            if constexpr (features.lights) density = path.density;
            return finish(escaping_radiance<features, Scalar>(scene_, path.ray.direction, path.throughput,
                                                              light_sampling_, density));
        }
        LightPart<Scalar> lights;
        if constexpr (features.lights) {
            lights.sampling = light_sampling_;
            lights.arriving_density = path.density;
            lights.depth = depth_;
        }
        const Scattered<Scalar> out = scattered(path, hit, lights);
        if constexpr (features.lights) {
            if (lights.has_shadow_ray) follow_shadow_ray(path, out, lights);
        }
        if (out.is_emitter) return finish(out.throughput);
        after.ray = {out.start.origin, out.direction, path.ray.time};
        after.throughput = out.throughput;
        after.key = path.key;
        after.leaving_id = static_cast<std::int32_t>(out.start.leaving_id);
        after.step = path.step + 1;
        if constexpr (features.lights) after.density = lights.density;
        if constexpr (splitting == Splitting::On) {
            if (out.is_split) {
                *reflected = after;
                reflected->ray.origin = out.reflected_start.origin;
                reflected->leaving_id = static_cast<std::int32_t>(out.reflected_start.leaving_id);
                reflected->ray.direction = out.reflected_direction;
                reflected->throughput = out.reflected_throughput;
                reflected->step = path_step::reflected_branch(after.step);
                after.step = reflected->step + (1U << path_step::kBranchShift);
                if (out.is_alive && out.is_reflected_alive) return Next::TwoPaths;
                if (out.is_reflected_alive) after = *reflected;
                return out.is_alive || out.is_reflected_alive ? Next::OnePath : Next::End;
            }
        }
        return out.is_alive ? Next::OnePath : Next::End;
    }

    /// What is no triangle does not pay for what triangles need. (With lights there would be too much code.)
    RAYPOOL_INLINE Scattered<Scalar> scattered(const Path& path, const Hit<Scalar>& hit, LightPart<Scalar>& lights) {
        if constexpr (features.triangles && !features.lights) {
            if (hit.primitive_id < scene_.first_triangle)
                return scatter_by<without_triangles(features)>(path, hit, lights);
        }
        return scatter_by<features>(path, hit, lights);
    }
    template <Features code>
    RAYPOOL_INLINE Scattered<Scalar> scatter_by(const Path& path, const Hit<Scalar>& hit, LightPart<Scalar>& lights) {
        return scatter<code, Scalar, splitting>(scene_, path.ray, hit.t, hit.primitive_id, path.throughput, path.key,
                                                path.step, seed(), split_depth_, rules == Rules::Any && roulette_,
                                                features.lights ? &lights : nullptr);
    }

    /// The sampler of plain rules is known to the compiler.
    [[nodiscard]] RandomSeed seed() const {
        return {seed_.low, seed_.high, rules == Rules::Plain ? Sampler::Independent : seed_.sampler};
    }

    Next finish(const Vec3<Scalar>& radiance) {
        add(radiance);
        return Next::End;
    }
    RAYPOOL_INLINE void add(const Vec3<Scalar>& radiance) {
        const FixedRgb fixed = converter_.template convert<Scalar>(radiance);
        for (int i = 0; i < 3; ++i) sum_[i] += fixed[i];
    }

    void follow_shadow_ray(const Path& path, const Scattered<Scalar>& out, const LightPart<Scalar>& lights) {
        ++shadow_rays_;
        if constexpr (requires { work_.begin_shadow_ray(); }) work_.begin_shadow_ray();  // of a log that wants to know
        const Ray<Scalar> ray{out.start.origin, lights.light.direction, path.ray.time};
        const Occlusion<Scalar> light{lights.light.t, static_cast<std::int32_t>(lights.light.primitive_id)};
        if (!is_occluded<features>(scene_, ray, static_cast<std::int32_t>(out.start.leaving_id), light, work_))
            add(lights.radiance);
    }

    const SceneView<Scalar>& scene_;
    RandomSeed seed_;
    std::int32_t depth_;
    int split_depth_;
    bool roulette_;
    LightSampling light_sampling_;
    std::int64_t segments_ = 0;
    std::int64_t shadow_rays_ = 0;
    FixedRgb sum_{};
    SampleConverter converter_;
    Work work_;
    std::uintptr_t deepest_stack_ = std::numeric_limits<std::uintptr_t>::max();
};

}  // namespace raypool::recursive
