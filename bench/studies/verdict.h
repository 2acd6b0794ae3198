/// Verdicts over ratios: a claim is decided only where all runs are on one side of what it claims.
#pragma once

#include <string>

#include <fmt/format.h>

#include "bench/studies/statistics.h"
#include "bench/studies/study.h"

namespace raypool::studies {

/// Fewer runs than this fall on one side by chance too often to decide anything.
inline constexpr std::size_t kLeastRuns = 5;

/// Whether a ratio is at least `least`.
inline Verdict is_at_least(const Spread& ratio, double least) {
    if (ratio.runs < kLeastRuns) return Verdict::CannotTell;
    return ratio.low >= least ? Verdict::Holds : ratio.high < least ? Verdict::DoesNotHold : Verdict::CannotTell;
}

/// Why is_at_least() could not tell; empty where it could.
inline std::string why_open(const Spread& ratio, double least) {
    if (ratio.runs < kLeastRuns) return fmt::format("fewer than {} runs", kLeastRuns);
    return is_at_least(ratio, least) == Verdict::CannotTell ? fmt::format("the spread of the runs includes {:g}", least)
                                                            : "";
}

}  // namespace raypool::studies
