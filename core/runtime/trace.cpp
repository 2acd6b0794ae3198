#include "core/runtime/trace.h"

#include <cmath>
#include <iterator>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/json_file.h"
#include "core/base/output_file.h"

namespace raypool {

namespace {

constexpr int kProcess = 1;

/// Whole nanoseconds, so that what nests in seconds nests in the file.
std::int64_t nanoseconds(double seconds) {
    return std::llround(seconds * 1e9);
}

std::string microseconds(std::int64_t ns) {
    return fmt::format("{}.{:03}", ns / 1000, ns % 1000);
}

void append_name(std::string& text, const char* what, std::size_t thread, const std::string& name) {
    fmt::format_to(std::back_inserter(text),
                   "{{\"ph\":\"M\",\"name\":\"{}\",\"ts\":0,\"pid\":{},\"tid\":{},\"args\":{{\"name\":\"{}\"}}}}", what,
                   kProcess, thread, name);
}

void append_event(std::string& text, const Trace::Event& event, double start_s, std::size_t thread) {
    const std::int64_t begin = nanoseconds(event.begin_s - start_s);
    const std::int64_t end = nanoseconds(event.end_s - start_s);
    std::string name = event.name;
    std::string_view phase = "C";
    std::string duration;
    if (event.kind == Trace::Event::Kind::Span) {
        phase = "X";
        duration = fmt::format("\"dur\":{},", microseconds(end - begin));
    } else if (event.kind == Trace::Event::Kind::ThreadCounter) {  // counters of one name are one track
        name += fmt::format(" of thread {}", thread);
    }
    fmt::format_to(std::back_inserter(text),
                   ",\n{{\"ph\":\"{}\",\"name\":\"{}\",\"ts\":{},{}\"pid\":{},\"tid\":{},\"args\":{{", phase, name,
                   microseconds(begin), duration, kProcess, thread);
    const char* separator = "";
    for (const Trace::Figure& figure : event.figures) {
        if (figure.name == nullptr) continue;
        fmt::format_to(std::back_inserter(text), "{}\"{}\":{}", separator, figure.name, figure.value);
        separator = ",";
    }
    text += "}}";
}

}  // namespace

std::int64_t Trace::event_count() const {
    std::int64_t count = 0;
    for (const Lane& lane : lanes_) count += std::ssize(lane.events());
    return count;
}

std::int64_t Trace::dropped_count() const {
    std::int64_t count = 0;
    for (const Lane& lane : lanes_) count += lane.dropped();
    return count;
}

void write_trace(const std::filesystem::path& path, const Trace& trace,
                 const std::map<std::string, std::string>& about) {
    nlohmann::json other = about;
    other["events_dropped"] = trace.dropped_count();
    other["most_events_of_a_thread"] = Trace::kMostEvents;
    std::string text = "{\"displayTimeUnit\":\"ms\",\n\"otherData\":" + json_text(other, JsonLayout::OneLine) +
                       ",\n\"traceEvents\":[\n";
    append_name(text, "process_name", 0, "raypool");
    for (std::size_t thread = 0; thread < trace.lanes().size(); ++thread) {
        text += ",\n";
        append_name(text, "thread_name", thread, fmt::format("thread {}", thread));
        for (const Trace::Event& event : trace.lanes()[thread].events())
            append_event(text, event, trace.start_s(), thread);
    }
    text += "\n]}\n";
    write_whole(path, std::as_bytes(std::span(text)));
}

}  // namespace raypool
