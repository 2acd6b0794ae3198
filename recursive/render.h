/// The loop over the image, for any form of the tracer: what recursive/engine.h declares, as a template.
///
/// Instantiated once per form and precision in render_*.cpp; included by nothing else but tests.
#pragma once

#include <omp.h>

#include <algorithm>

#include <fmt/format.h>

#include "core/engine.h"
#include "core/error.h"
#include "core/loop.h"
#include "recursive/item_log.h"
#include "recursive/tracer.h"

namespace raypool::recursive {

/// Bytes of stack that one bounce takes, measured: a ray inside a white sphere bounces for ever.
template <SceneNeeds needs, class Scalar, class Work, Splitting splitting, Rules rules>
std::size_t stack_bytes_per_bounce() {
    Scene inside_sphere;
    inside_sphere.width = inside_sphere.height = 1;
    inside_sphere.textures.emplace_back().even = Vector3d::Ones();
    inside_sphere.materials.emplace_back();
    inside_sphere.spheres.emplace_back().radius = 10;
    const CompiledScene<Scalar> scene = compile<Scalar>(inside_sphere);
    const auto deepest = [&](std::int32_t depth) {
        RenderSettings settings;
        settings.depth = depth;
        Tracer<needs, Scalar, Work, splitting, rules> tracer(scene, settings, FixedPoint::make(1, 1));
        tracer.template sample<Form::Recursive>(0, 0, 0);
        return tracer.deepest_stack();
    };
    constexpr int kBounces = 64;
    return (deepest(kBounces) - deepest(2 * kBounces)) / kBounces;
}

/// Kept free on every stack, for what a bounce calls and for signal handlers.
inline constexpr std::size_t kStackReserve = 64 * 1024;

/// Refuses a depth that the stack of one of the `threads` threads could not hold.
template <SceneNeeds needs, class Scalar, class Work, Splitting splitting, Rules rules>
void check_stack(std::int32_t depth, int threads) {
    std::size_t left = std::numeric_limits<std::size_t>::max();
#pragma omp parallel num_threads(threads) reduction(min : left)
    left = stack_bytes_left();

    const std::size_t per_bounce = stack_bytes_per_bounce<needs, Scalar, Work, splitting, rules>();
    const std::size_t held = left < kStackReserve ? 0 : (left - kStackReserve) / per_bounce;
    if (depth == 0 || static_cast<std::size_t>(depth) < held) return;
    constexpr std::size_t kMegabyte = 1024 * 1024;
    const std::size_t wanted = ((static_cast<std::size_t>(depth) + 2) * per_bounce + 2 * kStackReserve) / kMegabyte + 1;
    throw InputError(
        fmt::format("--depth: recursion to depth {} needs {} MB of stack in each thread ({} bytes a bounce); these "
                    "threads hold depth "
                    "{}. Raise it with `ulimit -s {}` and OMP_STACKSIZE={}M, or use --engine iterative",
                    depth, wanted, per_bounce, held == 0 ? 0 : held - 1, wanted * 1024, wanted));
}

template <Form form, SceneNeeds needs, class Scalar, class Work, Splitting splitting = Splitting::Off,
          Rules rules = Rules::Any>
RenderReport render(const CompiledScene<Scalar>& scene, const RenderSettings& settings, Framebuffer& framebuffer) {
    check_settings(settings, framebuffer);
    if constexpr (form == Form::Recursive) {
        check_stack<needs, Scalar, Work, splitting, rules>(settings.depth, settings.threads);
    }
    const WorkItems items(scene.width, scene.height, settings.grain);
    return run_threads(settings, [&](ThreadWork& work, SampleAudit& audit) {
        Tracer<needs, Scalar, Work, splitting, rules> tracer(scene, settings, framebuffer.fixed_point());
        ProgressBatch progress(settings.progress);
        ItemLog log(settings, omp_get_thread_num());
        PixelCost cost(settings.cost_image);
        ChosenPixels chosen(settings.pixels);
        const bool has_squares = framebuffer.has_squares();

#pragma omp for schedule(runtime) nowait
        for (std::int64_t item = 0; item < items.count(); ++item) {
            const PixelRange range = items.range(item);
            log.start(range);
            for (std::int64_t y = range.y_begin; y < range.y_end; ++y) {
                for (std::int64_t x = range.x_begin; x < range.x_end; ++x) {
                    const std::int64_t pixel = y * scene.width + x;
                    if (!chosen.contains(pixel)) continue;
                    FixedRgb sum{};
                    FixedSquare square;
                    cost.start(tracer);
                    for (std::int64_t s = settings.first_sample; s < settings.end_sample; ++s) {
                        const FixedRgb& sample = tracer.template sample<form>(x, y, s);
                        for (int i = 0; i < 3; ++i) sum[i] += sample[i];
                        if (has_squares) square.add(tracer.square(sample));
                    }
                    cost.stop(tracer, pixel);
                    framebuffer.add(pixel, sum);
                    if (has_squares) framebuffer.add_square(pixel, square);
                    work.paths += settings.end_sample - settings.first_sample;
                    progress.add(settings.end_sample - settings.first_sample);
                }
            }
            log.stop(range);
        }
        work.segments = tracer.segments();
        work.box_tests = tracer.work().box_tests;
        work.primitive_tests = tracer.work().primitive_tests;
        audit = tracer.audit();
    });
}

/// Picks the code compiled for what the scene needs. Counting and splitting are compiled once each, for all needs.
template <Form form, class Scalar>
RenderReport render(const CompiledScene<Scalar>& scene, const RenderSettings& settings, Framebuffer& framebuffer) {
    if (settings.split_depth > 0)
        return render<form, kEverything, Scalar, WorkCount, Splitting::On>(scene, settings, framebuffer);
    const bool counts_for_image = settings.cost_image != nullptr && settings.cost_image->cost == Cost::Tests;
    if (settings.count_work || counts_for_image)
        return render<form, kEverything, Scalar, WorkCount>(scene, settings, framebuffer);
    return dispatch_needs(scene.needs, [&]<SceneNeeds needs>() {
        return are_plain(settings) ? render<form, needs, Scalar, NoWorkCount, Splitting::Off, Rules::Plain>(
                                         scene, settings, framebuffer)
                                   : render<form, needs, Scalar, NoWorkCount>(scene, settings, framebuffer);
    });
}

}  // namespace raypool::recursive
