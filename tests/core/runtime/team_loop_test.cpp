/// A loop by any schedule: each iteration once, and by the visitor of the thread that does it.
#include "core/runtime/team_loop.h"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include <fmt/format.h>

#include "core/runtime/loop.h"
#include "core/runtime/settings_text.h"

namespace raypool::test {
namespace {

constexpr const char* kSchedules[] = {"static",   "static,3", "dynamic", "dynamic,4",  "guided",
                                      "guided,2", "tasks",    "tasks,1", "tasks,1000", "balanced"};

TEST(TeamLoop, DoesEachIterationOnceByTheVisitorOfItsThread) {
    for (const char* schedule : kSchedules) {
        for (const int threads : {1, 2, 5}) {
            for (const std::int64_t count : {0, 1, 7, 200}) {
                SCOPED_TRACE(fmt::format("{}, {} threads, {} iterations", schedule, threads, count));
                RenderSettings settings;
                settings.threads = threads;
                settings.schedule = parse_schedule(schedule);
                std::vector<int> visits(static_cast<std::size_t>(count));  // no two threads have one of them
                std::atomic<int> strangers = 0;
                TeamLoop loop(settings);
                const RenderReport report = run_threads(settings, [&](ThreadReport& work, SampleStatistics&) {
                    const int thread = omp_get_thread_num();
                    work.wait_s = loop.run(count, [&, thread](std::int64_t i) {
                        if (omp_get_thread_num() != thread) ++strangers;
                        ++visits[static_cast<std::size_t>(i)];
                        ++work.paths;
                    });
                });
                EXPECT_EQ(visits, std::vector<int>(visits.size(), 1));
                EXPECT_EQ(strangers, 0);
                EXPECT_EQ(report.paths(), count);
            }
        }
    }
}

/// `count` tasks of two threads. A thread's paths are the tasks that it did.
RenderReport run_tasks(std::int64_t count, std::chrono::microseconds task) {
    RenderSettings settings;
    settings.threads = 2;
    settings.schedule = parse_schedule("tasks,1");
    TeamLoop loop(settings);
    return run_threads(settings, [&](ThreadReport& work, SampleStatistics&) {
        work.wait_s = loop.run(count, [&](std::int64_t) {
            std::this_thread::sleep_for(task);  // so that the other thread runs on a busy machine too
            ++work.paths;
        });
    });
}

/// Far more than a runtime keeps in line for two threads.
TEST(TeamLoop, SharesOutTasksHoweverMany) {
    for (const ThreadReport& thread : run_tasks(1000, std::chrono::microseconds(50)).threads)
        EXPECT_GT(thread.paths, 100);
}

TEST(TeamLoop, CountsWaitingForTasksAsWaiting) {
    const RenderReport report = run_tasks(1, std::chrono::milliseconds(50));
    for (const ThreadReport& thread : report.threads) {
        if (thread.paths == 0) {
            EXPECT_GT(thread.wait_s, 0.03);
        } else {
            EXPECT_GE(thread.busy_s, 0.05);
        }
    }
}

}  // namespace
}  // namespace raypool::test
