/// The parallel loop that engines share: how an image is cut into work items, and how threads are run and timed.
#pragma once

#include <omp.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <span>
#include <vector>

#include "core/engine.h"
#include "core/error.h"
#include "core/trace.h"

namespace raypool {

/// Pixels [x_begin, x_end) of lines [y_begin, y_end).
struct PixelRange {
    std::int64_t x_begin, x_end, y_begin, y_end;
};

/// RenderSettings::pixels, asked in the order of a loop over the image: each thread has one and walks it along.
class ChosenPixels {
  public:
    explicit ChosenPixels(const std::vector<std::uint32_t>* pixels) : pixels_(pixels) {}
    bool contains(std::int64_t pixel) {
        if (pixels_ == nullptr) return true;
        const std::vector<std::uint32_t>& list = *pixels_;
        const auto id = static_cast<std::uint32_t>(pixel);
        const bool is_astray = (next_ < list.size() && list[next_] < id) || (next_ > 0 && list[next_ - 1] >= id);
        if (is_astray) next_ = static_cast<std::size_t>(std::lower_bound(list.begin(), list.end(), id) - list.begin());
        const bool is_chosen = next_ < list.size() && list[next_] == id;
        if (is_chosen) ++next_;
        return is_chosen;
    }

  private:
    const std::vector<std::uint32_t>* pixels_;
    std::size_t next_ = 0;  ///< what is before it is less than the pixel asked for last, or is that
};

/// Those of a rising list of pixels that lie in [begin, end).
inline std::span<const std::uint32_t> chosen_between(const std::vector<std::uint32_t>& pixels, std::int64_t begin,
                                                     std::int64_t end) {
    const auto first = std::lower_bound(pixels.begin(), pixels.end(), begin);
    return {first, std::lower_bound(first, pixels.end(), end)};
}

/// The image cut into pixels, lines or tiles, numbered along lines from the top left.
class WorkItems {
  public:
    WorkItems(std::int64_t width, std::int64_t height, const Grain& grain) : width_(width), height_(height) {
        item_width_ = grain.kind == Grain::Kind::Line ? width : grain.kind == Grain::Kind::Tile ? grain.tile : 1;
        item_height_ = grain.kind == Grain::Kind::Tile ? grain.tile : 1;
        columns_ = (width + item_width_ - 1) / item_width_;
        rows_ = (height + item_height_ - 1) / item_height_;
    }
    [[nodiscard]] std::int64_t count() const { return columns_ * rows_; }
    [[nodiscard]] PixelRange range(std::int64_t item) const {
        const std::int64_t x = item % columns_ * item_width_;
        const std::int64_t y = item / columns_ * item_height_;
        return {x, std::min(x + item_width_, width_), y, std::min(y + item_height_, height_)};
    }

  private:
    std::int64_t width_, height_, item_width_, item_height_, columns_, rows_;
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

/// Processor time of the calling thread, in seconds: what other processes take meanwhile does not count.
inline double processor_seconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Runs body(ThreadWork&, SampleAudit&) in settings.threads OpenMP threads under settings.schedule, denormals flushed.
/// The body must end in a worksharing loop with nowait; what a thread then waits for the others is measured here.
template <class Body>
RenderReport run_threads(const RenderSettings& settings, Body body) {
    RenderReport report;
    report.threads.resize(static_cast<std::size_t>(settings.threads));
    std::vector<SampleAudit> audits(report.threads.size());

    omp_sched_t kind_before;
    int chunk_before;
    omp_get_schedule(&kind_before, &chunk_before);
    constexpr omp_sched_t kKinds[] = {omp_sched_static, omp_sched_dynamic, omp_sched_guided};
    omp_set_schedule(kKinds[static_cast<int>(settings.schedule.kind)], settings.schedule.chunk);
    omp_set_dynamic(0);

    std::vector<double> ends(report.threads.size());
    const double start = omp_get_wtime();
    if (settings.trace != nullptr) settings.trace->begin(start, settings.threads);
#pragma omp parallel num_threads(settings.threads)
    {
        const FlushDenormals flush;
        const auto id = static_cast<std::size_t>(omp_get_thread_num());
        ThreadWork work;
        const double begin = omp_get_wtime();
        const double processor_begin = processor_seconds();
        body(work, audits[id]);
        ends[id] = omp_get_wtime();
        work.busy_s = ends[id] - begin - work.wait_s;
        work.processor_s = processor_seconds() - processor_begin;
        report.threads[id] = work;
        if (settings.trace != nullptr) settings.trace->lane(static_cast<int>(id)).span("wait", start, begin);
    }
    const double end = omp_get_wtime();
    report.seconds = end - start;

    omp_set_schedule(kind_before, chunk_before);
    for (ThreadWork& thread : report.threads) thread.wait_s = std::max(0.0, report.seconds - thread.busy_s);
    for (const SampleAudit& audit : audits) report.audit.add(audit);
    if (settings.trace != nullptr)
        for (int i = 0; i < settings.threads; ++i)
            settings.trace->lane(i).span("wait", ends[static_cast<std::size_t>(i)], end);
    return report;
}

}  // namespace raypool
