/// A loop whose iterations are handed out to the threads of a parallel region, as a LoopSchedule says: by OpenMP's
/// `for` or by its tasks.
#pragma once

#include <omp.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/clock.h"
#include "core/runtime/engine.h"
#include "core/runtime/trace.h"

namespace raypool {

/// Made outside of the region, for one loop in it. run_threads() has given OpenMP the schedule.
class TeamLoop {
  public:
    explicit TeamLoop(const RenderSettings& settings)
        : settings_(settings), tasks_(static_cast<std::size_t>(settings.threads)) {}
    TeamLoop(const TeamLoop&) = delete;
    TeamLoop& operator=(const TeamLoop&) = delete;

    /// Every thread of the region calls it, with a visit of its own, which that thread then calls for iterations out of
    /// 0 .. count - 1. It must not throw. Returns the seconds that the thread waited for others, which is nothing but
    /// where there are tasks: other loops have no barrier.
    template <class Visit>
    double run(std::int64_t count, Visit visit) {
        if (settings_.schedule.kind == LoopSchedule::Kind::Tasks)
            return run_tasks(count, std::ref(visit));  // no memory for a copy
#pragma omp for schedule(runtime) nowait
        for (std::int64_t i = 0; i < count; ++i) visit(i);
        return 0;
    }

  private:
    /// The tasks of one thread: a task is made by one and may be done by another, which has a pool of its own.
    struct alignas(64) ThreadTasks {
        std::function<void(std::int64_t)> visit;
        double end_s = 0;  ///< of the latest
    };

    double run_tasks(std::int64_t count, std::function<void(std::int64_t)> visit) {
        ThreadTasks& own = tasks_[static_cast<std::size_t>(omp_get_thread_num())];
        own = {std::move(visit), wall_seconds()};
        // Threads do tasks while they wait at the end of the single.
#pragma omp single
        {
            const std::int64_t chunk = settings_.schedule.chunk;
            if (chunk == 0) {
                const auto end = static_cast<std::uint64_t>(count);  // clang's bounds of a taskloop are unsigned
#pragma omp taskloop
                for (std::uint64_t i = 0; i < end; ++i) do_task(static_cast<std::int64_t>(i));
            } else {
                // libgomp gives a taskloop of more than 64 tasks a thread to one thread alone.
                const std::int64_t most = 64 * chunk * omp_get_num_threads();
                for (std::int64_t first = 0; first < count; first += most) {
                    const auto begin = static_cast<std::uint64_t>(first);
                    const auto end = static_cast<std::uint64_t>(std::min(first + most, count));
#pragma omp taskloop grainsize(chunk)
                    for (std::uint64_t i = begin; i < end; ++i) do_task(static_cast<std::int64_t>(i));
                }
            }
        }
        const double end_s = wall_seconds();
        if (settings_.trace != nullptr) settings_.trace->lane(omp_get_thread_num()).span("wait", own.end_s, end_s);
        return end_s - own.end_s;
    }
    void do_task(std::int64_t i) {
        ThreadTasks& own = tasks_[static_cast<std::size_t>(omp_get_thread_num())];
        own.visit(i);
        own.end_s = wall_seconds();
    }

    const RenderSettings& settings_;
    std::vector<ThreadTasks> tasks_;  ///< by thread
};

}  // namespace raypool
