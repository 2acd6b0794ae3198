#include "cli/render_image.h"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <memory>
#include <numeric>

#include <fmt/format.h>

#include "cli/engines.h"
#include "cli/path_printer.h"
#include "cli/progress_bar.h"
#include "cli/status_file.h"
#include "cluster/exchange.h"
#include "cluster/rank_engine.h"
#include "core/runtime/progressive.h"
#include "core/scene/scene_hash.h"

namespace raypool::cli {

namespace {

std::unique_ptr<Engine> make_engine(const RenderRecord& record, cluster::Ranks& ranks) {
    std::unique_ptr<Engine> own = engines().find(record.engine).make(engine_options(record));
    return ranks.count() == 1 ? std::move(own) : std::make_unique<cluster::RankEngine>(std::move(own), ranks);
}

/// Renders what `sums` lacks, and keeps checkpoints.
template <class Scalar>
RenderReport render_missing(const Engine& engine, const CompiledScene<Scalar>& scene, const RenderRecord& record,
                            Checkpoint& sums, AdaptiveReport& adaptive, CheckpointKeeper& checkpoint) {
    if (record.target_error > 0) {
        std::vector<std::int32_t> counts = sums.sample_counts;
        if (counts.empty()) counts.resize(static_cast<std::size_t>(scene.pixel_count()));
        AdaptivePlan plan({record.target_error, greatest_sample(scene, record.settings), record.settings.end_sample},
                          std::move(counts), sums.rounds);
        const auto keep = [&] {
            sums.sample_counts = plan.sample_counts();
            sums.rounds = plan.rounds();
            return checkpoint.keep(sums, [] {});  // a round ends merged
        };
        RenderReport report = render_adaptively(engine, scene, record.settings, plan, sums.framebuffer, keep);
        adaptive = plan.report();
        return report;
    }
    std::unique_ptr<RenderSession> session;
    for (const SampleRange& gap : gaps(sums.ranges, record.settings.end_sample)) {
        RenderSettings settings = record.settings;
        settings.first_sample = std::max(gap.first, settings.first_sample);
        settings.end_sample = gap.end;
        if (settings.first_sample >= settings.end_sample) continue;
        if (session == nullptr) session = engine.begin(scene, settings, sums.framebuffer);
        if (!checkpoint.wants_pieces()) {
            session->add({settings.first_sample, settings.end_sample, settings.pixels});
            sums.ranges = with_range(std::move(sums.ranges), {settings.first_sample, settings.end_sample});
            continue;
        }
        render_in_pieces(*session, settings, [&](const SampleRange& range) {
            sums.ranges = with_range(std::move(sums.ranges), range);
            return checkpoint.keep(sums, [&] { session->merge(); });
        });
        if (checkpoint.stopped_by() != 0) break;
    }
    if (session == nullptr) {
        RenderReport nothing;
        nothing.threads.resize(static_cast<std::size_t>(record.settings.threads));
        return nothing;
    }
    return session->finish();
}

template <class Scalar>
RenderedImage render_in(const Scene& scene, const RenderOptions& options, CheckpointKeeper& checkpoint,
                        cluster::Ranks& ranks, RenderRecord& record) {
    const CompiledScene<Scalar> compiled = compile_for<Scalar>(record, scene);
    const bool is_adaptive = record.target_error > 0;
    Checkpoint sums{image_key(scene, record), record.spp, {}, {}, 0, make_sums(record, compiled)};
    if (options.checkpoint.is_resumed) {
        if (ranks.is_first())
            sums =
                load_checkpoint(options.checkpoint, sums, {record.settings.first_sample, record.settings.end_sample});
        cluster::broadcast(ranks, sums);
    }
    Progress progress;
    record.settings.progress = &progress;
    progress.paths = is_adaptive
                         ? std::accumulate(sums.sample_counts.begin(), sums.sample_counts.end(), std::int64_t{0})
                         : compiled.pixel_count() * sums.sample_count();
    progress.before = progress.paths.load();
    std::vector<ImageChannel> aovs;
    {
        // How many samples an adaptive render will take is not known.
        const std::int64_t total = is_adaptive ? 0 : path_count(compiled, record.settings);
        const StatusFile status(options.status, "render", "paths", progress, total);
        const ProgressBar bar(progress, total, {"M paths/s", 1e-6}, options.is_quiet);
        const std::unique_ptr<Engine> engine = make_engine(record, ranks);
        record.report = render_missing(*engine, compiled, record, sums, record.adaptive, checkpoint);
        aovs = make_aovs(record, compiled, sums.framebuffer);  // before the render says that it is done
    }
    if (ranks.count() > 1) {
        record.ranks = cluster::gather(ranks, record.report);
        record.report = cluster::joined(record.ranks);
    }
    checkpoint.finish(sums);
    record.settings.progress = nullptr;
    record.samples_done = is_adaptive ? std::llround(record.adaptive.mean_samples()) : sums.sample_count();
    if constexpr (std::same_as<Scalar, float>)
        if (options.pixel) print_paths(scene, compiled, record, sums.framebuffer);
    return finish_record(record, scene, std::move(sums.framebuffer), std::move(aovs));
}

}  // namespace

ImageKey image_key(const Scene& scene, const RenderRecord& record) {
    const auto& [depth, seed, sampler, split_depth, roulette, light_sampling] =
        static_cast<const ImageSettings&>(record.settings);
    // What differs first is named, so a width goes before the scene, whose hash covers the size, and a height behind
    // it.
    return {{"image_version", fmt::to_string(kImageVersion)},
            {"width", fmt::to_string(scene.width)},
            {"scene", scene_hash(scene)},
            {"height", fmt::to_string(scene.height)},
            {"depth", fmt::to_string(depth)},
            {"split_depth", fmt::to_string(split_depth)},
            {"seed", fmt::to_string(seed)},
            {"sampler", sampler == Sampler::Sobol ? "sobol" : "independent"},
            {"roulette", roulette ? "on" : "off"},
            {"light_sampling", to_string(light_sampling)},
            {"precision", record.precision == Precision::Float ? "float" : "double"},
            {"target_error", fmt::to_string(record.target_error)}};
}

RenderedImage render_image(const Scene& scene, const RenderOptions& options, CheckpointKeeper& checkpoint,
                           cluster::Ranks& ranks, RenderRecord& record) {
    return record.precision == Precision::Double ? render_in<double>(scene, options, checkpoint, ranks, record)
                                                 : render_in<float>(scene, options, checkpoint, ranks, record);
}

}  // namespace raypool::cli
