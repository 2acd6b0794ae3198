// Speedup and efficiency by image width, threads and engine: the paper's Tables 1 and 2, Figures 7 and 12.

#include <algorithm>

#include <fmt/format.h>

#include "bench/studies/openmp_costs.h"
#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "bench/studies/replay_ways.h"
#include "wavefront/settings.h"

namespace raypool::studies {

namespace {

constexpr int kMostScaledThreads = 64;

/// An engine, and the replay of its schedule.
struct ScalingWay {
    NamedEngine engine;
    LoopWay loop;
    ReplayWay replayed;
};
std::vector<ScalingWay> scaling_ways() {
    std::vector<ScalingWay> ways;
    for (const LoopWay& way : {LoopWay{"recursion, lines, static (the paper's basic)", "line", "static"},
                               {"recursion, lines, static,1", "line", "static,1"},
                               {"recursion, lines, dynamic", "line", "dynamic"}})
        ways.push_back({recursive_engine(), way, loop_way(way)});
    const LoopWay shared{"a pool for all threads, batches of 4096", "line", "dynamic"};
    ReplayWay drained = loop_way(shared);
    drained.kind = ReplayWay::Kind::Drained;
    drained.capacity = static_cast<std::size_t>(wavefront::PoolSettings::kSharedCapacity);
    drained.batch = static_cast<std::size_t>(wavefront::PoolSettings{}.batch);
    ways.push_back({canonical_pool(), shared, drained});
    const LoopWay own{"a pool for each thread, balanced (default)", "pixel", "balanced"};
    ways.push_back({fused_pool(), own, thread_pool_way(own)});
    return ways;
}

std::vector<Cells> measured_scaling(const Render& render, const char* way) {
    const double loop = compute_loop_seconds(render.settings.threads, 0.02);
    const Measured measured = measure(render);
    return {Cells{{"source", "measured"},
                  {"way", way},
                  {"width", render.scene->compiled.width},
                  {"threads", render.settings.threads},
                  {"seconds", measured.report.seconds},
                  {"loop_seconds", loop},
                  {"hash", measured.hash}}};
}

std::vector<Cells> replayed_scaling(const StudyScene& scene, const RenderSettings& settings, int most) {
    const PathCosts costs = record_costs(scene, settings);
    const CostModel model = fit_costs(scene, settings, costs, 2).model;
    const OpenMpCosts openmp = measure_openmp_costs(most);
    std::vector<Cells> rows;
    for (const ScalingWay& way : scaling_ways()) {
        const bool is_pool = way.replayed.kind != ReplayWay::Kind::Loop;
        const PreparedWay prepared = prepare(
            way.replayed, costs, is_pool ? scaled_to(*way.engine.engine, scene, settings, costs, model, 2) : model);
        const double one = prepared.replay(1, openmp.at(1), {}).makespan;
        for (const int threads : thread_counts(most))
            rows.push_back(
                {{"source", "replayed"},
                 {"way", way.loop.name},
                 {"width", scene.compiled.width},
                 {"threads", threads},
                 {"efficiency", one / (threads * prepared.replay(threads, openmp.at(threads), {}).makespan)}});
    }
    return rows;
}

std::vector<Case> scaling_cases(const StudyOptions& options) {
    std::vector<std::int64_t> widths{400, 560, 800, 1200, 1600};  // the paper's
    if (options.is_quick) widths = {400, 800};
    if (options.width != 0) widths = {std::max<std::int64_t>(options.width / 2, 1), options.width};
    if (widths.front() == widths.back()) widths.pop_back();
    const Plan plan = plan_of(options, {2, 2}, {3, 5}, kMostScaledThreads);
    const int most = plan.most_threads;

    std::vector<Case> cases;
    for (const std::int64_t width : widths) {
        const auto scene = study_scene(options.scene, width);
        RenderSettings settings;
        for (const ScalingWay& way : scaling_ways()) {
            settings = with_way(plan.settings, way.loop);
            for (const int threads : thread_counts(std::min(core_count(), most))) {
                settings.threads = threads;
                cases.push_back(
                    case_of(fmt::format("width {}, {} threads, {}", width, threads, way.loop.name),
                            {way.engine, scene, settings}, plan.repeats,
                            [name = way.loop.name](const Render& render) { return measured_scaling(render, name); }));
            }
        }
        cases.push_back({fmt::format("width {}, replayed", width), "", 1,
                         [=] { return replayed_scaling(*scene, settings, most); }});
    }
    return cases;
}

}  // namespace

Study scaling_study() {
    return {
        .name = "scaling",
        .question = "How does each engine scale with threads and with the size of the image?",
        .columns = {{"source", ColumnType::Text, "measured, or replayed (balance, barriers and chunk fetches only)"},
                    {"way", ColumnType::Text, "engine, grain and schedule"},
                    {"width", ColumnType::Count, "of the image, pixels"},
                    {"threads", ColumnType::Count, "real or replayed"},
                    {"seconds", ColumnType::Real, "measured: wall clock of the parallel region"},
                    {"loop_seconds", ColumnType::Real,
                     "measured: of a compute loop with equal shares, beside the render"},
                    {"efficiency", ColumnType::Real, "replayed: speedup over threads"},
                    {"hash", ColumnType::Text, "measured: of the sums of the image"}},
        .cases = scaling_cases,
        .facts = [] {
            return nlohmann::json{{"cores", core_count()}};
        }};
}

}  // namespace raypool::studies
