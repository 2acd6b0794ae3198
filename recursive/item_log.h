/// What each work item and each pixel took: for a trace and for a cost image. Free where neither is asked for.
#pragma once

#include <chrono>

#include "core/base/clock.h"
#include "core/image/cost_image.h"
#include "core/runtime/loop.h"
#include "core/runtime/trace.h"

namespace raypool::recursive {

/// The spans of one thread's work items: one for each line, tile or balanced item. Single pixels would be millions, so
/// those of a line that a thread renders one after the other share a span.
class ItemLog {
  public:
    ItemLog(const RenderSettings& settings, int thread)
        : lane_(settings.trace == nullptr ? nullptr : &settings.trace->lane(thread)) {
        constexpr const char* kNames[] = {"pixels", "line", "tile"};
        const bool is_balanced = settings.schedule.kind == LoopSchedule::Kind::Balanced;
        name_ = is_balanced ? "item" : kNames[static_cast<int>(settings.grain.kind)];
        joins_pixels_ = !is_balanced && settings.grain.kind == Grain::Kind::Pixel;
    }
    ItemLog(const ItemLog&) = delete;
    ItemLog& operator=(const ItemLog&) = delete;
    ~ItemLog() { end_span(); }

    /// Whether an item began that has not stopped.
    [[nodiscard]] bool is_started() const { return is_started_; }
    /// An item begins at column x of line y.
    void start(std::int64_t x, std::int64_t y) {
        is_started_ = true;
        if (lane_ == nullptr || (joins_pixels_ && pixels_ > 0 && y == y_)) return;
        end_span();
        x_ = x;
        y_ = y;
        begin_s_ = wall_seconds();
    }
    /// So many pixels of the item were rendered, or parts of their samples.
    void add(std::int64_t pixels) { pixels_ += lane_ == nullptr ? 0 : pixels; }
    void stop() {
        is_started_ = false;
        if (lane_ != nullptr) end_s_ = wall_seconds();
    }

  private:
    void end_span() {
        if (pixels_ == 0) return;
        lane_->span(name_, begin_s_, end_s_, {{{"x", x_}, {"y", y_}, {"pixels", pixels_}}});
        pixels_ = 0;
    }

    Trace::Lane* lane_;
    const char* name_;
    bool joins_pixels_;
    bool is_started_ = false;
    std::int64_t x_ = 0, y_ = 0;
    std::int64_t pixels_ = 0;  ///< of the span under way
    double begin_s_ = 0, end_s_ = 0;
};

/// Writes down what pixels cost.
class PixelCost {
  public:
    explicit PixelCost(CostImage* image) : image_(image) {}

    template <class Tracer>
    void start(const Tracer& tracer) {
        if (image_ != nullptr) before_ = figure(tracer);
    }
    template <class Tracer>
    void stop(const Tracer& tracer, std::int64_t pixel) {
        if (image_ != nullptr)
            add_to<Addition::Atomic>(image_->values[static_cast<std::size_t>(pixel)], figure(tracer) - before_);
    }

  private:
    template <class Tracer>
    [[nodiscard]] std::int64_t figure(const Tracer& tracer) const {
        switch (image_->cost) {
            case Cost::Segments:
                return tracer.segments();
            case Cost::Tests:
                return tracer.work().box_tests + tracer.work().primitive_tests;
            case Cost::Nanoseconds:
                break;
        }
        return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
    }

    CostImage* image_;
    std::int64_t before_ = 0;
};

}  // namespace raypool::recursive
