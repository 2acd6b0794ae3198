// From the paper's tracer to the fastest pool, a rung at a time: how fast each is, and where its time goes.

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "bench/studies/record_traffic.h"
#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
#include "bench/studies/studies.h"
#include "core/runtime/settings_text.h"
#include "wavefront/engine.h"
#include "wavefront/ladder.h"

#ifdef RAYPOOL_HAS_EMBREE
#include "bench/peers/embree_engine.h"
#endif

namespace raypool::studies {

namespace {

/// Columns of where time goes, from generate_s on; scripts/analysis/ladder.py stacks them.
constexpr std::size_t kPartCount = 9;

/// Seconds of a stage, all threads and rounds.
double stage_s(const RenderReport& report, Stage stage) {
    double sum = 0;
    for (const RoundReport& round : report.rounds) sum += round.stage_s[static_cast<std::size_t>(stage)];
    return sum;
}

/// These columns of a pool whose rounds were logged.
Row parts_of_pool(const RenderReport& report, const Features& features, const wavefront::PoolSettings& pool) {
    double records_in = 0;
    double records_out = 0;
    double barrier_s = 0;
    for (const RoundReport& round : report.rounds) {
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
    return {stage_s(report, Stage::Generate),
            stage_s(report, Stage::Intersect),
            shade_s - traffic_s,
            stage_s(report, Stage::Sort),
            stage_s(report, Stage::Accumulate),
            traffic_s,
            stage_s(report, Stage::Append),
            barrier_s,
            end_s};
}

/// A run whose time is not split.
Row no_parts() {
    return Row(kPartCount, nullptr);
}

Case rate_case(const NamedEngine& engine, const std::shared_ptr<const StudyScene>& scene,
               const RenderSettings& settings, int repeats) {
    const auto run = [engine, scene, settings]() -> std::vector<Row> {
        const Measured measured = measure(*engine.engine, *scene, settings);
        Row row = render_row(engine.name, *engine.engine, *scene, settings, measured);
        row.insert(row.end(), {measured.report.segments(), "off"});
        for (const Value& part : no_parts()) row.push_back(part);
        return {row};
    };
    return {fmt::format("{}, {} threads", engine.name, settings.threads), image_of(*scene, settings), repeats, run};
}

Case split_case(const wavefront::Rung& rung, const std::shared_ptr<const StudyScene>& scene, RenderSettings settings,
                int repeats) {
    settings.log_rounds = true;
    const auto run = [rung, scene, settings]() -> std::vector<Row> {
        const wavefront::WavefrontEngine engine(rung.pool);
        const Measured measured = measure(engine, *scene, settings);
        Row row = render_row(rung.name, engine, *scene, settings, measured);
        row.insert(row.end(), {measured.report.segments(), "on"});
        for (const Value& part : parts_of_pool(measured.report, scene->compiled.features, rung.pool))
            row.push_back(part);
        return {row};
    };
    return {fmt::format("{}, {} threads, clocks on", rung.name, settings.threads), image_of(*scene, settings), repeats,
            run};
}

class Ladder : public Study {
  public:
    [[nodiscard]] std::string name() const override { return "ladder"; }
    [[nodiscard]] std::string question() const override {
        return "What does each step from recursion to the fastest pool gain, and where does the time go?";
    }
    [[nodiscard]] std::vector<Column> columns() const override {
        std::vector<Column> columns = render_columns();
        columns.insert(
            columns.end(),
            {{"segments", ColumnType::Count, "rays traced"},
             {"clocks", ColumnType::Text, "on: stages were timed, which costs a little; rates are those with off"},
             {"generate_s", ColumnType::Real, "bringing in camera rays, all threads (so all below); seconds"},
             {"intersect_s", ColumnType::Real, "finding the closest hits; seconds"},
             {"shade_s", ColumnType::Real, "shading, without traffic_s; seconds"},
             {"sort_s", ColumnType::Real, "sorting records; seconds"},
             {"accumulate_s", ColumnType::Real, "adding radiance to the framebuffer; seconds"},
             {"traffic_s", ColumnType::Real,
              "estimate: reading and writing records while shading, records times a pass that does only that; seconds"},
             {"append_s", ColumnType::Real, "passing survivors on to the next round; seconds"},
             {"barrier_s", ColumnType::Real, "waiting at the barriers of rounds; seconds"},
             {"end_s", ColumnType::Real, "waiting for the last thread; seconds"}});
        return columns;
    }

    [[nodiscard]] std::vector<Case> cases(const StudyOptions& options) const override {
        const std::int64_t width = choose(options.width, options.is_quick, 200, 400);
        const auto scene = study_scene(options.scene, width);
        RenderSettings settings;
        settings.end_sample = choose(options.spp, options.is_quick, 8, 24);
        settings.depth = static_cast<std::int32_t>(choose(options.depth, options.is_quick, 50, 50));
        settings.seed = options.seed;
        settings.schedule = parse_schedule("dynamic");
        const int repeats = static_cast<int>(choose(options.repeats, options.is_quick, 5, 7));
        const int most = static_cast<int>(choose(options.threads, false, 0, core_count()));

        std::vector<Case> cases;
        for (const int threads : one_and_all(most)) {
            settings.threads = threads;
            for (const NamedEngine& engine : {recursive_engine(), iterative_engine()})
                cases.push_back(rate_case(engine, scene, settings, repeats));
            for (const NamedEngine& engine : ladder_engines(threads))
                cases.push_back(rate_case(engine, scene, settings, repeats));
            for (const wavefront::Rung& rung : wavefront::ladder(threads))
                cases.push_back(split_case(rung, scene, settings, repeats));
#ifdef RAYPOOL_HAS_EMBREE
            using peers::EmbreeEngine;
            using peers::EmbreeRays;
            for (const NamedEngine& engine :
                 {NamedEngine{"Embree, single rays", std::make_shared<EmbreeEngine>(EmbreeRays::Single)},
                  NamedEngine{"Embree, packets", std::make_shared<EmbreeEngine>(EmbreeRays::Packet)}}) {
                cases.push_back(rate_case(engine, scene, settings, repeats));
                cases.back().image.clear();  // a hit that Embree's rounding loses must not stop the study
            }
#endif
        }
        return cases;
    }
};

}  // namespace

std::unique_ptr<Study> ladder_study() {
    return std::make_unique<Ladder>();
}

}  // namespace raypool::studies
