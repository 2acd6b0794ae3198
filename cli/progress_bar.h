/// A progress bar on the terminal: part done, rate, time left. Says nothing where stderr is no terminal, or one that
/// knows no escapes (TERM is not set, or dumb).
#pragma once

#include <cstdint>
#include <string>
#include <thread>

#include "core/runtime/engine.h"

namespace raypool::cli {

/// Shows `progress`, of `total` or, where that is 0, of what is not known beforehand, ten times a second while it
/// lives, from a thread of its own, and wipes itself out at the end.
class ProgressBar {
  public:
    /// How the rate is shown: `scale` times what is counted, a second.
    struct Unit {
        const char* name;
        double scale;
    };
    ProgressBar(const Progress& progress, std::int64_t total, const Unit& unit, bool is_quiet);

  private:
    std::jthread thread_;
};

/// What is shown after `seconds`, `before` of what is done being from an earlier run, in fewer than `columns`
/// characters, so that no terminal wraps it: what has no room is left out, the rate first, then the time left, and the
/// bar takes what they leave.
std::string progress_line(std::int64_t done, std::int64_t before, std::int64_t total, const ProgressBar::Unit& unit,
                          double seconds, std::size_t columns);

}  // namespace raypool::cli
