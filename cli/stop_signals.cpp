#include "cli/stop_signals.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <ctime>

namespace raypool::cli {

namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU};
constexpr std::int64_t kRepetitionNs = 250'000'000;

std::atomic<int> first_signal = 0;
std::atomic<std::int64_t> first_ns = 0;
std::atomic<const std::string*> last_words = nullptr;
std::atomic<bool> has_said = false;
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<std::int64_t>::is_always_lock_free &&
              std::atomic<const std::string*>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

bool is_heard(int signal) {
    struct sigaction action {};
    return sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN;
}

/// Does only what a signal handler may do.
void receive(int signal) {
    const int errno_before = errno;
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    const std::int64_t now = std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
    std::int64_t before = 0;
    if (first_ns.compare_exchange_strong(before, now)) {
        first_signal = signal;
        if (const std::string* words = last_words) has_said = write(STDERR_FILENO, words->data(), words->size()) > 0;
        errno = errno_before;
        return;
    }
    if (signal == SIGXCPU || now - before < kRepetitionNs) return;
    std::signal(signal, SIG_DFL);
    raise(signal);
}

}  // namespace

StopSignals::StopSignals() {
    first_signal = 0;
    first_ns = 0;
    has_said = false;
    last_words = nullptr;
    struct sigaction action {};
    action.sa_handler = receive;
    action.sa_flags = SA_RESTART;
    for (const int signal : kSignals) sigaddset(&action.sa_mask, signal);
    for (const int signal : kSignals)
        if (is_heard(signal)) sigaction(signal, &action, nullptr);
}

StopSignals::~StopSignals() {
    for (const int signal : kSignals)
        if (is_heard(signal)) std::signal(signal, SIG_DFL);
}

std::atomic<int>& StopSignals::received() {
    return first_signal;
}

void StopSignals::set_last_words(const std::string& text) {
    static std::array<std::string, 2> words;  // one of them may be under the handler's eyes
    std::string& next = words[last_words == words.data() ? 1 : 0];
    next = text;
    last_words = &next;
}

bool StopSignals::has_said_last_words() {
    return has_said;
}

}  // namespace raypool::cli
