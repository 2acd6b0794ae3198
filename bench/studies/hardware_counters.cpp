// count_by_hardware() of cache_counts.h, by Linux's perf events.

#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstring>

#include "bench/studies/cache_counts.h"

namespace raypool::studies {

namespace {

/// One event of this thread, in user space; it counts from start() to stop().
class Event {
  public:
    Event(std::uint64_t cache, std::uint64_t operation, std::uint64_t result) {
        perf_event_attr attributes;
        std::memset(&attributes, 0, sizeof(attributes));
        attributes.size = sizeof(attributes);
        attributes.type = PERF_TYPE_HW_CACHE;
        attributes.config = cache | operation << 8U | result << 16U;
        attributes.disabled = 1;
        attributes.exclude_kernel = 1;
        attributes.exclude_hv = 1;
        attributes.read_format = PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING;
        file_ = static_cast<int>(syscall(SYS_perf_event_open, &attributes, 0, -1, -1, PERF_FLAG_FD_CLOEXEC));
    }
    Event(const Event&) = delete;
    Event& operator=(const Event&) = delete;
    ~Event() {
        if (file_ >= 0) close(file_);
    }

    [[nodiscard]] bool exists() const { return file_ >= 0; }
    void start() const {
        if (exists()) ioctl(file_, PERF_EVENT_IOC_ENABLE, 0);
    }
    void stop() const {
        if (exists()) ioctl(file_, PERF_EVENT_IOC_DISABLE, 0);
    }
    /// Scaled up where the event shared its counter with others.
    [[nodiscard]] std::optional<std::int64_t> count() const {
        struct {
            std::uint64_t value, enabled, running;
        } read_back{};
        if (!exists() || read(file_, &read_back, sizeof(read_back)) != sizeof(read_back) || read_back.running == 0)
            return std::nullopt;
        return static_cast<std::int64_t>(static_cast<double>(read_back.value) * static_cast<double>(read_back.enabled) /
                                         static_cast<double>(read_back.running));
    }

  private:
    int file_;
};

}  // namespace

std::optional<CacheCounts> count_by_hardware(const std::function<void()>& work) {
    constexpr std::uint64_t kRead = PERF_COUNT_HW_CACHE_OP_READ;
    constexpr std::uint64_t kWrite = PERF_COUNT_HW_CACHE_OP_WRITE;
    constexpr std::uint64_t kAccess = PERF_COUNT_HW_CACHE_RESULT_ACCESS;
    constexpr std::uint64_t kMiss = PERF_COUNT_HW_CACHE_RESULT_MISS;
    const Event events[] = {{PERF_COUNT_HW_CACHE_L1D, kRead, kAccess}, {PERF_COUNT_HW_CACHE_L1D, kWrite, kAccess},
                            {PERF_COUNT_HW_CACHE_L1D, kRead, kMiss},   {PERF_COUNT_HW_CACHE_L1D, kWrite, kMiss},
                            {PERF_COUNT_HW_CACHE_LL, kRead, kMiss},    {PERF_COUNT_HW_CACHE_LL, kWrite, kMiss}};
    if (!events[0].exists() || !events[2].exists()) return std::nullopt;  // a rate of misses needs these two
    for (const Event& event : events) event.start();
    work();
    for (const Event& event : events) event.stop();
    return CacheCounts{events[0].count(), events[1].count(), events[2].count(),
                       events[3].count(), events[4].count(), events[5].count()};
}

}  // namespace raypool::studies
