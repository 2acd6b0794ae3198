/// What a lane of a trace says: its spans by name, and whether they nest.
///
/// Called by tests/recursive/ and tests/wavefront/.
#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "core/runtime/engine.h"
#include "core/runtime/trace.h"

namespace raypool::test {

using Events = std::vector<Trace::Event>;

inline Events named(const Trace::Lane& lane, std::string_view name) {
    Events found;
    for (const Trace::Event& event : lane.events())
        if (event.name == name) found.push_back(event);
    return found;
}

inline std::int64_t figure(const Trace::Event& event, std::string_view name) {
    for (const Trace::Figure& figure : event.figures)
        if (figure.name != nullptr && figure.name == name) return figure.value;
    ADD_FAILURE() << event.name << " has no figure " << name;
    return -1;
}

inline std::int64_t sum(const Events& events, std::string_view name) {
    std::int64_t total = 0;
    for (const Trace::Event& event : events) total += figure(event, name);
    return total;
}

inline double seconds(const Events& events) {
    double total = 0;
    for (const Trace::Event& event : events) total += event.end_s - event.begin_s;
    return total;
}

/// Two spans of a lane have no time in common, or one lies in the other.
inline void expect_nested(const Trace::Lane& lane) {
    Events spans;
    for (const Trace::Event& event : lane.events())
        if (event.kind == Trace::Event::Kind::Span) spans.push_back(event);
    std::stable_sort(spans.begin(), spans.end(), [](const Trace::Event& a, const Trace::Event& b) {
        return a.begin_s < b.begin_s || (a.begin_s == b.begin_s && a.end_s > b.end_s);
    });
    Events around;
    for (const Trace::Event& span : spans) {
        EXPECT_LE(span.begin_s, span.end_s) << span.name;
        while (!around.empty() && around.back().end_s <= span.begin_s) around.pop_back();
        if (!around.empty()) {
            EXPECT_LE(span.end_s, around.back().end_s) << span.name << " sticks out of " << around.back().name;
        }
        around.push_back(span);
    }
}

/// Seconds that lie in some span of the lane.
inline double covered(const Trace::Lane& lane) {
    Events spans;
    for (const Trace::Event& event : lane.events())
        if (event.kind == Trace::Event::Kind::Span) spans.push_back(event);
    std::sort(spans.begin(), spans.end(),
              [](const Trace::Event& a, const Trace::Event& b) { return a.begin_s < b.begin_s; });
    double total = 0;
    double end = 0;
    for (const Trace::Event& span : spans) {
        total += std::max(0.0, span.end_s - std::max(span.begin_s, end));
        end = std::max(end, span.end_s);
    }
    return total;
}

/// All spans lie in the render, and each thread's waiting is what the report says.
inline void expect_agreement(const Trace& trace, const RenderReport& report) {
    constexpr double kRounding = 1e-9;
    ASSERT_EQ(trace.lanes().size(), report.threads.size());
    EXPECT_EQ(trace.dropped_count(), 0);
    for (std::size_t i = 0; i < trace.lanes().size(); ++i) {
        const Trace::Lane& lane = trace.lanes()[i];
        expect_nested(lane);
        const Events waits = named(lane, "wait");
        EXPECT_NEAR(seconds(waits), report.threads[i].wait_s, kRounding * static_cast<double>(1 + waits.size()));
        for (const Trace::Event& event : lane.events()) EXPECT_GE(event.begin_s, trace.start_s());
        EXPECT_LE(covered(lane), report.seconds + kRounding * static_cast<double>(lane.events().size()));
    }
}

}  // namespace raypool::test
