#include "bench/studies/adaptive_summary.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "bench/accuracy/statistics.h"

namespace raypool::studies {

namespace {

using accuracy::mean;

accuracy::Runs runs_of(const Table& rows) {
    return {rows.numbers("seconds"), rows.numbers("mse")};
}

/// Mean and standard error.
accuracy::Estimate mean_and_error(const std::vector<double>& values) {
    const auto n = static_cast<double>(values.size());
    const double average = mean(values);
    double squares = 0;
    for (const double value : values) squares += (value - average) * (value - average);
    return {average, values.size() < 2 ? 0 : std::sqrt(squares / (n - 1) / n)};
}

}  // namespace

Summary summarise_adaptive(const Table& data) {
    Summary summary;
    const Table runs = data.where("kind", "run");
    TextTable table{"Adaptive against uniform with as many paths: one thread, the fast pool",
                    {"scene", "RMSE asked for", "estimated", "reached", "samples a pixel", "error at equal paths",
                     "time at equal error (uniform / adaptive)", "winner", "shift of the mean, adaptive", "uniform"},
                    {}};
    for (const Value& scene : runs.distinct("scene")) {
        for (const Value& target : runs.where("scene", scene).distinct("target")) {
            const Table own = runs.where("scene", scene).where("target", target);
            const Table adaptive = own.where("method", "adaptive");
            const Table uniform = own.where("method", "uniform");
            const accuracy::Comparison comparison = compare_efficiency(runs_of(adaptive), runs_of(uniform), 1);
            const double reached = std::sqrt(std::max(0.0, mean(adaptive.numbers("mse"))));
            const double equal_paths = std::sqrt(std::max(0.0, mean(uniform.numbers("mse"))));
            const auto shift = [&](const Table& rows) {
                const accuracy::Estimate s = mean_and_error(rows.numbers("shift"));
                return fmt::format("{:+.1e} ± {:.0e}", s.value, s.error);
            };
            const std::string winner = comparison.winner == accuracy::Winner::First    ? "adaptive"
                                       : comparison.winner == accuracy::Winner::Second ? "uniform"
                                                                                       : "no difference";
            table.rows.push_back({scene.get<std::string>(), fmt::format("{:g}", target.get<double>()),
                                  fmt::format("{:.4g}", mean(adaptive.numbers("rmse_estimate"))),
                                  fmt::format("{:.4g}", reached),
                                  fmt::format("{:.1f}", mean(adaptive.numbers("samples"))),
                                  fmt::format("{:.3f} of uniform's", reached / equal_paths),
                                  fmt::format("{:.2f} ({:.2f} to {:.2f})", comparison.ratio, comparison.interval.low,
                                              comparison.interval.high),
                                  winner, shift(adaptive), shift(uniform)});
            if (scene == "half_sky")
                summary.findings.push_back(
                    {"",
                     fmt::format("on half_sky adaptive sampling reaches an RMSE of {:g} sooner", target.get<double>()),
                     "",
                     fmt::format("{:.2f} times as soon ({:.2f} to {:.2f})", comparison.ratio, comparison.interval.low,
                                 comparison.interval.high),
                     comparison.winner == accuracy::Winner::First    ? Verdict::Holds
                     : comparison.winner == accuracy::Winner::Second ? Verdict::DoesNotHold
                                                                     : Verdict::CannotTell,
                     comparison.winner == accuracy::Winner::NoDifference ? "the interval includes 1" : ""});
        }
    }
    summary.tables.push_back(table);

    const Table loads = data.where("kind", "load");
    TextTable balance{"Load of threads: what the busiest threads of all passes trace, over fair shares",
                      {"scene", "sharing", "threads", "uniform", "adaptive"},
                      {}};
    for (const Value& scene : loads.distinct("scene")) {
        for (const Value& sharing : loads.distinct("sharing")) {
            const Table own = loads.where("scene", scene).where("sharing", sharing);
            balance.rows.push_back({scene.get<std::string>(), sharing.get<std::string>(),
                                    fmt::format("{:g}", own.numbers("threads").at(0)),
                                    fmt::format("{:.3f}", own.where("method", "uniform").numbers("load").at(0)),
                                    fmt::format("{:.3f}", own.where("method", "adaptive").numbers("load").at(0))});
        }
    }
    summary.tables.push_back(balance);
    summary.pictures.push_back(
        {"adaptive", "Adaptive sampling against uniform",
         "Left: efficiency 1/(MSE s) of adaptive over uniform sampling, seed by seed, above 1 where adaptive wins. "
         "Right: load of threads under schedules that fix beforehand who does what, hollow for uniform, filled for "
         "adaptive passes. What to see: where noise is uneven over the image adaptive wins, and that noisy pixels "
         "lie together, so that static schedules of lines pay for it."});
    summary.notes.push_back(
        "Errors are against a reference of independent halves, less its noise. Time at equal error is the ratio of "
        "efficiencies 1/(MSE s), with a percentile bootstrap over seeds; the time of the estimates between passes "
        "counts. Pools take lines on the cores that there are, so that a faster core traces more, which is no waiting. "
        "A shift of the mean beyond its standard error, where uniform has none, is the bias of stopping by what was "
        "seen.");
    return summary;
}

}  // namespace raypool::studies
