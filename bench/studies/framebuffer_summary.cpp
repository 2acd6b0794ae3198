#include "bench/studies/framebuffer_summary.h"

#include <unistd.h>

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

#include "bench/studies/cache_counts.h"
#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
#include "bench/studies/verdict.h"

namespace raypool::studies {

namespace {

/// The rows with counts of the whole render, from whichever source there is.
Table misses_of(const Table& data) {
    const Table hardware = data.where("source", "hardware counters");
    return hardware.is_empty() ? data.where("source", "cachegrind") : hardware;
}

std::string size_text(const Table& rows) {
    return fmt::format("{:.0f} KiB", rows.numbers("framebuffer_bytes").front() / 1024);
}

TextTable times(const Table& clock, std::vector<double>& gains) {
    TextTable table{
        "Time",
        {"pool", "width", "framebuffer", "threads", "interleaved, s", "planar, s", "planar over interleaved"},
        {}};
    const std::vector<double> counts = clock.numbers("threads");
    const std::vector<double> widths = clock.numbers("width");
    const Value most = *std::max_element(counts.begin(), counts.end());
    const Value largest = *std::max_element(widths.begin(), widths.end());
    for (const Value& engine : clock.distinct("engine"))
        for (const Value& width : clock.distinct("width"))
            for (const Value& threads : clock.distinct("threads")) {
                const Table here = clock.where("engine", engine).where("width", width).where("threads", threads);
                const std::vector<double> interleaved = here.where("layout", kInterleaved).numbers("seconds");
                const std::vector<double> planar = here.where("layout", kPlanar).numbers("seconds");
                const std::vector<double> gain = ratios(planar, interleaved);
                if (engine == kSharedPool && threads == most && width == largest)
                    gains.insert(gains.end(), gain.begin(), gain.end());
                table.rows.push_back({engine.get<std::string>(), width.dump(), size_text(here), threads.dump(),
                                      to_text(spread(interleaved), 3), to_text(spread(planar), 3),
                                      to_text(spread(gain))});
            }
    return table;
}

/// Of accesses to data, in percent: misses of the first-level cache.
double miss_rate(const Table& rows) {
    const auto sum = [&](const char* column) {
        const std::vector<double> values = rows.numbers(column);
        return values.empty() ? 0 : median(values);
    };
    const bool has_writes = !rows.numbers("d1_write_misses").empty();  // which not every processor counts
    const double accesses = sum("data_reads") + (has_writes ? sum("data_writes") : 0);
    return accesses == 0 ? 0 : 100 * (sum("d1_read_misses") + sum("d1_write_misses")) / accesses;
}
std::string per_sample(const Table& rows, const char* column) {
    const std::vector<double> values = rows.numbers(column);
    return values.empty() ? "" : fmt::format("{:.3f}", median(values) / rows.numbers("paths").front());
}

TextTable misses(const Table& counted) {
    TextTable table{
        fmt::format("Cache misses of one thread, by {}", counted.distinct("source").front().get<std::string>()),
        {"pool", "part", "width", "framebuffer", "layout", "first-level misses", "first-level write misses, a sample",
         "last-level read misses, a sample", "last-level write misses, a sample"},
        {}};
    for (const Value& engine : counted.distinct("engine"))
        for (const Value& part : counted.distinct("part"))
            for (const Value& width : counted.distinct("width"))
                for (const Value& layout : counted.distinct("layout")) {
                    const Table rows = counted.where("engine", engine)
                                           .where("part", part)
                                           .where("width", width)
                                           .where("layout", layout);
                    if (rows.is_empty()) continue;
                    table.rows.push_back({engine.get<std::string>(), part.get<std::string>(), width.dump(),
                                          size_text(rows), layout.get<std::string>(),
                                          fmt::format("{:.2f} %", miss_rate(rows)), per_sample(rows, "d1_write_misses"),
                                          per_sample(rows, "ll_read_misses"), per_sample(rows, "ll_write_misses")});
                }
    return table;
}

/// The paper's claim, held against the shared pool and the larger image.
Finding about_misses(const Table& counted) {
    constexpr double kLeastGain = 0.95;  // the paper's is 8/11; a twentieth less is not what it speaks of
    Finding finding{"Figure 11",         "an interleaved framebuffer has fewer cache misses than three planes",
                    "11 % to 8 %",       "",
                    Verdict::CannotTell, ""};
    if (counted.is_empty()) {
        finding.why = "no hardware counters, and " + cachegrind_command().why;
        return finding;
    }
    const std::vector<double> widths = counted.numbers("width");
    const auto width = static_cast<std::int64_t>(*std::max_element(widths.begin(), widths.end()));
    const auto rate_of = [&](const char* part, const char* layout) {
        const Table rows = counted.where("engine", kSharedPool).where("part", part).where("width", width);
        return miss_rate(rows.where("layout", layout));
    };
    const double planar = rate_of("render", kPlanar);
    const double interleaved = rate_of("render", kInterleaved);
    if (planar == 0) {
        finding.why = "nothing was counted";
        return finding;
    }
    finding.ours = fmt::format("{:.2f} % to {:.2f} % of accesses to data, first-level cache, by {}", planar,
                               interleaved, counted.distinct("source").front().get<std::string>());
    if (counted.distinct("part").size() > 1)
        finding.ours += fmt::format("; of those that add to the sums, {:.2f} % to {:.2f} %",
                                    rate_of("accumulate", kPlanar), rate_of("accumulate", kInterleaved));
    finding.verdict = interleaved < kLeastGain * planar ? Verdict::Holds : Verdict::DoesNotHold;
    if (finding.verdict == Verdict::DoesNotHold) finding.why = "of the whole render, not a twentieth fewer";
    return finding;
}

Finding about_time(const Spread& gain, int threads) {
    constexpr double kNothing = 1.02;  // two in a hundred: below what runs differ by
    Finding finding{
        "Figure 11",
        "an interleaved framebuffer is no gain in time",
        "none",
        fmt::format("planes take {} times as long, the paper's pool, {}", to_text(gain, 3), threads_text(threads)),
        Verdict::CannotTell,
        ""};
    if (gain.runs < kLeastRuns) {
        finding.why = fmt::format("fewer than {} runs", kLeastRuns);
    } else if (gain.high < kNothing) {
        finding.verdict = Verdict::Holds;
    } else if (gain.low > 1 && gain.median >= kNothing) {
        finding.verdict = Verdict::DoesNotHold;
    } else {
        finding.why = "the runs are too far apart to exclude a gain of 2 %";
    }
    return finding;
}

void add_notes(Summary& summary, const Table& counted) {
    const long second_level = sysconf(_SC_LEVEL2_CACHE_SIZE);
    if (second_level > 0) summary.notes.push_back(fmt::format("Second-level cache here: {} KiB.", second_level / 1024));
    summary.notes.push_back(
        "Time: of the whole render, with making the planes and putting them together at its end. Not in it for any "
        "layout: the framebuffer's own making.");
    if (counted.is_empty()) return;
    if (counted.distinct("source").front() == "cachegrind")
        summary.notes.push_back(fmt::format(
            "Misses: no hardware counters here, so by cachegrind, which simulates caches (bytes, ways, line: {} and "
            "{}) "
            "and counts the same every time. `render` is the functions of the wavefront engine, but for putting planes "
            "together at the end; `accumulate` is what of that adds to the framebuffer.",
            kSimulatedD1, kSimulatedLl));
}

}  // namespace

Summary summarise_framebuffer(const Table& data) {
    Summary summary;
    const Table clock = data.where("source", "clock");
    std::vector<double> gains;  // of interleaving, of the shared pool with all threads
    summary.tables.push_back(times(clock, gains));
    const Table counted = misses_of(data);
    if (!counted.is_empty()) summary.tables.push_back(misses(counted));
    summary.findings.push_back(about_misses(counted));
    summary.findings.push_back(about_time(spread(gains), clock.distinct("threads").back().get<int>()));
    const std::string beside = counted.is_empty() ? "" : " Right: first-level cache misses of one thread.";
    summary.pictures.push_back(
        {"framebuffer", "Three sums side by side, or three planes",
         "Left: time of a thread for each sample, median with lowest and highest run, taken in turns." + beside +
             " What to see: whether the two bars of a pair differ by more than their whiskers. Most of what a pool "
             "reads "
             "and writes are records, not sums."});
    add_notes(summary, counted);
    return summary;
}

}  // namespace raypool::studies
