#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/checkpoint_keeper.h"
#include "cli/commands.h"
#include "cli/engines.h"
#include "cli/option_rules.h"
#include "cli/options.h"
#include "cli/pool_options.h"
#include "cli/print.h"
#include "cli/render_image.h"
#include "cli/render_options.h"
#include "cli/render_record.h"
#include "cli/render_summary.h"
#include "cli/stats_json.h"
#include "cli/stopwatch.h"
#include "cluster/agreement.h"
#include "core/base/error.h"
#include "core/base/json_file.h"
#include "core/base/output_file.h"
#include "core/image/cost_image.h"
#include "core/image/image_file.h"
#include "core/runtime/environment.h"
#include "core/runtime/trace.h"

namespace raypool::cli {

namespace {

ImageAttributes image_attributes(const RenderRecord& record) {
    ImageAttributes attributes{{"raypool.hash", record.hash},
                               {"raypool.samples_done", fmt::to_string(record.samples_done)}};
    const nlohmann::json settings = settings_json(record);
    for (const auto& [key, value] : settings.items())
        attributes["raypool." + key] =
            value.is_string() ? value.get<std::string>() : json_text(value, JsonLayout::OneLine);
    return attributes;
}

void write_cost_image(const RenderOptions& options, const CostImage& cost, const RenderRecord& record) {
    ImageAttributes attributes = image_attributes(record);
    attributes["raypool.cost"] = options.cost;
    write_image(options.cost_image, cost.image(), attributes);
}

void warn_of_infinite_halves(const std::string& file, const Image& image) {
    const auto count = std::count_if(image.rgb.begin(), image.rgb.end(),
                                     [](float value) { return std::isfinite(value) && value >= kInfiniteAsHalf; });
    if (count > 0)
        print(stderr, "raypool: {}: {} {} of {} or more, which half precision has not: infinite there\n", file, count,
              count == 1 ? "value" : "values", kInfiniteAsHalf);
}

/// What only one rank can do is for rank 0; what is not gathered from ranks is refused. Returns the checkpoint's lock.
[[nodiscard]] std::unique_ptr<FileLock> make_ready(RenderOptions& options, const cluster::Ranks& ranks) {
    if (ranks.separate_count() > 1 && !options.samples)
        throw InputError(fmt::format(
            "{} tasks were started that know nothing of each other, and each would render the whole image: use mpirun "
            "or "
            "srun --mpi=pmix, or give each its --samples, or unset SLURM_STEP_NUM_TASKS where each renders its own",
            ranks.separate_count()));
    if (ranks.count() > 1)
        for (const auto& [flag, is_given] : {std::pair{"--trace", !options.trace.empty()},
                                             {"--cost-image", !options.cost_image.empty()},
                                             {"--aovs", options.has_aovs},
                                             {"--crop", options.crop.has_value()},
                                             {"--pixel", options.pixel.has_value()}})
            if (is_given) throw InputError(fmt::format("{}: is not made by several ranks", flag));
    if (ranks.is_first()) return claim(options.checkpoint);
    options.output.clear();
    options.stats.clear();
    options.status.clear();
    options.preview = {};
    options.is_quiet = true;
    return nullptr;
}

/// What ranks must have in common: the program, the image with its samples, what they tell each other and when, what
/// reports add up, and files, which would be lost if only another rank than the first were asked for them. `options`
/// are as the rank was given them.
ImageKey shared_terms(const Scene& scene, const RenderRecord& record, const RenderOptions& options) {
    const nlohmann::json program = environment_json();
    const bool is_exact = !engines().find(record.engine).has_pool || !adds_reals(record.pool.accumulator);
    const auto is_named = [](const std::string& file) { return file.empty() ? "none" : "a file"; };
    const auto is_on = [](bool flag) { return flag ? "on" : "off"; };
    ImageKey terms{{"command", "render"},
                   {"version", program["version"].get<std::string>()},
                   {"commit", program["commit"].get<std::string>()}};
    for (auto& term : image_key(scene, record)) terms.push_back(std::move(term));
    const RenderSettings& settings = record.settings;
    const ImageKey protocol{{"spp", fmt::to_string(record.spp)},
                            {"samples", fmt::format("{}:{}", settings.first_sample, settings.end_sample)},
                            {"checkpoint", is_named(options.checkpoint.file)},
                            {"resume", is_on(options.checkpoint.is_resumed)},
                            {"output", is_named(options.output)},
                            {"stats", is_named(options.stats)},
                            {"count_work", is_on(options.count_work)},
                            {"accumulator", is_exact ? "exact" : options.pool.accumulator}};
    terms.insert(terms.end(), protocol.begin(), protocol.end());
    return terms;
}

int render(RenderOptions& options, cluster::Ranks& ranks) {
    const Stopwatch total;
    const RenderOptions given = options;
    check_distinct({{"--output", options.output},
                    {"--checkpoint", options.checkpoint.file},
                    {"--stats", options.stats},
                    {"--status", options.status},
                    {"--preview", options.preview.file},
                    {"--trace", options.trace},
                    {"--cost-image", options.cost_image}},
                   {{"the scene", options.scene}});
    const std::unique_ptr<FileLock> lock = make_ready(options, ranks);
    RenderRecord record = start_record(options);
    std::optional<ImageTarget> target;
    if (!options.output.empty()) {
        target = parse_image_target(options.output);
        if (target->is_stdout) options.is_quiet = true;
        check_writable(target->file);
    }
    for (const auto& [flag, is_given] : {std::pair{"--aovs", options.has_aovs}, {"--half", options.is_half}})
        if (is_given && (!target || target->format != ImageFormat::Exr))
            throw InputError(fmt::format("{}: only an .exr file has room for that: name one by --output", flag));
    if (!options.stats.empty()) check_writable(options.stats);
    if (!options.cost_image.empty()) {
        if (image_format(options.cost_image) == ImageFormat::Png)
            throw InputError(fmt::format("--cost-image: {}: a PNG file has no room for values; name an .exr or a .pfm",
                                         options.cost_image));
        check_writable(options.cost_image);
    }
    Trace trace;
    if (!options.trace.empty()) {
        check_writable(options.trace);
        record.settings.trace = &trace;
    }

    Stopwatch watch;
    Scene scene = scene_of(options);
    add_scene(record, scene, options, ranks.on_this_machine());
    CostImage cost(cost_of(options.cost), options.cost_image.empty() ? 0 : scene.width, scene.height);
    if (!options.cost_image.empty()) record.settings.cost_image = &cost;
    if (!options.checkpoint.file.empty() && engines().find(record.engine).has_pool &&
        adds_reals(record.pool.accumulator))
        throw InputError("--accumulator: atomic-float and atomic-double have no exact sums to keep in a --checkpoint");
    std::vector<std::uint32_t> pixels;
    if (options.crop || options.pixel) {
        pixels = pixels_of(record.crop, scene.width);
        record.settings.pixels = &pixels;
    }
    record.read_s = watch.seconds();

    if (ranks.count() > 1) cluster::agree(ranks, shared_terms(scene, record, given));

    std::optional<Preview> preview;
    if (!options.preview.file.empty() || !options.preview.server.empty())
        preview.emplace(options.preview, record.scene_name, record.crop);
    CheckpointKeeper checkpoint(options.checkpoint, preview ? &*preview : nullptr, ranks);
    const RenderedImage rendered = render_image(scene, options, checkpoint, ranks, record);
    const Image& image = rendered.image;
    watch.lap();
    std::exception_ptr failure = checkpoint.failure();  // what cannot be written costs nothing else
    const auto attempt = [&failure](const std::string& file, const auto& write) {
        try {
            if (!file.empty()) write(file);
        } catch (...) {
            if (!failure) failure = std::current_exception();
        }
    };
    attempt(options.output, [&](const auto&) {
        write_image(target->file, target->format, image, image_attributes(record), {rendered.aovs, options.is_half});
        if (options.is_half) warn_of_infinite_halves(options.output, image);
    });
    record.write_s = watch.seconds();
    record.total_s = total.seconds();
    attempt(options.stats, [&](const auto& file) { write_json(file, stats_json(record)); });
    attempt(options.cost_image, [&](const auto&) { write_cost_image(options, cost, record); });
    attempt(options.trace, [&](const auto& file) { write_trace(file, trace, image_attributes(record)); });
    if (failure) std::rethrow_exception(failure);

    const int signal = checkpoint.stopped_by();
    if (signal != 0 && ranks.is_first() && !CheckpointKeeper::has_said_so())
        print(stderr,
              "raypool: stopped; {} holds {} samples a pixel: the same command with --resume goes on from there\n",
              options.checkpoint.file, record.samples_done);
    const bool is_missed = ranks.is_first() && signal == 0 && misses_target(record);
    if (is_missed) print_miss(record);
    const int status = signal != 0 ? 128 + signal : is_missed ? 1 : 0;
    if (options.is_quiet) return status;
    print_summary(record);
    if (!options.output.empty()) print("{}\n", options.output);
    if (!options.cost_image.empty()) print("{}\n", options.cost_image);
    if (!options.trace.empty()) print_trace(options.trace, trace);
    return status;
}

}  // namespace

void add_render_command(CLI::App& app, cluster::Ranks& ranks, int& status) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* command = app.add_subcommand("render", "Render a scene, print its figures and the hash of its sums");
    add_render_options(*command, *options);
    command->callback([options, command, &ranks, &status] {
        options->engine = engine_in_effect(*command);
        status = render(*options, ranks);
    });
}

}  // namespace raypool::cli
