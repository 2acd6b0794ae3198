/// What a render took: by thread, in all, and what an engine adds in a type of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/film/framebuffer.h"

namespace raypool {

/// What one thread did. A cache line each, so that counting does not make threads wait for each other.
struct alignas(64) ThreadReport {
    std::int64_t paths = 0;
    std::int64_t segments = 0;         ///< rays traced, camera rays included
    std::int64_t box_tests = 0;        ///< with count_work
    std::int64_t primitive_tests = 0;  ///< with count_work
    std::int64_t shadow_rays = 0;      ///< toward lights; no segments of paths
    double busy_s = 0;                 ///< working
    double processor_s = 0;            ///< on a processor meanwhile; what waits by spinning at barriers is on one too
    double wait_s = 0;                 ///< waiting for the others

    void add(const ThreadReport& later) {
        paths += later.paths;
        segments += later.segments;
        box_tests += later.box_tests;
        primitive_tests += later.primitive_tests;
        shadow_rays += later.shadow_rays;
        busy_s += later.busy_s;
        processor_s += later.processor_s;
        wait_s += later.wait_s;
    }
};

/// Adds figures to those of the same place, where there are none yet to nothing.
template <class T>
void add_each(std::vector<T>& sums, std::span<const T> later) {
    if (sums.size() < later.size()) sums.resize(later.size());
    for (std::size_t i = 0; i < later.size(); ++i) sums[i].add(later[i]);
}

/// What an engine adds to the report, in a type of its own library: of engines with a pool, wavefront/pool_report.h.
class EngineReport {
  public:
    EngineReport() = default;
    EngineReport& operator=(const EngineReport&) = delete;
    virtual ~EngineReport() = default;

    [[nodiscard]] virtual std::shared_ptr<EngineReport> copy() const = 0;
    /// Takes in a later unit of the same session.
    virtual void add(const EngineReport& later) = 0;

  protected:
    EngineReport(const EngineReport&) = default;
};

struct RenderReport {
    /// Wall clock of all that an engine does for a render: setup_s, the parallel loops, and what brings sums that were
    /// kept elsewhere into the framebuffer. Of these, threads are busy or wait in all but setup_s.
    double seconds = 0;
    double setup_s = 0;  ///< of checking the stack, and of making pools, the stages' memory and accumulators
    std::vector<ThreadReport> threads;
    SampleStatistics statistics;
    std::size_t memory_bytes = 0;  ///< pools, streams and accumulators at their largest; the framebuffer is not in it
    std::shared_ptr<EngineReport> engine;  ///< null where an engine adds nothing; copies share it until one is added to

    /// Takes in a later render into the same framebuffer.
    void add(const RenderReport& later);
    [[nodiscard]] std::int64_t paths() const { return total(&ThreadReport::paths); }
    [[nodiscard]] std::int64_t segments() const { return total(&ThreadReport::segments); }
    [[nodiscard]] std::int64_t total(std::int64_t ThreadReport::*figure) const {
        std::int64_t sum = 0;
        for (const ThreadReport& thread : threads) sum += thread.*figure;
        return sum;
    }
};

}  // namespace raypool
