#include "bench/studies/pool_summary.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "bench/studies/crossover.h"
#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
#include "bench/studies/verdict.h"

namespace raypool::studies {

namespace {

std::vector<Value> thread_values(const Table& data) {
    return data.where("axis", "recursion").distinct("threads");
}
/// In the order of the study's lines.
std::vector<Value> line_names(const Table& data) {
    return data.where("axis", "capacity").distinct("engine");
}

/// Of rows of one case, to the recursion of the same thread count in `here`.
Spread to_recursion(const Table& here, const Table& rows) {
    return spread(ratios(rows.numbers("mpaths_per_s"), here.where("axis", "recursion").numbers("mpaths_per_s")));
}
std::vector<AtCapacity> ratios_by_capacity(const Table& here, const std::string& line) {
    std::vector<AtCapacity> measured;
    const Table rows = here.where("axis", "capacity").where("engine", line);
    for (const Value& capacity : rows.distinct("capacity"))
        measured.push_back({capacity.get<std::int64_t>(), to_recursion(here, rows.where("capacity", capacity))});
    std::sort(measured.begin(), measured.end(), [](const auto& a, const auto& b) { return a.capacity < b.capacity; });
    return measured;
}

TextTable by_capacity(const Table& here, int threads) {
    TextTable table{fmt::format("Ratio to recursion by capacity, {}", threads_text(threads)), {"pool"}, {}};
    for (const AtCapacity& at : ratios_by_capacity(here, kPaperPool))
        table.header.push_back(std::to_string(at.capacity));
    for (const Value& line : line_names(here)) {
        std::vector<std::string> row{line.get<std::string>()};
        for (const AtCapacity& at : ratios_by_capacity(here, row.front())) row.push_back(to_text(at.ratio));
        table.rows.push_back(std::move(row));
    }
    return table;
}

TextTable by_sort(const Table& here, int threads) {
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

TextTable by_batch(const Table& data) {
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

/// How the pool that drains thins out, its fillings added up.
TextTable by_depth(const Table& data) {
    const Table rounds = data.where("axis", "rounds").where("refill", "drain");
    TextTable table{
        fmt::format("Rounds of a shared pool of {} records that drains, by depth",
                    rounds.distinct("capacity").front().dump()),
        {"depth", "fillings that get there", "records, mean", "of those at depth 1", "survive", "lanes filled"},
        {}};
    const auto fillings = static_cast<double>(rounds.where("depth", 1).rows().size());
    double at_first = 0;
    for (const Value& depth : rounds.distinct("depth")) {
        const Table here = rounds.where("depth", depth);
        const auto sum = [&](const char* column) {
            const std::vector<double> values = here.numbers(column);
            return std::accumulate(values.begin(), values.end(), 0.0);
        };
        if (at_first == 0) at_first = sum("records_in");
        if (const auto d = depth.get<int>(); d > 10 && d % 10 != 0) continue;  // data.csv has all
        table.rows.push_back({depth.dump(), fmt::format("{}", here.rows().size()),
                              fmt::format("{:.1f}", sum("records_in") / fillings),
                              fmt::format("{:.3g} %", 100 * sum("records_in") / at_first),
                              fmt::format("{:.0f} %", 100 * sum("records_out") / sum("records_in")),
                              fmt::format("{:.0f} %", 100 * sum("records_in") / sum("lanes"))});
    }
    return table;
}

/// The best capacity of a pool decides whether it is slower than recursion.
void add_findings(Summary& summary, const Table& data) {
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
        const Verdict is_faster = is_at_least(at.ratio, 1);
        const Verdict is_slower = is_faster == Verdict::Holds         ? Verdict::DoesNotHold
                                  : is_faster == Verdict::DoesNotHold ? Verdict::Holds
                                                                      : Verdict::CannotTell;
        summary.findings.push_back(
            {"Figure 8", fmt::format("the pool is slower than recursion (here: lines, dynamic): {}", which), "slower",
             fmt::format("at its best capacity, {} records, {} times as fast as recursion, {}", at.capacity,
                         to_text(at.ratio), threads_text(threads.get<int>())),
             is_slower, why_open(at.ratio, 1)});
    };
    add(kPaperPool, "as the paper has it, a ray at a time");
    add(kWidePool, "the same pool with wide stages and streams");
    add(kFastestPool, "a pool for each thread, refilled at once");
}

void add_pictures(Summary& summary) {
    summary.pictures.push_back(
        {"capacity", "How large a pool must be to beat recursion",
         "Each line is a pool, by its capacity: how many times as fast as recursion, with a band from the lowest to "
         "the highest run. What to see: where a line rises above 1, the pool wins. Compare the paper's pool, a ray at "
         "a "
         "time (black), with the same pool made wide (red, orange) and with pools of the threads' own (blue)."});
    summary.pictures.push_back(
        {"rounds", "How full the pool is, round by round",
         "Left: records in a shared pool, from round to round, while the same paths are rendered. Right: the pool that "
         "drains, its fillings added up: what is left of its records, and how full the registers are that treat them. "
         "What to see: for how many of its rounds a pool that drains works on next to nothing, and that one that is "
         "refilled at once stays full and needs fewer."});
}

}  // namespace

Summary summarise_pool(const Table& data) {
    Summary summary;
    TextTable crossings{"The smallest capacity that beats recursion in every run", {"pool"}, {}};
    for (const Value& line : line_names(data)) crossings.rows.push_back({line.get<std::string>()});
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
        "Capacity is of each pool; the largest holds every path of the render. To beat recursion is to be faster in "
        "every one of the runs taken side by side. Batches of a shared pool are at most 4096 records, and small enough "
        "that each thread finds two. Making the pool is part of the time: a large pool of a short render pays for it.");
    return summary;
}

}  // namespace raypool::studies
