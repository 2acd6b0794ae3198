#include "cli/progress_bar.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace raypool::cli {

namespace {

using Clock = std::chrono::steady_clock;

std::string duration(double seconds) {
    const auto whole = static_cast<std::int64_t>(seconds);
    if (whole >= 3600) return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

bool knows_escapes() {
    const char* terminal = std::getenv("TERM");
    return terminal != nullptr && *terminal != '\0' && std::string_view(terminal) != "dumb";
}

/// Of the terminal as it is now, since its window may change.
std::size_t terminal_columns() {
    winsize size{};
    const bool is_known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return is_known ? size.ws_col : 80;
}

void show(const std::stop_token& stop, const Progress& progress, std::int64_t total, const ProgressBar::Unit& unit) {
    const Clock::time_point start = Clock::now();
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    while (!wake.wait_for(lock, stop, std::chrono::milliseconds(100), [&] { return stop.stop_requested(); })) {
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        const std::int64_t done = progress.paths.load(std::memory_order_relaxed);
        fmt::print(stderr, "\r{}\x1b[K",
                   progress_line(done, progress.before, total, unit, seconds, terminal_columns()));
        std::fflush(stderr);
    }
    fmt::print(stderr, "\r\x1b[K");
}

}  // namespace

ProgressBar::ProgressBar(const Progress& progress, std::int64_t total, const Unit& unit, bool is_quiet) {
    if (is_quiet || isatty(STDERR_FILENO) == 0 || !knows_escapes()) return;
    thread_ =
        std::jthread([&progress, total, unit](const std::stop_token& stop) { show(stop, progress, total, unit); });
}

std::string progress_line(std::int64_t done, std::int64_t before, std::int64_t total, const ProgressBar::Unit& unit,
                          double seconds, std::size_t columns) {
    const double rate = static_cast<double>(done - before) / seconds;
    if (total == 0) {  // what is counted, without the "/s" of its rate
        const std::string_view what(unit.name, std::string_view(unit.name).rfind('/'));
        const std::string count = fmt::format("{:.2f} {}", static_cast<double>(done) * unit.scale, what);
        for (std::string line : {fmt::format("{}  {:.2f} {}", count, rate * unit.scale, unit.name), count})
            if (line.size() < columns) return line;
        return "";
    }
    const double part = std::clamp(static_cast<double>(done) / static_cast<double>(total), 0.0, 1.0);
    const auto to_do = static_cast<double>(std::max<std::int64_t>(total - done, 0));
    const std::string percent = fmt::format("{:3.0f} %", 100 * part);
    const std::string speed = fmt::format("  {:.2f} {}", rate * unit.scale, unit.name);
    const std::string left = fmt::format("  {} left", done <= before ? "-:--" : duration(to_do / rate));

    // The last column stays free: a terminal may wrap when it is written to.
    const std::size_t room = std::max<std::size_t>(columns, 1) - 1;
    for (std::string line : {percent + speed + left, percent + left, percent}) {
        if (line.size() > room) continue;
        constexpr std::size_t kLeastCells = 5;
        constexpr std::size_t kMostCells = 30;
        const std::size_t cells = std::min(room - line.size(), kMostCells + 3);
        if (cells < kLeastCells + 3) return line;
        const auto filled = static_cast<std::size_t>(part * static_cast<double>(cells - 3));
        return fmt::format("[{:=<{}}{: <{}}] {}", "", filled, "", cells - 3 - filled, line);
    }
    return "";
}

}  // namespace raypool::cli
