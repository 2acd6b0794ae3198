// How large a pool must be, whose, and refilled when, to beat recursion: the paper's Figure 8 and the axes around it.

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "bench/studies/crossover.h"
#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
#include "bench/studies/studies.h"
#include "bench/studies/verdict.h"
#include "core/settings_text.h"
#include "wavefront/engine.h"
#include "wavefront/ladder.h"
#include "wavefront/setting_names.h"

namespace raypool::studies {

namespace {

using wavefront::PoolScope;
using wavefront::PoolSettings;
using wavefront::Refill;
using wavefront::Sort;

constexpr const char* kRecursive = "recursive";
constexpr const char* kPaper = "the paper's pool";
constexpr const char* kFastest = "thread, regenerate, fused";

/// A pool whose capacity is left open: a line of the picture.
struct Line {
    std::string name;
    PoolSettings pool;
};

/// The paper's pool as it stands; then scope by refill, all else equal; then the fastest.
std::vector<Line> lines() {
    std::vector<Line> lines;
    PoolSettings wide = rung_settings("shared-stream", 1);
    lines.push_back({kPaper, rung_settings("shared", 1)});
    lines.push_back({"shared, drain", wide});
    wide.refill = Refill::Regenerate;
    lines.push_back({"shared, regenerate", wide});
    lines.push_back({"thread, drain", rung_settings("thread-small", 1)});
    lines.push_back({"thread, regenerate", rung_settings("regenerate", 1)});
    lines.push_back({kFastest, rung_settings("fused", 1)});
    return lines;
}

/// A batch that leaves each thread at least two of a shared pool, up to the default.
std::int64_t batch_for(std::int64_t capacity, int threads) {
    const std::int64_t share = threads == 1 ? capacity : capacity / (2 * threads);
    return std::clamp<std::int64_t>(share, 16, PoolSettings{}.batch);
}

/// From 64 to a record for every path of the render.
std::vector<std::int64_t> capacities(std::int64_t paths, std::int64_t factor) {
    std::vector<std::int64_t> list;
    for (std::int64_t capacity = 64; capacity < paths; capacity *= factor) list.push_back(capacity);
    list.push_back(paths);
    return list;
}

/// The columns behind those of every render, of which `axis` says what a row is for.
Row pool_cells(const std::string& axis, const PoolSettings& pool) {
    return {axis,
            to_string(pool.scope),
            to_string(pool.refill),
            to_string(pool.camera),
            to_string(pool.width),
            to_string(pool.sort),
            pool.capacity,
            pool.batch};
}
constexpr std::size_t kPoolCells = 8;
constexpr std::size_t kRoundCells = 5;

Case pool_case(const std::string& axis, const Line& line, const std::shared_ptr<const StudyScene>& scene,
               const RenderSettings& settings, int repeats) {
    Row cells = pool_cells(axis, line.pool);
    cells.insert(cells.end(), kRoundCells, nullptr);
    return render_case(fmt::format("{}: {}, {} records, sort {}, batch {}, {} threads", axis, line.name,
                                   line.pool.capacity, to_string(line.pool.sort), line.pool.batch, settings.threads),
                       {line.name, std::make_shared<wavefront::WavefrontEngine>(line.pool)}, scene, settings, repeats,
                       cells);
}

/// A row for each round in which records were advanced. After a round without any, a pool that drains is full again:
/// `depth` counts from there.
Case rounds_case(const Line& line, const std::shared_ptr<const StudyScene>& scene, RenderSettings settings) {
    settings.log_rounds = true;
    const auto run = [line, scene, settings]() {
        const Measured measured = measure(wavefront::WavefrontEngine(line.pool), *scene, settings);
        std::vector<Row> rows;
        std::int64_t round = 0;
        std::int64_t depth = 0;
        for (const RoundWork& work : measured.report.rounds) {
            depth = work.records_in == 0 ? 0 : depth + 1;
            ++round;
            if (work.records_in == 0) continue;
            Row row = render_row(line.name, *scene, settings, measured);
            for (const Value& cell : pool_cells("rounds", line.pool)) row.push_back(cell);
            row.insert(row.end(), {round, line.pool.refill == Refill::Drain ? Value(depth) : Value(nullptr),
                                   work.records_in, work.records_out, work.lanes});
            rows.push_back(std::move(row));
        }
        return rows;
    };
    return {fmt::format("rounds: {}", line.name), image_of(*scene, settings), 1, run};
}

class Pool : public Study {
  public:
    [[nodiscard]] std::string name() const override { return "pool"; }
    [[nodiscard]] std::string question() const override {
        return "From what capacity on does a pool beat recursion, and what do scope, refill, sorting and batches "
               "matter?";
    }
    [[nodiscard]] std::vector<Column> columns() const override {
        std::vector<Column> columns = render_columns();
        columns.insert(
            columns.end(),
            {{"axis", ColumnType::Text, "what the row is for: recursion, capacity, sort, batch or rounds"},
             {"scope", ColumnType::Text, "one pool shared by all threads, or one for each thread"},
             {"refill", ColumnType::Text, "camera rays enter the empty pool (drain), or as soon as there is room"},
             {"camera", ColumnType::Text, "camera rays enter at once (staged) or after their first bounce (fused)"},
             {"stage_width", ColumnType::Text, "a ray at a time (scalar) or a register of them (simd)"},
             {"sort", ColumnType::Text, "order of records before shading"},
             {"capacity", ColumnType::Count, "records, of each pool"},
             {"batch", ColumnType::Count, "records that a thread takes at a time from a shared pool"},
             {"round", ColumnType::Count, "number of the round"},
             {"depth", ColumnType::Count, "rounds since the pool was filled, of a pool that drains"},
             {"records_in", ColumnType::Count, "records advanced in the round"},
             {"records_out", ColumnType::Count, "of these, alive afterwards"},
             {"lanes", ColumnType::Count, "lanes of registers used for them"}});
        return columns;
    }

    [[nodiscard]] std::vector<Case> cases(const StudyOptions& options) const override {
        const auto scene = study_scene(options.scene, choose(options.width, options.is_quick, 200, 400));
        RenderSettings settings;
        settings.end_sample = choose(options.spp, options.is_quick, 2, 4);
        settings.depth = static_cast<std::int32_t>(choose(options.depth, options.is_quick, 50, 50));
        settings.seed = options.seed;
        settings.schedule = parse_schedule("dynamic");
        const int repeats = static_cast<int>(choose(options.repeats, options.is_quick, 3, 5));
        const int most = static_cast<int>(choose(options.threads, false, 0, core_count()));
        const std::int64_t paths = scene->compiled.pixel_count() * settings.end_sample;

        std::vector<Case> cases;
        for (const int threads : one_and_all(most)) {
            settings.threads = threads;
            Row recursion{"recursion"};
            recursion.insert(recursion.end(), kPoolCells - 1 + kRoundCells, nullptr);
            cases.push_back(render_case(fmt::format("recursive, {} threads", threads), recursive_engine(), scene,
                                        settings, repeats, recursion));
            for (Line line : lines()) {
                for (const std::int64_t capacity : capacities(paths, options.is_quick ? 16 : 4)) {
                    line.pool.capacity = capacity;
                    line.pool.batch = batch_for(capacity, threads);
                    cases.push_back(pool_case("capacity", line, scene, settings, repeats));
                }
            }
            for (Line line : lines()) {
                if (line.name == kPaper) continue;
                for (const Sort sort : {Sort::None, Sort::Material}) {
                    line.pool.sort = sort;
                    cases.push_back(pool_case("sort", line, scene, settings, repeats));
                }
            }
        }
        for (Line line : lines()) {
            if (line.pool.scope != PoolScope::Shared || line.name == kPaper) continue;
            for (const std::int64_t batch : {256, 1024, 4096, 16384}) {
                line.pool.batch = batch;
                cases.push_back(pool_case("batch", line, scene, settings, repeats));
            }
        }
        add_rounds(cases, options, scene->compiled.pixel_count(), settings);
        return cases;
    }

    [[nodiscard]] Summary summarise(const Table& data, const StudyOptions&) const override {
        Summary summary;
        TextTable crossings{"The smallest capacity that beats recursion in every run", {"pool"}, {}};
        for (const Line& line : lines()) crossings.rows.push_back({line.name});
        for (const Value& threads : thread_values(data)) {
            const Table here = data.where("threads", threads);
            summary.tables.push_back(by_capacity(here, threads.get<int>()));
            crossings.header.push_back(threads_text(threads.get<int>()));
            for (std::vector<std::string>& row : crossings.rows)
                row.push_back(to_text(crossover(ratios_by_capacity(here, row.front()))));
        }
        summary.tables.push_back(std::move(crossings));
        for (const Value& threads : thread_values(data))
            summary.tables.push_back(by_sort(data.where("threads", threads), threads.get<int>()));
        summary.tables.push_back(by_batch(data));
        summary.tables.push_back(by_depth(data));
        add_findings(summary, data);
        add_pictures(summary);
        summary.notes.push_back(
            "Capacity is of each pool; the largest holds every path of the render. To beat recursion is to be faster "
            "in "
            "every one of the runs taken side by side. Batches of a shared pool are at most 4096 records, and small "
            "enough "
            "that each thread finds two.");
        return summary;
    }

  private:
    /// Of a drained and a regenerating pool, over a few fillings of the default shared pool.
    static void add_rounds(std::vector<Case>& cases, const StudyOptions& options, std::int64_t pixels,
                           RenderSettings settings) {
        constexpr std::int64_t kFillings = 4;
        const auto scene = study_scene(options.scene, choose(options.width, options.is_quick, 200, 400));
        settings.threads = 1;  // so that every run has the same rounds
        settings.end_sample =
            std::clamp<std::int64_t>(kFillings * PoolSettings::kSharedCapacity / pixels, 1, settings.end_sample);
        for (const Line& line : lines())
            if (line.pool.scope == PoolScope::Shared && line.name != kPaper)
                cases.push_back(rounds_case(line, scene, settings));
    }

    static std::vector<Value> thread_values(const Table& data) {
        return data.where("axis", "recursion").distinct("threads");
    }
    static std::string threads_text(int threads) {
        return fmt::format("{} thread{}", threads, threads == 1 ? "" : "s");
    }

    /// Of rows of one case, to the recursion of the same thread count in `here`.
    static Spread to_recursion(const Table& here, const Table& rows) {
        return spread(ratios(rows.numbers("mpaths_per_s"), here.where("axis", "recursion").numbers("mpaths_per_s")));
    }
    static std::vector<AtCapacity> ratios_by_capacity(const Table& here, const std::string& line) {
        std::vector<AtCapacity> measured;
        const Table rows = here.where("axis", "capacity").where("engine", line);
        for (const Value& capacity : rows.distinct("capacity"))
            measured.push_back({capacity.get<std::int64_t>(), to_recursion(here, rows.where("capacity", capacity))});
        std::sort(measured.begin(), measured.end(),
                  [](const auto& a, const auto& b) { return a.capacity < b.capacity; });
        return measured;
    }

    static TextTable by_capacity(const Table& here, int threads) {
        TextTable table{fmt::format("Ratio to recursion by capacity, {}", threads_text(threads)), {"pool"}, {}};
        for (const AtCapacity& at : ratios_by_capacity(here, kPaper))
            table.header.push_back(std::to_string(at.capacity));
        for (const Line& line : lines()) {
            std::vector<std::string> row{line.name};
            for (const AtCapacity& at : ratios_by_capacity(here, line.name)) row.push_back(to_text(at.ratio));
            table.rows.push_back(std::move(row));
        }
        return table;
    }

    static TextTable by_sort(const Table& here, int threads) {
        TextTable table{fmt::format("Sorting by material, {}", threads_text(threads)),
                        {"pool", "capacity", "ratio to recursion, unsorted", "sorted", "sorted over unsorted"},
                        {}};
        const Table all = here.where("axis", "sort");
        for (const Value& line : all.distinct("engine")) {
            const Table unsorted = all.where("engine", line).where("sort", "none");
            const Table sorted = all.where("engine", line).where("sort", "material");
            table.rows.push_back(
                {line.get<std::string>(), unsorted.distinct("capacity").front().dump(),
                 to_text(to_recursion(here, unsorted)), to_text(to_recursion(here, sorted)),
                 to_text(spread(ratios(sorted.numbers("mpaths_per_s"), unsorted.numbers("mpaths_per_s"))))});
        }
        return table;
    }

    static TextTable by_batch(const Table& data) {
        const Table all = data.where("axis", "batch");
        const Value threads = all.distinct("threads").front();
        const Table here = data.where("threads", threads);
        TextTable table{fmt::format("Ratio to recursion by batch, {}", threads_text(threads.get<int>())), {"pool"}, {}};
        for (const Value& batch : all.distinct("batch")) table.header.push_back(batch.dump());
        for (const Value& line : all.distinct("engine")) {
            std::vector<std::string> row{line.get<std::string>()};
            for (const Value& batch : all.distinct("batch"))
                row.push_back(to_text(to_recursion(here, all.where("engine", line).where("batch", batch))));
            table.rows.push_back(std::move(row));
        }
        return table;
    }

    /// How the pool that drains thins out: the mean over its fillings.
    static TextTable by_depth(const Table& data) {
        const Table rounds = data.where("axis", "rounds").where("refill", "drain");
        TextTable table{"Rounds of the shared pool that drains, by depth",
                        {"depth", "rounds", "records, mean", "part of the first round", "survive", "lanes filled"},
                        {}};
        double at_first = 0;
        for (const Value& depth : rounds.distinct("depth")) {
            const Table here = rounds.where("depth", depth);
            const auto sum = [&](const char* column) {
                double total = 0;
                for (const double value : here.numbers(column)) total += value;
                return total;
            };
            const auto count = static_cast<double>(here.rows().size());
            if (at_first == 0) at_first = sum("records_in") / count;
            table.rows.push_back({depth.dump(), fmt::format("{}", here.rows().size()),
                                  fmt::format("{:.0f}", sum("records_in") / count),
                                  fmt::format("{:.2g} %", 100 * sum("records_in") / count / at_first),
                                  fmt::format("{:.0f} %", 100 * sum("records_out") / sum("records_in")),
                                  fmt::format("{:.0f} %", 100 * sum("records_in") / sum("lanes"))});
        }
        return table;
    }

    /// The best and the worst capacity of a line decide whether it is slower than recursion.
    static void add_findings(Summary& summary, const Table& data) {
        const Value threads = thread_values(data).back();
        const Table here = data.where("threads", threads);
        const auto best = [&](const std::string& line) {
            const std::vector<AtCapacity> all = ratios_by_capacity(here, line);
            return *std::max_element(all.begin(), all.end(), [](const AtCapacity& a, const AtCapacity& b) {
                return a.ratio.median < b.ratio.median;
            });
        };
        const auto add = [&](const char* line, const char* which) {
            const AtCapacity at = best(line);
            const Verdict verdict = at.ratio.high < 1  ? Verdict::Holds
                                    : at.ratio.low > 1 ? Verdict::DoesNotHold
                                                       : Verdict::CannotTell;
            summary.findings.push_back(
                {"Figure 8", fmt::format("the pool is slower than basic recursion: {}", which), "slower",
                 fmt::format("at its best capacity, {} records, {} times as fast as recursion, {}", at.capacity,
                             to_text(at.ratio), threads_text(threads.get<int>())),
                 verdict, verdict == Verdict::CannotTell ? "the spread of the runs includes 1" : ""});
        };
        add(kPaper, "as the paper has it, a ray at a time");
        add("shared, drain", "the same pool with wide stages and streams");
        add(kFastest, "a pool for each thread, refilled at once");
    }

    static void add_pictures(Summary& summary) {
        summary.pictures.push_back(
            {"capacity", "How large a pool must be to beat recursion",
             "Each line is a pool, by its capacity: how many times as fast as recursion, with a band from the lowest "
             "to the "
             "highest run. What to see: where a line rises above 1, the pool wins. The paper's pool, a ray at a time, "
             "hardly ever does; with wide stages even a shared pool does once it is large; a pool of each thread's own "
             "wins from a few hundred records on."});
        summary.pictures.push_back(
            {"rounds", "How full the pool is, round by round",
             "Left: records in the shared pool at each round, of the part of the render that is shown. Right: the pool "
             "that drains, by rounds since it was filled (a line for the mean of its fillings), and how full the "
             "registers are that its batches are worked on with. What to see: a pool that drains thins out with every "
             "round and works on a few records for most of its rounds; one that is refilled at once stays full."});
    }
};

}  // namespace

std::unique_ptr<Study> pool_study() {
    return std::make_unique<Pool>();
}

}  // namespace raypool::studies
