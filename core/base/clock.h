/// The two clocks that figures are read from.
#pragma once

#include <chrono>
#include <ctime>

namespace raypool {

/// Seconds since a moment of the system's choice, to the nanosecond. It never goes back, which the clock of LLVM's
/// OpenMP does when the system's time is set, and that one counts microseconds.
inline double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Processor time of the calling thread, in seconds: what other processes take meanwhile does not count.
inline double processor_seconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace raypool
