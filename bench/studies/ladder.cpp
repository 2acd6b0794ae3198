// From the paper's tracer to the fastest pool, a rung at a time: how fast each is, and where its time goes.

#include <algorithm>
#include <array>
#include <numeric>

#include <fmt/format.h>

#include "bench/studies/record_traffic.h"
#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
#include "bench/studies/studies.h"
#include "bench/studies/verdict.h"
#include "core/runtime/settings_text.h"
#include "wavefront/engine.h"
#include "wavefront/ladder.h"

#ifdef RAYPOOL_HAS_EMBREE
#include "bench/peers/embree_engine.h"
#endif

namespace raypool::studies {

namespace {

/// Where time goes, as columns; scripts/plots/ladder.py stacks them.
constexpr std::array<const char*, 9> kParts{"generate_s", "intersect_s", "shade_s",   "sort_s", "accumulate_s",
                                            "traffic_s",  "append_s",    "barrier_s", "end_s"};
constexpr const char* kRecursive = "recursive";
constexpr const char* kCanonical = "shared-stream";
constexpr const char* kFastest = "beam";
constexpr bool kIsAvx512 = stdx::native_simd<float>::size() == 16;

/// Seconds of a stage, all threads and rounds.
double stage_s(const RenderReport& report, Stage stage) {
    double sum = 0;
    for (const RoundReport& round : report.rounds) sum += round.stage_s[static_cast<std::size_t>(stage)];
    return sum;
}

/// What the columns of kParts are for a pool whose rounds were logged.
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
    const double traffic_s = std::min(shade_s, records_in * record_pass_s(features, pool.width, pool.capacity, survivors));
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
    return Row(kParts.size(), nullptr);
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
        for (const Value& part : parts_of_pool(measured.report, scene->compiled.features, rung.pool)) row.push_back(part);
        return {row};
    };
    return {fmt::format("{}, {} threads, clocks on", rung.name, settings.threads), image_of(*scene, settings), repeats,
            run};
}

/// Time of a thread for each segment, ns.
std::vector<double> ns_per_segment(const Table& rows) {
    std::vector<double> ns;
    const std::vector<double> seconds = rows.numbers("seconds");
    const std::vector<double> threads = rows.numbers("threads");
    const std::vector<double> segments = rows.numbers("segments");
    for (std::size_t i = 0; i < seconds.size(); ++i) ns.push_back(seconds[i] * threads[i] / segments[i] * 1e9);
    return ns;
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

    [[nodiscard]] Summary summarise(const Table& data, const StudyOptions&) const override {
        Summary summary;
        std::vector<double> overheads;
        for (const Value& threads : data.distinct("threads")) {
            const Table here = data.where("threads", threads);
            summary.tables.push_back(rates(here, threads.get<int>()));
            summary.tables.push_back(parts(here, threads.get<int>()));
            for (const Value& engine : here.distinct("engine")) {
                const std::vector<double> cost = clock_cost(here.where("engine", engine));
                overheads.insert(overheads.end(), cost.begin(), cost.end());
            }
        }
        add_findings(summary, data);
        summary.pictures.push_back(
            {"ladder", "Where the time goes, rung by rung",
             "Each bar is the time of a thread for one ray (median run, so shorter is better); at its end, how many "
             "times as fast as recursion, with the lowest and highest run. What to see: which part of a bar "
             "each step shortens: useful work is blue and green, waiting red, moving records orange. A whole path of "
             "recursion, or of Embree, has no stages to tell apart."});
        const Spread overhead = spread(overheads);
        summary.notes.push_back(fmt::format(
            "The split is that of runs with clocks on, which take {} times as long (all rungs); rates and ratios are "
            "of runs with clocks off.",
            to_text(overhead, 3)));
        summary.notes.push_back(
            "Moved records: an estimate, from the number of records shaded and a pass, measured beside each run, that "
            "reads and writes records and does nothing else; it is taken off shading.");
        summary.notes.push_back(
            "Barriers: waiting for the slowest thread of a round and the barrier itself, which a clock cannot tell "
            "apart. The rest of a bar is what no clock saw: starting threads, clearing memory, the loops themselves.");
        return summary;
    }

  private:
    static std::vector<double> rate(const Table& data, const std::string& engine) {
        return data.where("clocks", "off").where("engine", engine).numbers("mpaths_per_s");
    }
    /// Time with clocks over time without, where there are both.
    static std::vector<double> clock_cost(const Table& engine) {
        return ratios(engine.where("clocks", "on").numbers("seconds"),
                      engine.where("clocks", "off").numbers("seconds"));
    }

    static TextTable rates(const Table& here, int threads) {
        TextTable table{fmt::format("Rates, {} thread{}", threads, threads == 1 ? "" : "s"),
                        {"rung", "M paths/s", "ratio to recursive", "waiting", "cost of the clocks"},
                        {}};
        for (const Value& engine : here.distinct("engine")) {
            const auto name = engine.get<std::string>();
            const Table rows = here.where("engine", engine);
            const std::vector<double> waits = rows.where("clocks", "off").numbers("waiting");
            const std::vector<double> cost = clock_cost(rows);
            table.rows.push_back({name, to_text(spread(rate(here, name))),
                                  to_text(spread(ratios(rate(here, name), rate(here, kRecursive)))),
                                  waits.empty() ? "" : fmt::format("{:.1f} %", 100 * median(waits)),
                                  cost.empty() ? "" : to_text(spread(cost))});
        }
        return table;
    }

    static TextTable parts(const Table& here, int threads) {
        TextTable table{
            fmt::format("Time of a thread for each segment, ns, {} thread{}", threads, threads == 1 ? "" : "s"),
            {"rung", "generate", "intersect", "shade", "sort", "accumulate", "moved records (estimate)", "append",
             "barriers", "waiting at the end", "rest", "in all"},
            {}};
        const Table split = here.where("clocks", "on");
        for (const Value& engine : split.distinct("engine")) {
            const Table rows = split.where("engine", engine);
            const double all = median(ns_per_segment(rows));
            const double segments = rows.numbers("segments").front();
            std::vector<std::string> line{engine.get<std::string>()};
            double rest = all;
            for (const char* part : kParts) {
                const double ns = median(rows.numbers(part)) / segments * 1e9;
                rest -= ns;
                line.push_back(fmt::format("{:.2f}", ns));
            }
            line.push_back(fmt::format("{:.2f}", std::max(rest, 0.0)));
            line.push_back(fmt::format("{:.2f}", all));
            table.rows.push_back(std::move(line));
        }
        return table;
    }

    /// What the project set out to reach.
    static void add_findings(Summary& summary, const Table& data) {
        const auto add = [&](const char* engine, const char* claim, int threads, double least,
                             const std::string& note) {
            const Table here = data.where("threads", threads);
            const Spread ratio = spread(ratios(rate(here, engine), rate(here, kRecursive)));
            const std::string ours =
                fmt::format("{} ({}), {} thread{}", to_text(ratio), engine, threads, threads == 1 ? "" : "s");
            const std::string asked = fmt::format("at least {:g} times as fast{}", least, note);
            summary.findings.push_back({"", claim, asked, ours, is_at_least(ratio, least), why_open(ratio, least)});
        };
        const std::vector<double> counts = data.numbers("threads");
        const int most = static_cast<int>(*std::max_element(counts.begin(), counts.end()));
        add(kFastest, "a pool is much faster than the best recursion", 1, kIsAvx512 ? 4 : 2.5,
            kIsAvx512 ? " (AVX-512)" : " (AVX2)");
        if (most == 2)
            add(kCanonical, "the paper's shared pool, with wide stages, is faster than recursion", 2, 1.5, "");
    }
};

}  // namespace

std::unique_ptr<Study> ladder_study() {
    return std::make_unique<Ladder>();
}

}  // namespace raypool::studies
