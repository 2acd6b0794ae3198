// What every schedule would make of the same work with 1 to 4096 threads, and whether such a replay can be believed.

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "bench/studies/openmp_costs.h"
#include "bench/studies/renders.h"
#include "bench/studies/replay_ways.h"
#include "bench/studies/statistics.h"
#include "bench/studies/studies.h"
#include "wavefront/settings.h"

namespace raypool::studies {

namespace {

constexpr int kMostThreads = 4096;
constexpr double kBelieved = 3;  // points of efficiency between replay and reality

/// What a run of the recursive engine can be held against.
struct RealWay {
    const char* name;
    const char* grain;
    const char* schedule;
};
constexpr RealWay kRealWays[] = {
    {"lines, static", "line", "static"},
    {"lines, static,1", "line", "static,1"},
    {"lines, dynamic", "line", "dynamic"},
    {"lines, guided", "line", "guided"},
    {"pixels, static", "pixel", "static"},
    {"pixels, static,1", "pixel", "static,1"},
    {"pixels, dynamic", "pixel", "dynamic"},
    {"pixels, dynamic,64", "pixel", "dynamic,64"},
    {"tiles of 16, dynamic", "tile:16", "dynamic"},
};

struct GroupedWay {
    const char* group;
    ReplayWay way;
};

constexpr const char* kDefaultPool = "a pool each, lines, dynamic (default)";
constexpr const char* kThreadPools = "a pool for each thread";

std::vector<GroupedWay> all_ways() {
    using Kind = ReplaySchedule::Kind;
    constexpr ReplaySchedule kStatic{Kind::Static, 0};
    constexpr ReplaySchedule kDynamic{Kind::Dynamic, 1};
    const auto shared = static_cast<std::size_t>(wavefront::PoolSettings::kSharedCapacity);
    const std::int64_t own = wavefront::PoolSettings{}.capacity;

    std::vector<GroupedWay> ways;
    for (const RealWay& way : kRealWays)
        ways.push_back({way.grain == std::string("line") ? "recursion, by lines" : "recursion, by pixels and tiles",
                        loop_way(way.name, way.grain, way.schedule)});
    const auto line_way = [&](const char* name, Kind kind) {
        ways.push_back({"recursion, by lines", {name, ReplayWay::Kind::Loop, parse_grain("line"), {kind, 0}, 0, 0}});
    };
    line_way("lines, longest first", Kind::LongestFirst);
    line_way("lines, factoring", Kind::Factoring);

    const auto drained = [&](const char* name, std::size_t capacity, std::size_t batch, ReplaySchedule schedule) {
        ways.push_back({"a pool for all threads", {name, ReplayWay::Kind::Drained, {}, schedule, capacity, batch}});
    };
    drained("65536 rays, batches of 4096 (default)", shared, 4096, kDynamic);
    drained("65536 rays, batches of 256", shared, 256, kDynamic);
    drained("65536 rays, contiguous shares", shared, 1, kStatic);
    drained("the whole image, batches of 256", 0, 256, kDynamic);
    drained("the whole image, contiguous shares", 0, 1, kStatic);

    ways.push_back({kThreadPools, thread_pool_way(kDefaultPool, "line", "dynamic", own)});
    ways.push_back({kThreadPools, thread_pool_way("a pool each, lines, static", "line", "static", own)});
    ways.push_back({kThreadPools, thread_pool_way("a pool each, tiles of 4, dynamic", "tile:4", "dynamic", own)});
    ways.push_back({kThreadPools, thread_pool_way("a pool each, pixels, static,1", "pixel", "static,1", own)});
    return ways;
}

/// The costs of the study's paths, their model, and OpenMP's costs, found out when they are first asked for.
class Work {
  public:
    Work(std::shared_ptr<const StudyScene> scene, const RenderSettings& settings, int repeats)
        : scene_(std::move(scene)), settings_(settings), repeats_(repeats) {}
    const PathCosts& costs() {
        if (costs_.first.empty()) costs_ = record_costs(*scene_, settings_);
        return costs_;
    }
    const CostFit& fit() {
        if (fit_.seconds == 0) fit_ = fit_costs(*scene_, settings_, costs(), repeats_);
        return fit_;
    }
    const OpenMpCosts& openmp() {
        if (openmp_.threads.empty()) openmp_ = measure_openmp_costs(core_count());
        return openmp_;
    }

  private:
    std::shared_ptr<const StudyScene> scene_;
    RenderSettings settings_;
    int repeats_;
    PathCosts costs_;
    CostFit fit_;
    OpenMpCosts openmp_;
};

class ReplayStudy : public Study {
  public:
    [[nodiscard]] std::string name() const override { return "replay"; }
    [[nodiscard]] std::string question() const override {
        return "How well would each schedule balance this work over up to 4096 threads, and does a replay tell the "
               "truth?";
    }
    [[nodiscard]] std::vector<Column> columns() const override {
        return {
            {"kind", ColumnType::Text, "replayed; real; openmp (what it costs); model (of a segment's time)"},
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
            {"segment_ns", ColumnType::Real, "model: recursive engine, of a segment by itself"},
            {"test_ns", ColumnType::Real, "model: of each box or primitive test"},
            {"fit_error", ColumnType::Real, "model: standard deviation of lines around it, over the mean line"},
            {"hash", ColumnType::Text, "real: of the sums of the image"}};
    }

    [[nodiscard]] std::vector<Case> cases(const StudyOptions& options) const override {
        const auto scene = study_scene(options.scene, choose(options.width, false, 0, 400));
        RenderSettings settings;
        settings.end_sample = choose(options.spp, options.is_quick, 4, 16);
        settings.depth = static_cast<std::int32_t>(choose(options.depth, false, 0, 50));
        settings.seed = options.seed;
        const int repeats = static_cast<int>(choose(options.repeats, options.is_quick, 5, 11));
        const int most = static_cast<int>(choose(options.threads, false, 0, kMostThreads));
        const int real = std::min({2, core_count(), most});
        const auto work = std::make_shared<Work>(scene, settings, repeats);

        std::vector<Case> cases;
        cases.push_back({"replay", "", 1, [=, this] { return replay_all(*work, *scene, settings, most, repeats); }});
        for (const RealWay& way : kRealWays) {
            settings.grain = parse_grain(way.grain);
            settings.schedule = parse_schedule(way.schedule);
            cases.push_back({fmt::format("real, {}", way.name), image_of(*scene, settings), repeats,
                             [=, this] { return run_real(*work, *scene, settings, way.name, real); }});
        }
        return cases;
    }

    [[nodiscard]] Summary summarise(const Table& data, const StudyOptions& options) const override;

  private:
    std::vector<Row> replay_all(Work& work, const StudyScene& scene, const RenderSettings& settings, int most,
                                int repeats) const {
        std::vector<Row> rows;
        const std::vector<Column> all = columns();
        const PathCosts& costs = work.costs();
        const CostFit& fit = work.fit();
        const int renders = std::min(repeats, 3);
        const CostModel shared = scaled_to(*canonical_pool().engine, scene, settings, costs, fit.model, renders);
        const CostModel own = scaled_to(*fused_pool().engine, scene, settings, costs, fit.model, renders);
        const auto add_model = [&](const char* engine, const CostModel& model, const Value& error) {
            rows.push_back(sparse_row(all, {{"kind", "model"},
                                            {"way", engine},
                                            {"segment_ns", 1e9 * model.segment_s},
                                            {"test_ns", 1e9 * model.test_s},
                                            {"fit_error", error}}));
        };
        add_model("recursion", fit.model, fit.error);
        add_model("a pool for all threads", shared, {});
        add_model(kThreadPools, own, {});

        const OpenMpCosts& openmp = work.openmp();
        for (std::size_t i = 0; i < openmp.threads.size(); ++i)
            rows.push_back(sparse_row(all, {{"kind", "openmp"},
                                            {"threads", openmp.threads[i]},
                                            {"fetch_ns", 1e9 * openmp.fetch_s[i]},
                                            {"barrier_ns", 1e9 * openmp.barrier_s[i]}}));

        for (const GroupedWay& grouped : all_ways()) {  // no structured binding: clang 14 has none in parallel regions
            const ReplayWay& way = grouped.way;
            const PreparedWay tests = prepare(way, costs, kTests);
            const PreparedWay time = prepare(way, costs,
                                             way.kind == ReplayWay::Kind::Loop      ? fit.model
                                             : way.kind == ReplayWay::Kind::Drained ? shared
                                                                                    : own);
            const std::vector<int> replayed = thread_counts(most);
            std::vector<Row> filled(replayed.size());
#pragma omp parallel for schedule(dynamic) num_threads(core_count())
            for (std::size_t i = 0; i < replayed.size(); ++i) {
                const int threads = replayed[i];
                const Replayed counted = tests.replay(threads, {});
                const Replayed timed = time.replay(threads, {});
                filled[i] =
                    sparse_row(all, {{"kind", "replayed"},
                                     {"group", grouped.group},
                                     {"way", way.name},
                                     {"threads", threads},
                                     {"efficiency_tests", counted.efficiency()},
                                     {"efficiency_time", timed.efficiency()},
                                     {"efficiency_costs", time.replay(threads, openmp.at(threads)).efficiency()},
                                     {"efficiency_bound", timed.total() / (threads * time.bound(threads))},
                                     {"max_over_mean", max_over_mean(counted.work)}});
            }
            rows.insert(rows.end(), filled.begin(), filled.end());
        }
        return rows;
    }

    /// One thread and more; beside them, how fast each thread is when all do the same; and what a replay with threads
    /// of these speeds makes of it.
    std::vector<Row> run_real(Work& work, const StudyScene& scene, RenderSettings settings, const char* way,
                              int threads) const {
        std::vector<double> items;
        for (const Tally& tally : work.costs().items(settings.grain)) items.push_back(work.fit().model.seconds(tally));
        const ReplaySchedule schedule = to_replay(settings.schedule);
        const double alone = equal_work_seconds(scene, settings, 1)[0];
        const double one = replay(items, schedule, 1, work.openmp().at(1)).makespan;

        std::vector<Row> rows;
        for (const int n : {1, threads}) {
            if (n == 1 && !rows.empty()) break;  // there is one core only
            std::vector<double> speeds = equal_work_seconds(scene, settings, n);
            for (double& speed : speeds) speed = alone / speed;
            const Replayed replayed = replay(items, schedule, n, work.openmp().at(n), speeds);
            std::vector<double> busy = replayed.work;
            for (std::size_t i = 0; i < busy.size(); ++i) busy[i] /= speeds[i];

            settings.threads = n;
            const Measured measured = measure(*recursive_engine().engine, scene, settings);
            const RenderReport& report = measured.report;
            const std::vector<double> processor = by_thread(report, &ThreadWork::processor_s);
            rows.push_back(sparse_row(
                columns(), {{"kind", "real"},
                            {"way", way},
                            {"threads", n},
                            {"seconds", report.seconds},
                            {"processor_balance", 1 / max_over_mean(processor)},
                            {"on_processor", *std::max_element(processor.begin(), processor.end()) / report.seconds},
                            {"speed_low", *std::min_element(speeds.begin(), speeds.end())},
                            {"speed_high", *std::max_element(speeds.begin(), speeds.end())},
                            {"predicted", one / (n * replayed.makespan)},
                            {"predicted_balance", 1 / max_over_mean(busy)},
                            {"hash", measured.hash}}));
        }
        return rows;
    }
};

std::string percent(double value) {
    return fmt::format("{:.1f}", 100 * value);
}

/// An efficiency over repeats.
struct Repeated {
    Spread efficiency;
    double noise;  ///< between the quartiles, in points

    explicit Repeated(std::vector<double> values) : efficiency(spread(values)) {
        std::sort(values.begin(), values.end());
        const std::size_t quarter = values.size() / 4;
        noise = 100 * (values[values.size() - 1 - quarter] - values[quarter]);
    }
    [[nodiscard]] double median() const { return efficiency.median; }
    [[nodiscard]] std::string text() const {
        return fmt::format("{} ({} to {})", percent(efficiency.median), percent(efficiency.low),
                           percent(efficiency.high));
    }
};

/// Predicted and measured efficiency of a way. By the clock it is speedup over threads, by processor time balance
/// alone.
struct Comparison {
    double equal;  ///< predicted for threads of equal speed
    double predicted_clock;
    double predicted_balance;
    Repeated clock;
    Repeated balance;
    double on_processor;
    Spread slowest;  ///< thread, when all do the same
    Spread fastest;
};

Comparison compare(const Table& data, const Value& way, int threads) {
    const Table replayed = data.where("kind", "replayed").where("way", way);
    const auto makespan = [&](int n) {  // of work 1
        return 1 / (n * replayed.where("threads", n).numbers("efficiency_costs").at(0));
    };
    const Table real = data.where("kind", "real").where("way", way);
    const Table shared = real.where("threads", threads);
    std::vector<double> efficiency = ratios(real.where("threads", 1).numbers("seconds"), shared.numbers("seconds"));
    for (double& e : efficiency) e /= threads;
    return {makespan(1) / (threads * makespan(threads)),   median(shared.numbers("predicted")),
            median(shared.numbers("predicted_balance")),   Repeated(efficiency),
            Repeated(shared.numbers("processor_balance")), median(shared.numbers("on_processor")),
            spread(shared.numbers("speed_low")),           spread(shared.numbers("speed_high"))};
}

/// By the clock where the machine was ours and the runs agree; by processor time where other work spoilt the clock.
Finding judge(const std::string& way, const Comparison& c, int threads) {
    const bool is_static = way.find("static") != std::string::npos;
    constexpr double kQuiet = 2 * kBelieved;  // points between the quartiles
    constexpr double kOurs = 0.97;            // of the time on a processor
    const bool is_clock = c.on_processor >= kOurs && c.clock.noise <= kQuiet;
    const Repeated& measured = is_clock ? c.clock : c.balance;
    const double predicted = is_clock ? c.predicted_clock : c.predicted_balance;
    const double miss = 100 * std::abs(predicted - measured.median());
    Finding finding{
        "",
        fmt::format("a replay tells the efficiency of {}", way),
        fmt::format("within {:.0f} points", kBelieved),
        fmt::format("predicted {} ({} if both threads were as fast as one alone), measured {} % by {}",
                    percent(predicted), percent(c.equal), measured.text(), is_clock ? "the clock" : "processor time"),
        Verdict::CannotTell,
        ""};
    if (threads == 1) {
        finding.why = "one thread has nothing to share out";
    } else if (measured.noise > kQuiet) {
        finding.why =
            fmt::format("the middle half of the runs is {:.0f} points wide: the machine was not quiet", measured.noise);
    } else if (!is_clock && !is_static && miss > kBelieved) {
        finding.why =
            "other work took the machine, and a loop that hands out work on demand gives a disturbed thread less";
    } else {
        finding.verdict = miss <= kBelieved ? Verdict::Holds : Verdict::DoesNotHold;
        if (!is_clock)
            finding.why = fmt::format(
                "by balance of processor time; the clock is spoilt by other work (busiest thread {:.0f} % of the time "
                "on a "
                "processor, runs {:.0f} points wide)",
                100 * c.on_processor, c.clock.noise);
    }
    return finding;
}

/// Replay against reality: a verdict for each schedule.
void add_comparison(Summary& summary, const Table& data) {
    const Table real = data.where("kind", "real");
    const std::vector<double> real_threads = real.numbers("threads");
    const int threads = static_cast<int>(*std::max_element(real_threads.begin(), real_threads.end()));
    TextTable table{fmt::format("Replay against reality, {} threads, efficiency in %", threads),
                    {"way", "predicted, equal speed", "predicted, their speeds", "by the clock", "balance: predicted",
                     "balance: by processor time", "slowest thread's speed", "fastest"},
                    {}};
    for (const Value& way : real.distinct("way")) {
        const Comparison c = compare(data, way, threads);
        table.rows.push_back({way.get<std::string>(), percent(c.equal), percent(c.predicted_clock), c.clock.text(),
                              percent(c.predicted_balance), c.balance.text(), to_text(c.slowest), to_text(c.fastest)});
        summary.findings.push_back(judge(way.get<std::string>(), c, threads));
    }
    summary.tables.push_back(table);
}

/// The fast pool's balance at 64 threads.
void add_pool_load(Summary& summary, const Table& data, int threads) {
    constexpr double kReach = 1.02;
    const Table pools = data.where("kind", "replayed").where("group", kThreadPools).where("threads", threads);
    std::string best;
    double least = 0;
    for (const Row& row : pools.rows()) {
        const double load = row[pools.index("max_over_mean")].get<double>();
        if (!best.empty() && load >= least) continue;
        best = row[pools.index("way")].get<std::string>();
        least = load;
    }
    summary.findings.push_back(
        {"", fmt::format("the fast pool can be balanced over {} threads", threads),
         fmt::format("max/mean of tests at most {}", kReach),
         fmt::format("{:.3f} by \"{}\"; {:.3f} by \"{}\"", least, best,
                     pools.where("way", kDefaultPool).numbers("max_over_mean").at(0), kDefaultPool),
         threads < 64      ? Verdict::CannotTell
         : least <= kReach ? Verdict::Holds
                           : Verdict::DoesNotHold,
         threads < 64 ? "takes a replay of 64 threads" : ""});
}

TextTable efficiency_table(const Table& replayed, const char* column, std::string title) {
    const std::vector<Value> threads = replayed.distinct("threads");
    TextTable table{std::move(title), {"way"}, {}};
    for (std::size_t i = 1; i < threads.size(); i += 2) table.header.push_back(threads[i].dump());
    for (const Value& way : replayed.distinct("way")) {
        std::vector<std::string> row{way.get<std::string>()};
        const Table own = replayed.where("way", way);
        for (std::size_t i = 1; i < threads.size(); i += 2)
            row.push_back(percent(own.where("threads", threads[i]).numbers(column).at(0)));
        table.rows.push_back(std::move(row));
    }
    return table;
}

Summary ReplayStudy::summarise(const Table& data, const StudyOptions&) const {
    Summary summary;
    const Table replayed = data.where("kind", "replayed");
    const std::vector<Value> counts = replayed.distinct("threads");
    int pool_threads = 1;
    for (const Value& n : counts)
        if (n.get<int>() <= 64) pool_threads = std::max(pool_threads, n.get<int>());

    add_comparison(summary, data);
    add_pool_load(summary, data, pool_threads);
    if (counts.size() > 1) {
        summary.tables.push_back(efficiency_table(replayed, "efficiency_tests",
                                                  "Balance alone, counted in tests: efficiency in %, by threads"));
        summary.tables.push_back(
            efficiency_table(replayed, "efficiency_costs",
                             "In modelled seconds, with chunk fetches and barriers: efficiency in %, by threads"));
    }

    TextTable openmp{"What OpenMP costs here", {"threads", "chunk fetch, ns", "barrier, ns"}, {}};
    const Table measured = data.where("kind", "openmp");
    for (const Value& n : measured.distinct("threads")) {
        const Table row = measured.where("threads", n);
        openmp.rows.push_back({n.dump(), fmt::format("{:.0f}", row.numbers("fetch_ns").at(0)),
                               fmt::format("{:.0f}", row.numbers("barrier_ns").at(0))});
    }
    summary.tables.push_back(openmp);

    summary.pictures.push_back(
        {"replay", "How far each schedule would scale, if threads were all that it takes",
         "Each line is one way to share out the same recorded work; thin dashed lines add what fetching chunks and "
         "waiting at "
         "barriers cost here, the dotted line is the best that these grains allow. What to see: at how many threads "
         "each way leaves the top. It is where the grain runs out: there are as many lines as the image is high, as "
         "many batches as fit into the pool."});
    summary.pictures.push_back(
        {"reality", "Replay against reality",
         fmt::format(
             "Filled: predicted by replay at the speeds that the threads have when all do the same, with a band "
             "of {:.0f} points either side; small grey: if all were as fast as one alone. Open, with whiskers "
             "from the lowest to the highest run: measured. Left by the clock, right by processor time, which "
             "shows balance alone where other work disturbs the clock. What to see: the open marks lie "
             "within the bands.",
             kBelieved)});
    summary.notes.push_back(
        "Replay against reality: beside each real run all threads traced the same lines at once, which shows what a "
        "perfectly balanced run of this work reaches, and how fast each thread is. Cores of a virtual machine differ "
        "in "
        "speed: static schedules then wait for the slowest, and dynamic ones give it less.");

    TextTable models{"What a segment is taken to cost", {"engine", "ns", "ns for each box or primitive test"}, {}};
    const Table model = data.where("kind", "model");
    for (const Value& engine : model.distinct("way")) {
        const Table row = model.where("way", engine);
        models.rows.push_back({engine.get<std::string>(), fmt::format("{:.1f}", row.numbers("segment_ns").at(0)),
                               fmt::format("{:.2f}", row.numbers("test_ns").at(0))});
    }
    summary.tables.push_back(models);
    summary.notes.push_back(fmt::format(
        "What a segment costs was fitted to the recursive tracer's processor time, line by line on one thread; lines "
        "lie around it with a standard deviation of {:.1f} % of their mean. For pools it is scaled to their own time.",
        100 * model.numbers("fit_error").at(0)));
    summary.notes.push_back(
        "Pools test rays in streams and packets, so a segment's tests by a single ray stand in for theirs. A path of a "
        "shared pool stays in its batch; equal shares are cut anew from the rays still alive. Only the loops are held "
        "against real runs here: what is said of pools is a prediction.");
    summary.notes.push_back(
        "A replay knows balance, chunk fetches and barriers, and nothing of memory, caches or sockets: it bounds "
        "efficiency from above. Beyond the cores of this machine a chunk fetch costs what it costs with all of them, "
        "and a barrier grows with the logarithm of the threads; a round has three barriers.");
    return summary;
}

}  // namespace

std::unique_ptr<Study> replay_study() {
    return std::make_unique<ReplayStudy>();
}

}  // namespace raypool::studies
