#include "cli/render_options.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "cli/engines.h"
#include "cli/option_rules.h"
#include "cli/options.h"
#include "wavefront/setting_names.h"

namespace raypool::cli {

void add_render_options(CLI::App& command, RenderOptions& options) {
    add_common_options(command, options);
    command.add_option("-o,--output", options.output, "Image file: .png (sRGB), .exr or .pfm (linear)")
        ->check(check_file_name);
    command.add_flag("--aovs", options.has_aovs,
                     "Also alpha, depth, normal, albedo, samples and variance, as channels of the .exr file");
    command.add_flag("--half", options.is_half, "Half-precision floats in the .exr file");
    command
        .add_option("--engine", options.engine,
                    fmt::format("How paths are followed (default: {}, with --cost-image {})",
                                engines().preferred(false).name, engines().preferred(true).name))
        ->check(CLI::IsMember(engines().names()));
    command.add_option("--spp", options.spp, "Samples per pixel (default: 100)")
        ->check(CLI::Range(std::int64_t{1}, kMostSpp));
    command.add_option("--samples", options.samples, "Only samples A to B - 1 of them, as A:B; the first is 0");
    command.add_option("--crop", options.crop, "Only the pixels X0,Y0,X1,Y1: columns X0 to X1 - 1, rows Y0 to Y1 - 1");
    command.add_option("--pixel", options.pixel,
                       "Only the pixel X,Y, with every vertex of its paths on the standard output");
    command
        .add_option("--target-error", options.target_error,
                    "Give pixels samples, at most --spp, until the image's estimated RMSE is at most this radiance")
        ->check(check_within(1e-9, 1e9));
    command.add_option("--precision", options.precision, "Numbers of the kernels (default: float)")
        ->check(CLI::IsMember({"float", "double"}));
    add_pool_options(command, options.pool);
    command
        .add_option("--gpu-form", options.gpu_form,
                    "A thread a path, threads that take the next path, or a pool in the GPU's memory (default: wave)")
        ->check(CLI::IsMember(std::vector<std::string>(gpu::kFormNames.begin(), gpu::kFormNames.end())))
        ->group("GPU engine");
    command.add_flag("--count-work", options.count_work, "Count box and primitive tests (slower)");
    command
        .add_option("--checkpoint", options.checkpoint.file,
                    "Keep the exact sums in this file, every so often and at the end; `merge` adds such files up")
        ->check(check_file_name);
    command.add_option("--every", options.checkpoint.every_s, "Seconds between checkpoints (default: 60)")
        ->check(check_within(0, 1e9));
    command.add_flag("--resume", options.checkpoint.is_resumed, "Go on from the checkpoint");
    command
        .add_option("--preview", options.preview.file,
                    "Image file that is written anew every two seconds while the render goes on")
        ->check(check_file_name);
    command.add_option("--display-server", options.preview.server,
                       "HOST:PORT of a program that shows images as they come (tev)");
    command
        .add_option("--status", options.status, "Write how far the render is to this file every two seconds, as JSON")
        ->check(check_file_name);
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
    RenderSettings settings = common_settings(options);
    settings.end_sample = options.spp;
    if (options.samples) {
        const SampleRange range = parse_samples(*options.samples, options.spp);
        settings.first_sample = range.first;
        settings.end_sample = range.end;
    }
    if (!engines().find(options.engine).has_pool || options.pool.scope != to_string(wavefront::PoolScope::Shared))
        settings.schedule = chosen_schedule(options.schedule, options.grain);
    settings.count_work = options.count_work || (!options.cost_image.empty() && cost_of(options.cost) == Cost::Tests);
    settings.log_rounds = options.count_work;
    return settings;
}

gpu::GpuSettings gpu_settings(const RenderOptions& options, std::size_t record_bytes) {
    gpu::GpuSettings settings;
    const auto form = std::find(gpu::kFormNames.begin(), gpu::kFormNames.end(), options.gpu_form);
    if (form != gpu::kFormNames.end()) settings.form = static_cast<gpu::Form>(form - gpu::kFormNames.begin());
    if (!options.pool.rays.empty()) settings.capacity = parse_pool_rays(options.pool.rays, record_bytes);
    return settings;
}

}  // namespace raypool::cli
