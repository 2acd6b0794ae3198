#include "cli/render_options.h"

#include <fmt/format.h>

#include "cli/engines.h"
#include "cli/option_rules.h"
#include "cli/options.h"
#include "core/math/path.h"
#include "wavefront/setting_names.h"

namespace raypool::cli {

void add_render_options(CLI::App& command, RenderOptions& options) {
    command.add_option("scene", options.scene, "Scene file, or the name of a built-in scene (default: paper)");
    command.add_option("-o,--output", options.output, "Image file: .png (sRGB), .exr or .pfm (linear)")
        ->check(check_file_name);
    command
        .add_option("--engine", options.engine,
                    fmt::format("How paths are followed (default: {}, with --cost-image {})",
                                engines().preferred(false).name, engines().preferred(true).name))
        ->check(CLI::IsMember(engines().names()));
    command.add_option("--spp", options.spp, "Samples per pixel (default: 100)")
        ->check(CLI::Range(std::int64_t{1}, kMostSpp));
    command.add_option("--samples", options.samples, "Only samples A:B of them, counted from 0, without B");
    command
        .add_option("--target-error", options.target_error,
                    "Give pixels samples, at most --spp, until the image's estimated RMSE is at most this radiance")
        ->check(check_within(1e-9, 1e9));
    command.add_option("--width", options.width, "Image width; the height follows (default: the scene's)")
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{65536}));
    command.add_option("--depth", options.depth, "Most segments of a path (default: 50)")
        ->check(CLI::Range(std::int64_t{0}, std::int64_t{path_step::kMostBounces}));
    command
        .add_option("--split-depth", options.split_depth,
                    "Follow both rays, reflected and refracted, at the first N hits on glass (default: 0)")
        ->check(CLI::Range(0, path_step::kMostSplits));
    command.add_option("--seed", options.seed, "Seed of all random numbers (default: 0)");
    command
        .add_option("--sampler", options.sampler,
                    "How numbers lie in a pixel: independent or sobol (default: independent)")
        ->check(CLI::IsMember({"independent", "sobol"}));
    command.add_flag("--roulette", options.roulette, "End paths that carry little by chance, without bias");
    command.add_option("--precision", options.precision, "Numbers of the kernels (default: float)")
        ->check(CLI::IsMember({"float", "double"}));
    command.add_option("--threads", options.threads, "OpenMP threads (default: OMP_NUM_THREADS)")
        ->check(CLI::Range(1, 4096));
    command.add_option("--schedule", options.schedule,
                       "balanced, or static, dynamic, guided or tasks, and a chunk: dynamic,4 (default: OMP_SCHEDULE, "
                       "else balanced, with --grain dynamic)");
    command.add_option("--grain", options.grain,
                       "What a loop iteration renders, unless balanced: pixel, line or tile:N (default: line)");
    add_pool_options(command, options.pool);
    command.add_flag("--count-work", options.count_work, "Count box and primitive tests (slower)");
    command
        .add_option("--checkpoint", options.checkpoint.file,
                    "Keep the exact sums in this file, every so often and at the end; `merge` adds such files up")
        ->check(check_file_name);
    command.add_option("--every", options.checkpoint.every_s, "Seconds between checkpoints (default: 60)")
        ->check(check_within(0, 1e9));
    command.add_flag("--resume", options.checkpoint.is_resumed, "Go on from the checkpoint");
    command.add_option("--stats", options.stats, "Write all figures to this file, as JSON")->check(check_file_name);
    command
        .add_option("--trace", options.trace,
                    "Write what each thread did when to this file, which Perfetto and chrome://tracing open")
        ->check(check_file_name);
    command
        .add_option("--cost-image", options.cost_image,
                    "Image file (.exr or .pfm) for what each pixel cost; scripts/draw_costs draws it")
        ->check(check_file_name);
    command.add_option("--cost", options.cost, "What is cost there: segments, tests or ns (default: tests)")
        ->check(CLI::IsMember({"segments", "tests", "ns"}));
    command.add_flag("--quiet", options.is_quiet, "Print nothing");
}

Cost cost_of(const std::string& word) {
    if (word == "segments") return Cost::Segments;
    return word == "ns" ? Cost::Nanoseconds : Cost::Tests;
}

RenderSettings render_settings(const RenderOptions& options) {
    RenderSettings settings;
    settings.end_sample = options.spp;
    if (options.samples) {
        const SampleRange range = parse_samples(*options.samples, options.spp);
        settings.first_sample = range.first;
        settings.end_sample = range.end;
    }
    settings.depth = static_cast<std::int32_t>(options.depth);
    settings.split_depth = options.split_depth;
    settings.seed = parse_seed(options.seed);
    settings.sampler = parse_sampler(options.sampler);
    settings.roulette = options.roulette;
    settings.threads = thread_count(options.threads);
    if (!engines().find(options.engine).has_pool || options.pool.scope != to_string(wavefront::PoolScope::Shared))
        settings.schedule = chosen_schedule(options.schedule, options.grain);
    if (options.grain) settings.grain = parse_grain(*options.grain);
    settings.count_work = options.count_work || (!options.cost_image.empty() && cost_of(options.cost) == Cost::Tests);
    settings.log_rounds = options.count_work;
    return settings;
}

}  // namespace raypool::cli
