/// What each thread did when, for a picture of a render: spans of work and of waiting, and counters, a lane a thread.
///
/// Engines put events in, where RenderSettings::trace says so; the command writes them as a Chrome trace, which
/// Perfetto (ui.perfetto.dev) and chrome://tracing open. Names are literals: only pointers are kept.
/// Memory is bounded: a lane keeps its first kMostEvents events, or what there is memory for, and counts what it had to
/// drop.
/// Thread safety: begin() and what reads are for one thread alone; a lane is for the thread that it belongs to.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <new>
#include <string>
#include <vector>

namespace raypool {

class Trace {
  public:
    static constexpr std::size_t kMostEvents = 100'000;  ///< of a thread: 8 MB

    /// A figure beside an event; without a name, none.
    struct Figure {
        const char* name = nullptr;
        std::int64_t value = 0;
    };
    using Figures = std::array<Figure, 3>;

    struct Event {
        enum class Kind : std::uint8_t { Span, Counter, ThreadCounter };
        const char* name;
        double begin_s;  ///< by wall_seconds()
        double end_s;    ///< of a counter the same
        Figures figures;
        Kind kind;
    };

    /// The events of one thread.
    class alignas(64) Lane {
      public:
        void span(const char* name, double begin_s, double end_s, const Figures& figures) {
            add({name, begin_s, end_s, figures, Event::Kind::Span});
        }
        void span(const char* name, double begin_s, double end_s) { span(name, begin_s, end_s, {}); }
        /// `records` are in a pool from `now_s` on: in this thread's own, or in the one that all share.
        void occupancy(double now_s, std::int64_t records, Event::Kind pool) {
            add({"records in pool", now_s, now_s, {Figure{"records", records}}, pool});
        }
        [[nodiscard]] const std::vector<Event>& events() const { return events_; }
        [[nodiscard]] std::int64_t dropped() const { return dropped_; }

      private:
        void add(const Event& event) {
            if (events_.size() == kMostEvents) {
                ++dropped_;
                return;
            }
            try {
                events_.push_back(event);
            } catch (const std::bad_alloc&) {  // what is looked at shall not end by being looked at
                ++dropped_;
            }
        }
        std::vector<Event> events_;
        std::int64_t dropped_ = 0;
    };

    /// A render in `threads` threads begins. Times count from the first one; the later passes of an image that is
    /// rendered in several go on in the same lanes.
    void begin(double start_s, int threads) {
        if (lanes_.empty()) start_s_ = start_s;
        lanes_.resize(std::max(lanes_.size(), static_cast<std::size_t>(threads)));
    }
    /// Drops the lanes behind the last one that holds anything: of threads that OpenMP did not give.
    void drop_idle_lanes() {
        while (!lanes_.empty() && lanes_.back().events().empty()) lanes_.pop_back();
    }
    Lane& lane(int thread) { return lanes_[static_cast<std::size_t>(thread)]; }
    [[nodiscard]] const std::vector<Lane>& lanes() const { return lanes_; }
    [[nodiscard]] double start_s() const { return start_s_; }
    [[nodiscard]] std::int64_t event_count() const;
    [[nodiscard]] std::int64_t dropped_count() const;

  private:
    double start_s_ = 0;
    std::vector<Lane> lanes_;
};

/// Writes a Chrome trace, whole or not at all: a JSON object with traceEvents (complete events, counters, and the names
/// of process and threads; times in microseconds from the start) and, in otherData, `about` and what was dropped.
void write_trace(const std::filesystem::path& path, const Trace& trace,
                 const std::map<std::string, std::string>& about);

}  // namespace raypool
