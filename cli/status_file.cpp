#include "cli/status_file.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>

#include <nlohmann/json.hpp>

#include "cli/print.h"
#include "cli/stopwatch.h"
#include "core/base/json_file.h"
#include "core/base/output_file.h"

namespace raypool::cli {

namespace {

/// What does not change.
struct Task {
    std::string what;
    const char* unit;
    std::int64_t total;
};

nlohmann::json status_json(const Task& task, const Progress& progress, double seconds, bool is_over) {
    const std::int64_t done = progress.paths.load(std::memory_order_relaxed);
    const double rate = seconds > 0 ? static_cast<double>(done - progress.before) / seconds : 0;
    const std::int64_t left = std::max<std::int64_t>(0, task.total - done);
    nlohmann::json seconds_left;
    if (task.total != 0 && left == 0) seconds_left = 0;
    if (left > 0 && rate > 0) seconds_left = static_cast<double>(left) / rate;
    return {{"what", task.what},
            {"state", !is_over    ? "running"
                      : left == 0 ? "done"
                                  : "stopped"},
            {"unit", task.unit},
            {"done", done},
            {"total", task.total == 0 ? nlohmann::json() : nlohmann::json(task.total)},
            {"seconds", seconds},
            {"per_s", rate},
            {"seconds_left", seconds_left}};
}

void keep(const std::stop_token& stop, const std::string& file, const Task& task, const Progress& progress) {
    const Stopwatch watch;
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    try {
        for (bool is_over = false; !is_over;) {
            write_json(file, status_json(task, progress, watch.seconds(), false));
            is_over = wake.wait_for(lock, stop, std::chrono::seconds(2), [&] { return stop.stop_requested(); });
        }
        write_json(file, status_json(task, progress, watch.seconds(), true));
    } catch (const std::exception& error) {
        print(stderr, "raypool: --status: {}; it goes on without it\n", error.what());
    }
}

}  // namespace

StatusFile::StatusFile(const std::string& file, const std::string& what, const char* unit, const Progress& progress,
                       std::int64_t total) {
    if (file.empty()) return;
    check_writable(file);
    thread_ = std::jthread([file, task = Task{what, unit, total}, &progress](const std::stop_token& stop) {
        keep(stop, file, task, progress);
    });
}

}  // namespace raypool::cli
