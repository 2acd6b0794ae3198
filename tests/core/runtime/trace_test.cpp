/// A trace is a whole Chrome trace whatever was recorded, and stays within its bound.
#include "core/runtime/trace.h"

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "tests/scratch_folder.h"

namespace raypool::test {
namespace {

using nlohmann::json;

class TraceFile : public testing::Test {
  protected:
    json written(const Trace& trace) {
        const auto path = scratch_ / "trace.json";
        write_trace(path, trace, {{"raypool.scene", "a \"quoted\" name"}});
        std::ifstream file(path);
        return json::parse(file);
    }
    ScratchFolder scratch_;
};

TEST_F(TraceFile, OfNothingIsAWholeTrace) {
    const json trace = written(Trace());
    EXPECT_EQ(trace["otherData"]["events_dropped"], 0);
    EXPECT_EQ(trace["otherData"]["raypool.scene"], "a \"quoted\" name");
    ASSERT_EQ(trace["traceEvents"].size(), 1U);
    EXPECT_EQ(trace["traceEvents"][0]["name"], "process_name");
}

TEST_F(TraceFile, HasMicrosecondsFromTheStartAndALaneForEachThread) {
    Trace trace;
    trace.begin(100, 2);
    trace.lane(1).span("shade", 100.5, 100.75, {{{"records", 7}, {"batch", 3}}});
    trace.lane(0).occupancy(101, 12, Trace::Event::Kind::Counter);
    trace.lane(1).occupancy(102, 13, Trace::Event::Kind::ThreadCounter);
    const json events = written(trace)["traceEvents"];
    ASSERT_EQ(events.size(), 6U);
    const auto expect = [&](json expected) {
        EXPECT_EQ(std::count(events.begin(), events.end(), expected), 1) << expected << "\n" << events;
    };
    for (const int thread : {0, 1})
        expect({{"ph", "M"},
                {"name", "thread_name"},
                {"ts", 0},
                {"pid", 1},
                {"tid", thread},
                {"args", {{"name", "thread " + std::to_string(thread)}}}});
    expect({{"ph", "X"},
            {"name", "shade"},
            {"ts", 500000.0},
            {"dur", 250000.0},
            {"pid", 1},
            {"tid", 1},
            {"args", {{"records", 7}, {"batch", 3}}}});
    expect(
        {{"ph", "C"}, {"name", "records in pool"}, {"ts", 1e6}, {"pid", 1}, {"tid", 0}, {"args", {{"records", 12}}}});
    expect({{"ph", "C"},
            {"name", "records in pool of thread 1"},
            {"ts", 2e6},
            {"pid", 1},
            {"tid", 1},
            {"args", {{"records", 13}}}});
}

TEST_F(TraceFile, KeepsTheFirstEventsOfAThreadAndCountsTheOthers) {
    Trace trace;
    trace.begin(0, 2);
    for (std::size_t i = 0; i < Trace::kMostEvents + 5; ++i)
        trace.lane(0).span("line", static_cast<double>(i), static_cast<double>(i + 1));
    trace.lane(1).span("line", 0, 1);
    EXPECT_EQ(trace.event_count(), static_cast<std::int64_t>(Trace::kMostEvents) + 1);
    EXPECT_EQ(trace.dropped_count(), 5);
    EXPECT_EQ(trace.lanes()[0].events().back().end_s, static_cast<double>(Trace::kMostEvents));
    EXPECT_EQ(written(trace)["otherData"]["events_dropped"], 5);
}

TEST(Trace, GoesOnInLaterPassesOfTheSameImage) {
    Trace trace;
    trace.begin(2, 3);
    trace.lane(2).span("line", 2, 3);
    trace.begin(5, 1);
    trace.lane(0).span("line", 5, 6);
    EXPECT_EQ(trace.lanes().size(), 3U);
    EXPECT_EQ(trace.event_count(), 2);
    EXPECT_EQ(trace.start_s(), 2);
}

TEST(Trace, ToAPlaceThatCannotBeWrittenIsRefused) {
    EXPECT_THROW(write_trace("absent/trace.json", Trace(), {}), InputError);
}

}  // namespace
}  // namespace raypool::test
