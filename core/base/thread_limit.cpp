#include "core/base/thread_limit.h"

#include <omp.h>
#include <pthread.h>

#include <algorithm>
#include <cctype>
#include <climits>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.h"

namespace raypool {

namespace {

/// As OpenMP reads it: a number and B, K, M or G, where nothing is K. 0 where it says nothing.
std::size_t openmp_stack_bytes() {
    const char* text = std::getenv("OMP_STACKSIZE");
    if (text == nullptr) return 0;
    char* end = nullptr;
    const unsigned long long number = std::strtoull(text, &end, 10);
    if (end == text) return 0;
    while (std::isspace(static_cast<unsigned char>(*end)) != 0) ++end;
    int shift = 10;
    switch (std::toupper(static_cast<unsigned char>(*end))) {
        case 'B':
            shift = 0;
            break;
        case 'M':
            shift = 20;
            break;
        case 'G':
            shift = 30;
            break;
        default:
            break;
    }
    return number > (ULLONG_MAX >> shift) ? 0 : static_cast<std::size_t>(number << shift);
}

/// Threads that live until all of them are there.
class Trial {
  public:
    /// Returns how many of `count` could be created, and in `error` why no more.
    int run(int count, int& error) {
        pthread_attr_t attributes;
        pthread_attr_init(&attributes);
        const std::size_t stack = openmp_stack_bytes();
        if (stack >= static_cast<std::size_t>(PTHREAD_STACK_MIN)) pthread_attr_setstacksize(&attributes, stack);
        std::vector<pthread_t> threads;
        threads.reserve(static_cast<std::size_t>(count));
        for (error = 0; static_cast<int>(threads.size()) < count;) {
            pthread_t thread{};
            error = pthread_create(&thread, &attributes, &Trial::wait, this);
            if (error != 0) break;
            threads.push_back(thread);
        }
        pthread_attr_destroy(&attributes);
        {
            const std::scoped_lock lock(mutex_);
            is_over_ = true;
        }
        over_.notify_all();
        for (const pthread_t thread : threads) pthread_join(thread, nullptr);
        return static_cast<int>(threads.size());
    }

  private:
    static void* wait(void* trial) {
        auto* self = static_cast<Trial*>(trial);
        std::unique_lock lock(self->mutex_);
        self->over_.wait(lock, [self] { return self->is_over_; });
        return nullptr;
    }

    std::mutex mutex_;
    std::condition_variable over_;
    bool is_over_ = false;
};

}  // namespace

void check_thread_count(int count, const char* option) {
    constexpr int kMostThreads = 4096;
    const int limit = std::min(omp_get_thread_limit(), kMostThreads);
    if (count < 1 || count > limit)
        throw InputError(fmt::format("{}: must be within [1, {}]{}, got {}", option, limit,
                                     limit < kMostThreads ? " (OMP_THREAD_LIMIT)" : "", count));
    int error = 0;
    const int created = 1 + Trial().run(count - 1, error);
    if (created < count)
        throw InputError(
            fmt::format("{}: of {} threads the system lets this process have {} ({}); ask for fewer, or "
                        "raise the limit (`ulimit -u`, pids.max of the control group) or, where memory is "
                        "what lacks, `ulimit -v` or OMP_STACKSIZE",
                        option, count, created, std::strerror(error)));
}

}  // namespace raypool
