/// The loop over the image, for any form of the tracer: what recursive/engine.h declares, as a template.
///
/// Tracers are compiled for each form, precision and set of features; the loop for each precision.
#pragma once

#include <omp.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/runtime/balanced_items.h"
#include "core/runtime/engine.h"
#include "core/runtime/loop.h"
#include "core/runtime/team_loop.h"
#include "recursive/item_log.h"
#include "recursive/tracer.h"

namespace raypool::recursive {

/// Bytes of stack that one bounce takes, measured: a ray inside a white sphere bounces for ever.
template <Features features, class Scalar, class Work, Splitting splitting, Rules rules>
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
        Tracer<features, Scalar, Work, splitting, rules> tracer(scene, settings, FixedPoint::make(1, 1));
        tracer.template sample<Form::Recursive>(0, 0, 0);
        return tracer.deepest_stack();
    };
    constexpr int kBounces = 64;
    return (deepest(kBounces) - deepest(2 * kBounces)) / kBounces;
}

/// Kept free on every stack, for what a bounce calls and for signal handlers.
inline constexpr std::size_t kStackReserve = 64 * 1024;

/// Refuses a depth that the stack of one of the `threads` threads could not hold.
template <Features features, class Scalar, class Work, Splitting splitting, Rules rules>
void check_stack(std::int32_t depth, int threads) {
    std::size_t left = std::numeric_limits<std::size_t>::max();
    {
        const OpenMpState state({});
        FirstException failure;
#pragma omp parallel num_threads(threads) reduction(min : left)
        failure.run([&left] { left = stack_bytes_left(); });
        failure.rethrow();
    }

    const std::size_t per_bounce = stack_bytes_per_bounce<features, Scalar, Work, splitting, rules>();
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

/// A tracer of one thread that adds lines of pixels to the framebuffer: what the loop over the image knows of it, so
/// that the loop is compiled once for each precision, and the tracer for each set of features.
class LineTracer {
  public:
    LineTracer() = default;
    LineTracer(const LineTracer&) = delete;
    LineTracer& operator=(const LineTracer&) = delete;
    virtual ~LineTracer() = default;
    /// Traces samples [first, end) of some pixels, which other threads may add to where `addition` says so.
    virtual void trace(const LinePixels& line, std::int64_t first, std::int64_t end, Addition addition,
                       ProgressBatch& progress) = 0;
    /// Ends the paths that trace() left under way, once there are no more lines.
    virtual void finish() {}
    virtual void report(ThreadReport& work, SampleStatistics& statistics) const = 0;
};

template <Form form, Features features, class Scalar, class Work, Splitting splitting, Rules rules>
class alignas(64) CompiledLineTracer final : public LineTracer {
  public:
    CompiledLineTracer(const CompiledScene<Scalar>& scene, const RenderSettings& settings, Framebuffer& framebuffer,
                       const Work& work = {})
        : width_(scene.width),
          framebuffer_(framebuffer),
          tracer_(scene, settings, framebuffer.fixed_point(), work),
          cost_(settings.cost_image) {}

    void trace(const LinePixels& line, std::int64_t first, std::int64_t end, Addition addition,
               ProgressBatch& progress) override {
        const bool has_halves = framebuffer_.has_halves();
        const std::int64_t y = line[0] / width_;
        for (std::int64_t i = 0; i < line.count; ++i) {
            const std::int64_t pixel = line[i];
            const std::int64_t x = pixel - y * width_;
            FixedRgb sums[2]{};
            cost_.start(tracer_);
            for (std::int64_t s = first; s < end; ++s) {
                const FixedRgb& sample = tracer_.template sample<form>(x, y, s);
                FixedRgb& sum =
                    sums[has_halves ? half_of_sample(static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(s))
                                    : 0];
                for (int k = 0; k < 3; ++k) sum[k] += sample[k];
            }
            cost_.stop(tracer_, pixel);
            if (addition == Addition::Plain) {
                add<Addition::Plain>(pixel, sums);
            } else {
                add<Addition::Atomic>(pixel, sums);
            }
            progress.add(end - first);
        }
    }
    void report(ThreadReport& work, SampleStatistics& statistics) const override {
        work.segments = tracer_.segments();
        work.shadow_rays = tracer_.shadow_rays();
        work.box_tests = tracer_.work().box_tests;
        work.primitive_tests = tracer_.work().primitive_tests;
        statistics = tracer_.statistics();
    }

  private:
    template <Addition addition>
    void add(std::int64_t pixel, const FixedRgb (&sums)[2]) {
        if (!framebuffer_.has_halves()) return framebuffer_.template add<addition>(pixel, sums[0]);
        for (int half = 0; half < 2; ++half) framebuffer_.template add<addition>(2 * pixel + half, sums[half]);
    }

    std::int64_t width_;
    Framebuffer& framebuffer_;
    Tracer<features, Scalar, Work, splitting, rules> tracer_;
    PixelCost cost_;
};

/// What the loop over the image asks of the code that was picked.
template <class Scalar>
struct TracerMaker {
    std::function<std::unique_ptr<LineTracer>(const CompiledScene<Scalar>&, const RenderSettings&, Framebuffer&)> make;
    void (*check_stack)(std::int32_t depth, int threads);  ///< null where the stack does not grow with the depth
};

template <Form form, Features features, class Scalar, class Work, Splitting splitting, Rules rules>
TracerMaker<Scalar> tracer_maker() {
    TracerMaker<Scalar> maker{
        [](const CompiledScene<Scalar>& scene, const RenderSettings& settings,
           Framebuffer& framebuffer) -> std::unique_ptr<LineTracer> {
            return std::make_unique<CompiledLineTracer<form, features, Scalar, Work, splitting, rules>>(scene, settings,
                                                                                                        framebuffer);
        },
        nullptr};
    if constexpr (form == Form::Recursive) maker.check_stack = &check_stack<features, Scalar, Work, splitting, rules>;
    return maker;
}

template <class Scalar>
class Session : public RenderSession {
  public:
    Session(const CompiledScene<Scalar>& scene, const RenderSettings& settings, Framebuffer& framebuffer,
            const TracerMaker<Scalar>& maker)
        : scene_(scene), settings_(settings), framebuffer_(framebuffer), make_(maker.make) {
        const double start = wall_seconds();
        report_.threads.reserve(static_cast<std::size_t>(settings.threads));  // so that no report fails behind a render
        if (maker.check_stack != nullptr) {
            maker.check_stack(settings.depth, settings.threads);
            report_.seconds = report_.setup_s = wall_seconds() - start;
        }
    }

  private:
    RenderReport render(const RenderUnit& unit) override {
        if (path_count(scene_, unit) == 0) return {};
        const double start = wall_seconds();
        if (settings_.schedule.kind == LoopSchedule::Kind::Balanced) {
            const BalancedItems items(scene_.width, scene_.height, unit, settings_.threads);
            const auto visit = [&](std::int64_t item, const TraceLine& trace) {
                items.for_each_line(item, scene_.width, unit.pixels,
                                    [&](const LinePixels& line, std::int64_t first, std::int64_t end) {
                                        trace(line, unit.first_sample + first, unit.first_sample + end);
                                    });
            };
            return loop_over(items.count(), visit, items.splits_pixels() ? Addition::Atomic : Addition::Plain, start);
        }
        const WorkItems items(scene_.width, scene_.height, settings_.grain, unit.pixels);
        const auto visit = [&](std::int64_t item, const TraceLine& trace) {
            items.for_each_line(item, [&](const LinePixels& line) { trace(line, unit.first_sample, unit.end_sample); });
        };
        return loop_over(items.count(), visit, Addition::Plain, start);
    }

    /// Traces samples [first, end) of some pixels.
    using TraceLine = std::function<void(const LinePixels&, std::int64_t first, std::int64_t end)>;
    /// Calls what it is given for each line of an item.
    using VisitItem = std::function<void(std::int64_t item, const TraceLine&)>;

    /// Has each item visited by some thread, which adds to the framebuffer as `addition` says. What passed since
    /// `start_s` was setup.
    RenderReport loop_over(std::int64_t item_count, const VisitItem& visit, Addition addition, double start_s) {
        std::vector<std::unique_ptr<LineTracer>> tracers(static_cast<std::size_t>(settings_.threads));
        for (auto& tracer : tracers) tracer = make_(scene_, settings_, framebuffer_);
        const double setup_s = wall_seconds() - start_s;
        TeamLoop loop(settings_);
        RenderReport report = run_threads(settings_, [&](ThreadReport& work, SampleStatistics& statistics) {
            LineTracer& tracer = *tracers[static_cast<std::size_t>(omp_get_thread_num())];
            ProgressBatch progress(settings_.progress);
            ItemLog log(settings_, omp_get_thread_num());

            const auto trace = [&](const LinePixels& line, std::int64_t first, std::int64_t end) {
                if (!log.is_started()) log.start(line[0] % scene_.width, line[0] / scene_.width);
                tracer.trace(line, first, end, addition, progress);
                work.paths += line.count * (end - first);
                log.add(line.count);
            };
            const TraceLine trace_line = std::ref(trace);  // which takes no memory, so that nothing fails in here
            work.wait_s = loop.run(item_count, [&](std::int64_t item) {
                visit(item, trace_line);
                log.stop();
            });
            tracer.finish();
            tracer.report(work, statistics);
        });
        report.setup_s += setup_s;
        report.seconds += setup_s;
        return report;
    }

    const CompiledScene<Scalar>& scene_;
    RenderSettings settings_;
    Framebuffer& framebuffer_;
    decltype(TracerMaker<Scalar>::make) make_;
};

template <Form form, Features features, class Scalar, class Work, Splitting splitting = Splitting::Off,
          Rules rules = Rules::Any>
std::unique_ptr<RenderSession> begin(const CompiledScene<Scalar>& scene, const RenderSettings& settings,
                                     Framebuffer& framebuffer) {
    return std::make_unique<Session<Scalar>>(scene, settings, framebuffer,
                                             tracer_maker<form, features, Scalar, Work, splitting, rules>());
}

/// Picks the code compiled for the features of the scene. Counting and splitting are compiled once each, for all.
template <Form form, class Scalar>
std::unique_ptr<RenderSession> begin(const CompiledScene<Scalar>& scene, const RenderSettings& settings,
                                     Framebuffer& framebuffer) {
    if (settings.split_depth > 0)
        return begin<form, kEverything, Scalar, TestCount, Splitting::On>(scene, settings, framebuffer);
    const bool counts_for_image = settings.cost_image != nullptr && settings.cost_image->cost == Cost::Tests;
    if (settings.count_work || counts_for_image)
        return begin<form, kEverything, Scalar, TestCount>(scene, settings, framebuffer);
    return dispatch_features<kFirstCompiledFeatures<Scalar>>(
        needed_features(scene.features, settings), [&]<Features features>() {
            return are_plain(settings) ? begin<form, features, Scalar, NoTestCount, Splitting::Off, Rules::Plain>(
                                             scene, settings, framebuffer)
                                       : begin<form, features, Scalar, NoTestCount>(scene, settings, framebuffer);
        });
}

}  // namespace raypool::recursive
