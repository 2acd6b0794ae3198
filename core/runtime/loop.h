/// The parallel loop that engines share: how an image is cut into work items, and how threads are run and timed.
#pragma once

#include <omp.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <vector>

#include "core/base/clock.h"
#include "core/base/first_exception.h"
#include "core/runtime/engine.h"
#include "core/runtime/trace.h"

namespace raypool {

/// Pixels [x_begin, x_end) of lines [y_begin, y_end).
struct PixelRange {
    std::int64_t x_begin, x_end, y_begin, y_end;
};

/// Pixels of one line: side by side, or those of a list.
struct LinePixels {
    std::int64_t first;         ///< in the image; without a list, the pixels follow each other from here
    const std::uint32_t* list;  ///< or null
    std::int64_t count;
    [[nodiscard]] std::int64_t operator[](std::int64_t i) const {
        return list == nullptr ? first + i : static_cast<std::int64_t>(list[i]);
    }
};

/// The image cut into pixels, lines or tiles, numbered along lines from the top left. Of a rising list of pixels, which
/// outlives this, there are only the items that hold some of them, and nothing is done for any other.
class WorkItems {
  public:
    WorkItems(std::int64_t width, std::int64_t height, const Grain& grain,
              const std::vector<std::uint32_t>* pixels = nullptr)
        : width_(width), height_(height), pixels_(pixels) {
        item_width_ = grain.kind == Grain::Kind::Line ? width : grain.kind == Grain::Kind::Tile ? grain.tile : 1;
        item_height_ = grain.kind == Grain::Kind::Tile ? grain.tile : 1;
        columns_ = (width + item_width_ - 1) / item_width_;
        rows_ = (height + item_height_ - 1) / item_height_;
        if (pixels_ != nullptr && !are_single_pixels()) find_items();
    }
    [[nodiscard]] std::int64_t count() const {
        if (pixels_ == nullptr) return columns_ * rows_;
        return are_single_pixels() ? std::ssize(*pixels_) : std::ssize(items_);
    }
    [[nodiscard]] PixelRange range(std::int64_t item) const {
        const std::int64_t id = id_of(item);
        const std::int64_t x = id % columns_ * item_width_;
        const std::int64_t y = id / columns_ * item_height_;
        return {x, std::min(x + item_width_, width_), y, std::min(y + item_height_, height_)};
    }
    /// Calls visit(LinePixels) for each line of an item.
    template <class Visit>
    void for_each_line(std::int64_t item, Visit visit) const {
        if (pixels_ != nullptr && are_single_pixels()) {
            visit(LinePixels{0, pixels_->data() + item, 1});
            return;
        }
        const PixelRange range = this->range(item);
        for (std::int64_t y = range.y_begin; y < range.y_end; ++y) {
            const std::int64_t first = y * width_ + range.x_begin;
            const std::int64_t end = y * width_ + range.x_end;
            if (pixels_ == nullptr) {
                visit(LinePixels{first, nullptr, end - first});
                continue;
            }
            const auto from = std::lower_bound(pixels_->begin(), pixels_->end(), first);
            const auto until = std::lower_bound(from, from + std::min(end - first, pixels_->end() - from), end);
            if (from != until) visit(LinePixels{first, &*from, until - from});
        }
    }

  private:
    [[nodiscard]] bool are_single_pixels() const { return item_width_ == 1 && item_height_ == 1; }
    [[nodiscard]] std::int64_t id_of(std::int64_t item) const {
        if (pixels_ == nullptr) return item;
        return are_single_pixels() ? (*pixels_)[static_cast<std::size_t>(item)]
                                   : items_[static_cast<std::size_t>(item)];
    }
    void find_items() {
        for (auto pixel = pixels_->begin(); pixel != pixels_->end();) {
            const std::int64_t x = *pixel % width_ / item_width_;
            const std::int64_t y = *pixel / width_;
            items_.push_back(y / item_height_ * columns_ + x);
            const std::int64_t end = y * width_ + std::min((x + 1) * item_width_, width_);
            pixel = std::lower_bound(pixel, pixel + std::min(end - *pixel, pixels_->end() - pixel), end);
        }
        std::sort(items_.begin(), items_.end());
        items_.erase(std::unique(items_.begin(), items_.end()), items_.end());
    }

    std::int64_t width_, height_, item_width_, item_height_, columns_, rows_;
    const std::vector<std::uint32_t>* pixels_;
    std::vector<std::int64_t> items_;  ///< that hold pixels of the list; not kept for single pixels
};

/// One thread's share of Progress, handed on in batches so that threads do not fight for a cache line.
class ProgressBatch {
  public:
    explicit ProgressBatch(Progress* progress) : progress_(progress) {}
    ProgressBatch(const ProgressBatch&) = delete;
    ProgressBatch& operator=(const ProgressBatch&) = delete;
    ~ProgressBatch() { flush(); }
    void add(std::int64_t paths) {
        batch_ += paths;
        if (batch_ >= kBatch) flush();
    }

  private:
    static constexpr std::int64_t kBatch = 4096;
    void flush() {
        if (progress_ != nullptr) progress_->paths.fetch_add(batch_, std::memory_order_relaxed);
        batch_ = 0;
    }
    Progress* progress_;
    std::int64_t batch_ = 0;
};

/// OpenMP as a render wants it: the schedule asked for, and as many threads as asked for. Puts back what there was.
class OpenMpState {
  public:
    explicit OpenMpState(const LoopSchedule& schedule) : dynamic_(omp_get_dynamic()) {
        omp_get_schedule(&kind_, &chunk_);
        constexpr omp_sched_t kKinds[] = {omp_sched_static, omp_sched_dynamic, omp_sched_guided,
                                          omp_sched_dynamic,   // tasks have none
                                          omp_sched_dynamic};  // balanced items go one by one
        omp_set_schedule(kKinds[static_cast<int>(schedule.kind)], schedule.chunk);
        omp_set_dynamic(0);
    }
    ~OpenMpState() {
        omp_set_schedule(kind_, chunk_);
        omp_set_dynamic(dynamic_);
    }
    OpenMpState(const OpenMpState&) = delete;
    OpenMpState& operator=(const OpenMpState&) = delete;

  private:
    omp_sched_t kind_{};
    int chunk_ = 0;
    int dynamic_;
};

/// Calls make(thread) in each of settings.threads threads, so that memory is first touched by the thread that will use
/// it. Returns how many threads OpenMP gave, which may be fewer. What make() throws in any of them, this throws.
template <class Make>
int make_by_threads(const RenderSettings& settings, Make make) {
    const OpenMpState state(settings.schedule);
    FirstException failure;
    int count = 1;
#pragma omp parallel num_threads(settings.threads)
    {
        const int thread = omp_get_thread_num();
        if (thread == 0) count = omp_get_num_threads();
        failure.run([&] { make(thread); });
    }
    failure.rethrow();
    return count;
}

/// What passed since `start_s` was setup, for all of the `threads`.
inline void count_setup(const RenderSettings& settings, double start_s, int threads, RenderReport& report) {
    const double end_s = wall_seconds();
    report.setup_s += end_s - start_s;
    report.seconds += end_s - start_s;
    if (settings.trace == nullptr) return;
    settings.trace->begin(start_s, threads);
    for (int i = 0; i < threads; ++i) settings.trace->lane(i).span("setup", start_s, end_s);
}

/// Runs body(ThreadReport&, SampleStatistics&) in settings.threads OpenMP threads under settings.schedule, denormals
/// flushed. Where OpenMP gives fewer threads, the report and the trace are of those. The body must end in a TeamLoop or
/// a worksharing loop with nowait; what a thread then waits for the others is measured here. What it throws, this
/// throws; a body with barriers must throw nothing, since the others would wait for ever.
template <class Body>
RenderReport run_threads(const RenderSettings& settings, Body body) {
    RenderReport report;
    report.threads.resize(static_cast<std::size_t>(settings.threads));
    std::vector<SampleStatistics> all_statistics(report.threads.size());
    std::vector<double> ends(report.threads.size());
    FirstException failure;
    int count = 1;

    const OpenMpState state(settings.schedule);
    const double start = wall_seconds();
    if (settings.trace != nullptr) settings.trace->begin(start, settings.threads);
#pragma omp parallel num_threads(settings.threads)
    {
        const FlushDenormals flush;
        const auto id = static_cast<std::size_t>(omp_get_thread_num());
        if (id == 0) count = omp_get_num_threads();
        ThreadReport work;
        const double begin = wall_seconds();
        const double processor_begin = processor_seconds();
        failure.run([&] { body(work, all_statistics[id]); });
        ends[id] = wall_seconds();
        work.busy_s = ends[id] - begin - work.wait_s;
        work.processor_s = processor_seconds() - processor_begin;
        report.threads[id] = work;
        if (settings.trace != nullptr) settings.trace->lane(static_cast<int>(id)).span("wait", start, begin);
    }
    const double end = wall_seconds();
    failure.rethrow();
    report.seconds = end - start;

    report.threads.resize(static_cast<std::size_t>(count));
    for (ThreadReport& thread : report.threads) thread.wait_s = std::max(0.0, report.seconds - thread.busy_s);
    for (const SampleStatistics& statistics : all_statistics) report.statistics.add(statistics);
    if (settings.trace != nullptr) {
        for (int i = 0; i < count; ++i) settings.trace->lane(i).span("wait", ends[static_cast<std::size_t>(i)], end);
        settings.trace->drop_idle_lanes();
    }
    return report;
}

}  // namespace raypool
