// From the paper's tracer to the fastest pool, a rung at a time: how fast each is, and where its time goes.

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "bench/studies/record_traffic.h"
#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
#include "core/runtime/settings_text.h"
#include "wavefront/ladder.h"
#include "wavefront/pool_report.h"

#ifdef RAYPOOL_HAS_EMBREE
#include "bench/peers/embree_engine.h"
#endif

namespace raypool::studies {

namespace {

using wavefront::pool_report;
using wavefront::RoundReport;
using wavefront::Stage;

/// Seconds of a stage, all threads and rounds.
double stage_s(const RenderReport& report, Stage stage) {
    double sum = 0;
    for (const RoundReport& round : pool_report(report).rounds) sum += round.stage_s[static_cast<std::size_t>(stage)];
    return sum;
}

/// Where the time of a pool goes whose rounds were logged; scripts/analysis/ladder.py stacks the parts.
Cells parts_of_pool(const RenderReport& report, const Features& features, const wavefront::PoolSettings& pool) {
    double records_in = 0;
    double records_out = 0;
    double barrier_s = 0;
    for (const RoundReport& round : pool_report(report).rounds) {
        records_in += static_cast<double>(round.records_in);
        records_out += static_cast<double>(round.records_out);
        barrier_s += round.wait_s;
    }
    const double shade_s = stage_s(report, Stage::Shade);
    const double survivors = records_in == 0 ? 0 : std::min(records_out / records_in, 1.0);
    const double traffic_s =
        std::min(shade_s, records_in * record_pass_s(features, pool.width, pool.capacity, survivors));
    const std::vector<double> waits = by_thread(report, &ThreadReport::wait_s);
    const double end_s = std::max(0.0, std::accumulate(waits.begin(), waits.end(), 0.0) - barrier_s);
    return {{"generate_s", stage_s(report, Stage::Generate)},
            {"intersect_s", stage_s(report, Stage::Intersect)},
            {"shade_s", shade_s - traffic_s},
            {"sort_s", stage_s(report, Stage::Sort)},
            {"shadow_s", stage_s(report, Stage::Shadow)},
            {"accumulate_s", stage_s(report, Stage::Accumulate)},
            {"traffic_s", traffic_s},
            {"append_s", stage_s(report, Stage::Append)},
            {"barrier_s", barrier_s},
            {"end_s", end_s}};
}

std::vector<Case> ladder_cases(const StudyOptions& options) {
    const auto scene = study_scene(options.scene, choose(options, options.width, {200, 400}));
    const Plan plan = plan_of(options, {8, 24}, {5, 7}, core_count());
    RenderSettings settings = plan.settings;
    settings.schedule = parse_schedule("dynamic");
    if (scene->compiled.features.lights) settings.light_sampling = LightSampling::Mis;
    std::vector<Case> cases;
    const auto add_rate = [&](const NamedEngine& engine) {
        const auto more = [](const RenderReport& report) {
            return Cells{{"segments", report.segments()}, {"clocks", "off"}};
        };
        cases.push_back(render_case(fmt::format("{}, {} threads", engine.name, settings.threads),
                                    {engine, scene, settings}, plan.repeats, more));
    };
    const auto add_split = [&](const wavefront::Rung& rung) {
        RenderSettings logged = settings;
        logged.log_rounds = true;
        const auto more = [scene, pool = rung.pool](const RenderReport& report) {
            return Cells{{"segments", report.segments()}, {"clocks", "on"}} +
                   parts_of_pool(report, scene->compiled.features, pool);
        };
        cases.push_back(render_case(fmt::format("{}, {} threads, clocks on", rung.name, settings.threads),
                                    {pool_engine(rung.name, rung.pool), scene, logged}, plan.repeats, more));
    };
    for (const int threads : one_and_all(plan.most_threads)) {
        settings.threads = threads;
        const std::vector<wavefront::Rung> rungs = wavefront::ladder(threads);
        add_rate(recursive_engine());
        add_rate(iterative_engine());
        for (const wavefront::Rung& rung : rungs) add_rate(pool_engine(rung.name, rung.pool));
        for (const wavefront::Rung& rung : rungs) add_split(rung);
#ifdef RAYPOOL_HAS_EMBREE
        using peers::EmbreeEngine;
        using peers::EmbreeRays;
        if (!scene->compiled.instance_tree.blocks.empty()) continue;  // which they have not
        for (const NamedEngine& engine :
             {NamedEngine{"Embree, single rays", std::make_shared<EmbreeEngine>(EmbreeRays::Single)},
              NamedEngine{"Embree, packets", std::make_shared<EmbreeEngine>(EmbreeRays::Packet)}}) {
            add_rate(engine);
            cases.back().image.clear();  // a hit that Embree's rounding loses must not stop the study
        }
#endif
    }
    return cases;
}

}  // namespace

Study ladder_study() {
    return {
        .name = "ladder",
        .question = "What does each step from recursion to the fastest pool gain, and where does the time go?",
        .columns = render_columns(
            {{"segments", ColumnType::Count, "rays traced"},
             {"clocks", ColumnType::Text, "on: stages were timed, which costs a little; rates are those with off"},
             {"generate_s", ColumnType::Real, "bringing in camera rays, all threads (so all below); seconds"},
             {"intersect_s", ColumnType::Real, "finding the closest hits; seconds"},
             {"shade_s", ColumnType::Real, "shading, without traffic_s; seconds"},
             {"sort_s", ColumnType::Real, "sorting records; seconds"},
             {"shadow_s", ColumnType::Real, "tracing shadow rays, where a scene has lights; seconds"},
             {"accumulate_s", ColumnType::Real, "adding radiance to the framebuffer; seconds"},
             {"traffic_s", ColumnType::Real,
              "estimate: reading and writing records while shading, records times a pass that does only that; seconds"},
             {"append_s", ColumnType::Real, "passing survivors on to the next round; seconds"},
             {"barrier_s", ColumnType::Real, "waiting at the barriers of rounds; seconds"},
             {"end_s", ColumnType::Real, "waiting for the last thread; seconds"}}),
        .cases = ladder_cases,
        .facts = rung_facts};
}

}  // namespace raypool::studies
