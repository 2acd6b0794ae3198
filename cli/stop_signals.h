/// The signals by which a terminal, a user or a batch system asks a program to end soon.
#pragma once

#include <atomic>
#include <string>

namespace raypool::cli {

/// Takes SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2 and SIGXCPU while it lives; there is one at a time. What was ignored
/// stays ignored, as nohup wants it. The first signal is kept to be asked for; a later one ends the program at once.
/// What comes within a quarter of a second counts as the first, since `timeout` signals a process and then its group.
/// So does any further SIGXCPU, which the system sends again with each second of processor time.
class StopSignals {
  public:
    StopSignals();
    StopSignals(const StopSignals&) = delete;
    StopSignals& operator=(const StopSignals&) = delete;
    ~StopSignals();

    /// The first one that came; 0 where none has.
    static std::atomic<int>& received();

    /// What is written to standard error when the first signal comes. May be changed at any time, by one thread.
    static void set_last_words(const std::string& text);
    static bool has_said_last_words();
};

}  // namespace raypool::cli
