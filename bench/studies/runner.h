/// Runs a study: repeats interleaved over cases, images checked, every finished run kept.
///
/// A study's folder holds data.csv (a row or more for each repeat of each case, appended as soon as it is known),
/// run.json (what was asked, of which build, on which machine), and then what analysis.h makes of them. A run that was
/// interrupted goes on where it stopped, provided that study, options, build and machine are the same. One that is
/// complete measures nothing again, also by another build, and keeps the build and machine that its figures are of.
#pragma once

#include <atomic>
#include <filesystem>
#include <vector>

#include "bench/studies/run_data.h"
#include "bench/studies/study.h"
#include "core/base/file_lock.h"
#include "core/runtime/engine.h"

namespace raypool::studies {

struct RunControl {
    bool is_fresh = false;                          ///< forget what the folder holds
    const std::atomic<int>* stop_signal = nullptr;  ///< where it is not 0, the run ends after the case under way
    Progress* progress = nullptr;                   ///< counts finished repeats of cases, those found in the folder too
};

/// The order in which turn 0, 1, 2, ... goes through `count` things: each turn by another stride, so that none always
/// follows the same other. Turn 0 goes through them as they stand.
std::vector<std::size_t> turn_order(std::size_t count, std::size_t turn);

/// How many repeats of cases the study takes in all.
std::int64_t run_count(const Study& study, const StudyOptions& options);

/// Makes the folder, and keeps other processes from running a study in it while the lock lives: a caller of
/// run_study() or analyse() holds one. Throws InputError where another process is at work there.
[[nodiscard]] FileLock lock_folder(const std::filesystem::path& folder);

/// Returns false when it was stopped before the end. Leaves rows and run.json, for analysis.h. Throws InputError when
/// the folder holds another run or cannot be written to, and WrongImage.
bool run_study(const Study& study, const StudyOptions& options, const std::filesystem::path& folder,
               const RunControl& control);

}  // namespace raypool::studies
