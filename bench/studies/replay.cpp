// What every schedule would make of the same work with 1 to 4096 threads, and whether such a replay can be believed.

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "bench/studies/openmp_costs.h"
#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "bench/studies/replay_ways.h"
#include "bench/studies/statistics.h"
#include "core/base/first_exception.h"
#include "wavefront/settings.h"

namespace raypool::studies {

namespace {

constexpr int kMostThreads = 4096;
constexpr const char* kDefaultPool = "a pool each, balanced (default)";
constexpr const char* kThreadPools = "a pool for each thread";  ///< a group of ways

/// What a run of the recursive engine can be held against.
constexpr LoopWay kRealWays[] = {
    {"balanced (default)", "pixel", "balanced"},   {"lines, static", "line", "static"},
    {"lines, static,1", "line", "static,1"},       {"lines, dynamic", "line", "dynamic"},
    {"lines, guided", "line", "guided"},           {"pixels, static", "pixel", "static"},
    {"pixels, static,1", "pixel", "static,1"},     {"pixels, dynamic", "pixel", "dynamic"},
    {"pixels, dynamic,64", "pixel", "dynamic,64"}, {"tiles of 16, dynamic", "tile:16", "dynamic"},
};

struct GroupedWay {
    const char* group;
    ReplayWay way;
};

ReplayWay default_pool_way() {
    return thread_pool_way({kDefaultPool, "pixel", "balanced"});
}

std::vector<GroupedWay> all_ways() {
    using Kind = ReplaySchedule::Kind;
    constexpr ReplaySchedule kStatic{Kind::Static, 0};
    constexpr ReplaySchedule kDynamic{Kind::Dynamic, 1};
    const auto shared = static_cast<std::size_t>(wavefront::PoolSettings::kSharedCapacity);

    std::vector<GroupedWay> ways;
    for (const LoopWay& way : kRealWays)
        ways.push_back({way.grain == std::string("line") ? "recursion, by lines" : "recursion, by pixels and tiles",
                        loop_way(way)});
    const auto line_way = [&](const char* name, Kind kind) {
        ways.push_back({"recursion, by lines", {name, ReplayWay::Kind::Loop, parse_grain("line"), {kind, 0}, 0, 0}});
    };
    line_way("lines, longest first", Kind::LongestFirst);
    line_way("lines, factoring", Kind::Factoring);

    const auto drained = [&](const char* name, std::size_t capacity, std::size_t batch, ReplaySchedule schedule) {
        ways.push_back({"a pool for all threads", {name, ReplayWay::Kind::Drained, {}, schedule, capacity, batch}});
    };
    ways.push_back({"a pool for all threads",
                    {"refilled, sizes by threads (default)", ReplayWay::Kind::Regenerated, {}, kDynamic, 0, 0}});
    drained("65536 rays, batches of 4096", shared, 4096, kDynamic);
    drained("65536 rays, batches of 256", shared, 256, kDynamic);
    drained("65536 rays, contiguous shares", shared, 1, kStatic);
    drained("the whole image, batches of 256", 0, 256, kDynamic);
    drained("the whole image, contiguous shares", 0, 1, kStatic);

    ways.push_back({kThreadPools, default_pool_way()});
    for (const LoopWay& way : {LoopWay{"a pool each, lines, dynamic", "line", "dynamic"},
                               {"a pool each, lines, static", "line", "static"},
                               {"a pool each, tiles of 4, dynamic", "tile:4", "dynamic"},
                               {"a pool each, pixels, static,1", "pixel", "static,1"}})
        ways.push_back({kThreadPools, thread_pool_way(way)});
    return ways;
}

/// The costs of the study's paths, their model, and OpenMP's costs.
struct Work {
    Work(const std::shared_ptr<const StudyScene>& scene, const RenderSettings& settings, int repeats)
        : costs([=] { return record_costs(*scene, settings); }),
          fit([=, this] { return fit_costs(*scene, settings, costs(), repeats); }),
          pool_model([=, this] {
              return scaled_to(*fused_pool().engine, *scene, settings, costs(), fit().model, std::min(repeats, 3));
          }),
          openmp([] { return measure_openmp_costs(core_count()); }) {}
    Work(const Work&) = delete;  // its members ask each other
    Work& operator=(const Work&) = delete;

    Lazy<PathCosts> costs;
    Lazy<CostFit> fit;
    Lazy<CostModel> pool_model;  ///< of the default pool: the model in proportion
    Lazy<OpenMpCosts> openmp;
};

std::vector<Cells> replay_all(Work& work, const StudyScene& scene, const RenderSettings& settings, int most,
                              int repeats) {
    std::vector<Cells> rows;
    const PathCosts& costs = work.costs();
    const CostFit& fit = work.fit();
    const int renders = std::min(repeats, 3);
    const CostModel shared = scaled_to(*canonical_pool().engine, scene, settings, costs, fit.model, renders);
    const CostModel& own = work.pool_model();
    const auto add_model = [&](const char* engine, const CostModel& model, const Value& error) {
        rows.push_back({{"kind", "model"},
                        {"way", engine},
                        {"segment_ns", 1e9 * model.segment_s},
                        {"test_ns", 1e9 * model.test_s},
                        {"fit_error", error}});
    };
    add_model("recursion", fit.model, fit.error);
    add_model("a pool for all threads", shared, {});
    add_model(kThreadPools, own, {});

    const OpenMpCosts& openmp = work.openmp();
    for (std::size_t i = 0; i < openmp.threads.size(); ++i)
        rows.push_back({{"kind", "openmp"},
                        {"threads", openmp.threads[i]},
                        {"fetch_ns", 1e9 * openmp.fetch_s[i]},
                        {"barrier_ns", 1e9 * openmp.barrier_s[i]}});

    for (const GroupedWay& grouped : all_ways()) {  // no structured binding: clang 14 has none in parallel regions
        const ReplayWay& way = grouped.way;
        const PreparedWay tests = prepare(way, costs, kTests);
        const PreparedWay time = prepare(way, costs,
                                         way.kind == ReplayWay::Kind::Loop          ? fit.model
                                         : way.kind == ReplayWay::Kind::ThreadPools ? own
                                                                                    : shared);
        const std::vector<int> replayed = thread_counts(most);
        std::vector<Cells> filled(replayed.size());
        FirstException failure;
#pragma omp parallel for schedule(dynamic) num_threads(core_count())
        for (std::size_t i = 0; i < replayed.size(); ++i) {
            failure.run([&] {
                const int threads = replayed[i];
                const Replayed counted = tests.replay(threads, {}, {});
                const Replayed timed = time.replay(threads, {}, {});
                filled[i] = Cells{{"kind", "replayed"},
                                  {"group", grouped.group},
                                  {"way", way.name},
                                  {"threads", threads},
                                  {"efficiency_tests", counted.efficiency()},
                                  {"efficiency_time", timed.efficiency()},
                                  {"efficiency_costs", time.replay(threads, openmp.at(threads), {}).efficiency()},
                                  {"efficiency_bound", timed.total() / (threads * time.bound(threads))},
                                  {"max_over_mean", max_over_mean(counted.work)}};
            });
        }
        failure.rethrow();
        rows.insert(rows.end(), filled.begin(), filled.end());
    }
    return rows;
}

/// One thread and more; beside them, how fast each thread is when all do the same; and what a replay with threads
/// of these speeds makes of it.
std::vector<Cells> run_real(Work& work, Render render, const ReplayWay& way, int threads) {
    const bool is_pool = way.kind == ReplayWay::Kind::ThreadPools;
    const PreparedWay prepared = prepare(way, work.costs(), is_pool ? work.pool_model() : work.fit().model);
    const double alone = equal_work_seconds(*render.scene, render.settings, 1)[0];
    const double one = prepared.replay(1, work.openmp().at(1), {}).makespan;

    std::vector<Cells> rows;
    for (const int n : {1, threads}) {
        if (n == 1 && !rows.empty()) break;  // there is one core only
        std::vector<double> speeds = equal_work_seconds(*render.scene, render.settings, n);
        for (double& speed : speeds) speed = alone / speed;
        const Replayed replayed = prepared.replay(n, work.openmp().at(n), speeds);
        std::vector<double> busy = replayed.work;
        for (std::size_t i = 0; i < busy.size(); ++i) busy[i] /= speeds[i];

        render.settings.threads = n;
        const Measured measured = measure(render);
        const RenderReport& report = measured.report;
        const std::vector<double> processor = by_thread(report, &ThreadReport::processor_s);
        rows.push_back({{"kind", "real"},
                        {"way", way.name},
                        {"threads", n},
                        {"seconds", report.seconds},
                        {"processor_balance", 1 / max_over_mean(processor)},
                        {"on_processor", *std::max_element(processor.begin(), processor.end()) / report.seconds},
                        {"speed_low", *std::min_element(speeds.begin(), speeds.end())},
                        {"speed_high", *std::max_element(speeds.begin(), speeds.end())},
                        {"predicted", one / (n * replayed.makespan)},
                        {"predicted_balance", 1 / max_over_mean(busy)},
                        {"hash", measured.hash}});
    }
    return rows;
}

std::vector<Case> replay_cases(const StudyOptions& options) {
    const auto scene = study_scene(options.scene, choose(options, options.width, {400, 400}));
    const Plan plan = plan_of(options, {4, 16}, {5, 11}, kMostThreads);
    const RenderSettings& settings = plan.settings;
    const int real = std::min({2, core_count(), plan.most_threads});
    const auto work = std::make_shared<Work>(scene, settings, plan.repeats);

    std::vector<Case> cases;
    cases.push_back(
        {"replay", "", 1, [=] { return replay_all(*work, *scene, plan.settings, plan.most_threads, plan.repeats); }});
    const auto add_real = [&](const NamedEngine& engine, const ReplayWay& way, const RenderSettings& of_way) {
        cases.push_back(case_of(fmt::format("real, {}", way.name), {engine, scene, of_way}, plan.repeats,
                                [=](const Render& render) { return run_real(*work, render, way, real); }));
    };
    for (const LoopWay& way : kRealWays) add_real(recursive_engine(), loop_way(way), with_way(settings, way));
    add_real(fused_pool(), default_pool_way(), settings);
    return cases;
}

}  // namespace

Study replay_study() {
    return {
        .name = "replay",
        .question =
            "How well would each schedule balance this work over up to 4096 threads, and does a replay "
            "tell the truth?",
        .columns =
            {{"kind", ColumnType::Text, "replayed; real; openmp (what it costs); model (of a segment's time)"},
             {"group", ColumnType::Text, "of ways, as pictures show them"},
             {"way", ColumnType::Text, "grain and schedule, or pool"},
             {"threads", ColumnType::Count, "replayed or real"},
             {"efficiency_tests", ColumnType::Real, "replayed: work over the time of all threads, in tests"},
             {"efficiency_time", ColumnType::Real, "replayed: the same in modelled seconds"},
             {"efficiency_costs", ColumnType::Real, "replayed: the same with chunk fetches and barriers"},
             {"efficiency_bound", ColumnType::Real, "replayed: what perfect balance reaches, in modelled seconds"},
             {"max_over_mean", ColumnType::Real, "replayed: tests of the busiest thread over the mean"},
             {"seconds", ColumnType::Real, "real: of the render"},
             {"on_processor", ColumnType::Real, "real: processor time of the busiest thread over the seconds"},
             {"speed_low", ColumnType::Real,
              "real: speed of the slowest thread when all trace the same, beside the render, over one thread alone"},
             {"speed_high", ColumnType::Real, "real: the same of the fastest"},
             {"predicted", ColumnType::Real, "real: speedup over threads by a replay with these speeds"},
             {"predicted_balance", ColumnType::Real, "real: mean over largest processor time by the same replay"},
             {"processor_balance", ColumnType::Real, "real: mean over largest processor time of the render's threads"},
             {"fetch_ns", ColumnType::Real, "openmp: of a chunk, to the thread that fetches it"},
             {"barrier_ns", ColumnType::Real, "openmp: of a barrier"},
             {"segment_ns", ColumnType::Signed, "model: recursive engine, of a segment by itself"},
             {"test_ns", ColumnType::Signed, "model: of each box or primitive test"},
             {"fit_error", ColumnType::Real, "model: standard deviation of lines around it, over the mean line"},
             {"hash", ColumnType::Text, "real: of the sums of the image"}},
        .cases = replay_cases};
}

}  // namespace raypool::studies
