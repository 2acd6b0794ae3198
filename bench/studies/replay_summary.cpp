#include "bench/studies/replay_summary.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "bench/studies/statistics.h"

namespace raypool::studies {

namespace {

constexpr double kBelieved = 3;  // points of efficiency between replay and reality

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

}  // namespace

Summary summarise_replay(const Table& data) {
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
        "shared pool stays in its batch; equal shares are cut anew from the rays still alive. Loops and the default "
        "pool "
        "are held against real runs here: what is said of other pools is a prediction.");
    summary.notes.push_back(
        "A replay knows balance, chunk fetches and barriers, and nothing of memory, caches or sockets: it bounds "
        "efficiency from above. Beyond the cores of this machine a chunk fetch costs what it costs with all of them, "
        "and a barrier grows with the logarithm of the threads; a round has three barriers.");
    return summary;
}

}  // namespace raypool::studies
