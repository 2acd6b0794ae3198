#include "cli/render_summary.h"

#include <algorithm>

#include <fmt/format.h>

#include "cli/print.h"
#include "core/base/memory.h"
#include "core/film/light_range.h"
#include "core/runtime/trace.h"
#include "gpu/engine.h"
#include "wavefront/pool_report.h"

namespace raypool::cli {

namespace {

/// What was traced just now, which is nothing where a checkpoint was complete.
void print_work(const RenderSettings& settings, const RenderReport& report) {
    const auto paths = static_cast<double>(report.paths());
    const auto segments = static_cast<double>(report.segments());
    if (paths == 0) {
        print("no sample was missing\n");
        return;
    }
    print("{:.3f} M paths, {:.3f} M segments ({:.3f} a path) in {:.3f} s: {:.3f} M paths/s, {:.1f} ns a segment\n",
          paths * 1e-6, segments * 1e-6, segments / paths, report.seconds, paths / report.seconds * 1e-6,
          segments == 0 ? 0 : report.seconds * 1e9 * static_cast<double>(report.threads.size()) / segments);
    if (const std::int64_t rays = report.total(&ThreadReport::shadow_rays); rays > 0)
        print("{:.3f} M shadow rays, whose time is in that of the segments\n", static_cast<double>(rays) * 1e-6);
    if (settings.count_work)
        print("{:.2f} box tests and {:.2f} primitive tests a segment\n",
              static_cast<double>(report.total(&ThreadReport::box_tests)) / segments,
              static_cast<double>(report.total(&ThreadReport::primitive_tests)) / segments);
}

/// What is known of the error of an adaptive render. An estimate is not printed where there is none.
void print_error(const RenderRecord& record) {
    const AdaptiveReport& adaptive = record.adaptive;
    const auto [least, most] = std::minmax_element(adaptive.sample_counts.begin(), adaptive.sample_counts.end());
    const bool has_estimate = adaptive.rmse > 0;
    print("RMSE {}at most {:.4g} (asked for {:.4g}: {}) after {} rounds; {} to {} samples a pixel, {:.1f} on average\n",
          has_estimate ? fmt::format("estimated {:.4g}, ", adaptive.rmse) : "", adaptive.most_rmse, record.target_error,
          to_string(adaptive.status), adaptive.rounds, *least, *most, adaptive.mean_samples());
    print("{} pixels without variance; light that no sample has found adds at most {:.3g}\n", adaptive.flat_pixels,
          adaptive.unseen_rmse);
}

/// Whether rounding shows: against the image as a whole, and the dimmest light in the scene.
void print_step(const RenderRecord& record) {
    const double half = 0.5 * record.sum_step;
    print("sums go by steps of {:.2g}; mean radiance {:.4g}\n", record.sum_step, record.mean_radiance);
    const auto warn = [&](const char* what, double radiance) {
        if (radiance > 0 && half > kFineStep * radiance)
            print("beside the brightest light {}, {:.3g}, is coarse: rounding changes it by up to {:.2g} %\n", what,
                  radiance, 100 * half / radiance);
    };
    warn("the image's mean", record.mean_radiance);
    warn("the dimmest light", record.dimmest_light);
}

}  // namespace

void print_summary(const RenderRecord& record) {
    const RenderSettings& settings = record.settings;
    const RenderReport& report = record.report;
    const std::string lights = settings.light_sampling == LightSampling::None
                                   ? ""
                                   : fmt::format(", light sampling {}", to_string(settings.light_sampling));
    const PixelWindow& crop = record.crop;
    const std::string part = is_cropped(record)
                                 ? fmt::format(", of these columns {} to {} and rows {} to {}", crop.x_begin,
                                               crop.x_end - 1, crop.y_begin, crop.y_end - 1)
                                 : "";
    print("{}: {} x {}{}, samples {} to {} of {}, depth {}{}, {}seed {}, {}\n", record.scene_name, record.width,
          record.height, part, settings.first_sample, settings.end_sample, record.spp, settings.depth,
          (settings.roulette ? " and roulette" : "") + lights, settings.sampler == Sampler::Sobol ? "sobol, " : "",
          settings.seed, record.precision == Precision::Float ? "float" : "double");
    const std::string ranks = record.ranks.empty() ? "" : fmt::format("{} ranks of ", record.ranks.size());
    print("{} engine: {}{} thread{}, {}\n", record.engine, ranks, settings.threads, settings.threads == 1 ? "" : "s",
          record.engine == "gpu"      ? gpu::kFormNames[static_cast<std::size_t>(record.gpu.form)]
          : !loops_over_image(record) ? "one pool for all"
          : has_grain(settings.schedule)
              ? fmt::format("grain {}, schedule {}", to_string(settings.grain), to_string(settings.schedule))
              : fmt::format("schedule {}", to_string(settings.schedule)));
    print_work(settings, report);
    if (record.target_error > 0) print_error(record);
    if (const wavefront::PoolReport& pool = wavefront::pool_report(report); pool.pool_rays > 0)
        print("ray record of {} bytes; pools of {} records, at most {:.2f} MB\n", pool.record_bytes, pool.pool_rays,
              static_cast<double>(report.memory_bytes) / (1024 * 1024));
    if (const gpu::GpuReport& gpu = gpu::gpu_report(report); !gpu.device.empty())
        print(
            "{}: {} in {:.3f} s of kernels, {} of its memory\n", gpu.device,
            gpu.capacity == 0 ? "paths" : fmt::format("{} rounds over a pool of {} records", gpu.rounds, gpu.capacity),
            gpu.kernel_s, bytes_text(report.memory_bytes));
    if (record.has_aovs) print("channels beside the picture: {:.3f} s more\n", record.aovs_s);
    if (record.truncation_bound > 0)
        print("what depth {} cuts off is proved to be at most a radiance of {:.3g} a pixel, and mostly is far less\n",
              settings.depth, record.truncation_bound);
    print_step(record);
    if (report.statistics.non_finite > 0 || report.statistics.clamped > 0)
        print("bad samples: {} not finite and left out, {} channels cut (radiance {:.6g} in all)\n",
              report.statistics.non_finite, report.statistics.clamped, report.statistics.clamped_energy);
    print("hash {}\n", record.hash);
}

void print_miss(const RenderRecord& record) {
    const AdaptiveReport& adaptive = record.adaptive;
    if (adaptive.status == TargetStatus::Unknown) {
        print(
            stderr,
            "raypool: --target-error {:g} is not known to be reached: light that no sample has found may add {:.3g}\n",
            record.target_error, adaptive.unseen_rmse);
        return;
    }
    print(
        stderr,
        "raypool: --target-error {:g} is not reached: the estimated RMSE is {:.4g} with the most samples that --spp {} "
        "allows\n",
        record.target_error, adaptive.rmse, record.spp);
}

void print_trace(const std::string& file, const Trace& trace) {
    print("{}: {} events", file, trace.event_count());
    if (trace.dropped_count() > 0)
        print(", and {} that are left out: the trace ends early, with {} events of a thread", trace.dropped_count(),
              Trace::kMostEvents);
    print("\n");
}

}  // namespace raypool::cli
