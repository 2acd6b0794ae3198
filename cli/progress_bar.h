/// A progress bar on the terminal: part done, rate, time left. Says nothing when stderr is not a terminal.
#pragma once

#include <cstdint>
#include <thread>

#include "core/engine.h"

namespace raypool::cli {

/// Shows `progress` ten times a second while it lives, from a thread of its own, and wipes itself out at the end.
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

}  // namespace raypool::cli
