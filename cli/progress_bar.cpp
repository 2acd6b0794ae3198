#include "cli/progress_bar.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <string>

#include <fmt/format.h>

namespace raypool::cli {

namespace {

using Clock = std::chrono::steady_clock;

std::string duration(double seconds) {
    const auto whole = static_cast<std::int64_t>(seconds);
    if (whole >= 3600) return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

std::string line(std::int64_t done, std::int64_t total, const ProgressBar::Unit& unit, double seconds) {
    constexpr int kCells = 30;
    const double part = static_cast<double>(done) / static_cast<double>(total);
    const int filled = static_cast<int>(part * kCells);
    const double rate = static_cast<double>(done) / seconds;
    const std::string left = done == 0 ? "-:--" : duration(static_cast<double>(total - done) / rate);
    return fmt::format("\r[{:=<{}}{: <{}}] {:3.0f} %  {:.2f} {}  {} left \x1b[K", "", filled, "", kCells - filled,
                       100 * part, rate * unit.scale, unit.name, left);
}

void show(const std::stop_token& stop, const Progress& progress, std::int64_t total, const ProgressBar::Unit& unit) {
    const Clock::time_point start = Clock::now();
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    while (!wake.wait_for(lock, stop, std::chrono::milliseconds(100), [&] { return stop.stop_requested(); })) {
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        fmt::print(stderr, "{}", line(progress.paths.load(std::memory_order_relaxed), total, unit, seconds));
        std::fflush(stderr);
    }
    fmt::print(stderr, "\r\x1b[K");
}

}  // namespace

ProgressBar::ProgressBar(const Progress& progress, std::int64_t total, const Unit& unit, bool is_quiet) {
    if (is_quiet || isatty(STDERR_FILENO) == 0) return;
    thread_ =
        std::jthread([&progress, total, unit](const std::stop_token& stop) { show(stop, progress, total, unit); });
}

}  // namespace raypool::cli
