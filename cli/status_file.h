/// How far a render or a study is, for those who cannot see its terminal: a file of JSON that is written anew while it
/// runs.
#pragma once

#include <cstdint>
#include <string>
#include <thread>

#include "core/runtime/engine.h"

namespace raypool::cli {

/// Writes {"what", "state", "unit", "done", "total", "seconds", "per_s", "seconds_left"} to the file every two seconds
/// while it lives, from a thread of its own, and at its end. The state is "running", and in the end "done", or "stopped"
/// where some of the total is missing. The total and what is left of it are null where they are not known beforehand;
/// seconds and rate are of this run. Where the file cannot be written it says so once on standard error.
class StatusFile {
  public:
    /// `what` goes on, `total` units of it, or 0 where that is not known. An empty name is no file; refuses (InputError)
    /// one that cannot be written.
    StatusFile(const std::string& file, const std::string& what, const char* unit, const Progress& progress,
               std::int64_t total);

  private:
    std::jthread thread_;
};

}  // namespace raypool::cli
