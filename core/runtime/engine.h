/// What every engine is asked and what it answers: RenderSettings, RenderSession, RenderReport, Engine.
///
/// An engine owns the order of the work and nothing else; all physics is in core/. For one scene, precision, seed,
/// depth and sample range, every engine and every setting of the loop makes the same sums.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/film/framebuffer.h"
#include "core/runtime/settings.h"
#include "core/shading/compiled_scene.h"

namespace raypool {

/// The stages of a round of a wavefront engine. Append is the traffic of records from round to round: what survivors
/// and split records take to reach their places.
enum class Stage : std::uint8_t { Generate, Intersect, Sort, Shade, Accumulate, Append };
inline constexpr std::size_t kStageCount = 6;
inline constexpr std::array<const char*, kStageCount> kStageNames{"generate", "intersect",  "sort",
                                                                  "shade",    "accumulate", "append"};

/// One round of a wavefront engine: all threads, or, of per-thread pools, the rounds of that number added up.
struct RoundReport {
    std::int64_t records_in = 0;                ///< advanced by one bounce
    std::int64_t records_out = 0;               ///< of these, alive afterwards
    std::int64_t lanes = 0;                     ///< used for them: records_in / lanes is the occupancy of the registers
    std::array<double, kStageCount> stage_s{};  ///< added over threads
    double wait_s = 0;                          ///< at barriers, added over threads

    void add(const RoundReport& other) {
        records_in += other.records_in;
        records_out += other.records_out;
        lanes += other.lanes;
        for (std::size_t i = 0; i < kStageCount; ++i) stage_s[i] += other.stage_s[i];
        wait_s += other.wait_s;
    }
};

/// The lists of rays that a wavefront engine took to the nodes and leaves of one level of its trees.
struct ListLevel {
    std::int64_t lists = 0;
    std::int64_t rays = 0;         ///< in all of them; a ray is in as many as it entered nodes and leaves
    std::int64_t single_rays = 0;  ///< of these, in lists so short that their rays went on one by one, out of all lists
    std::int64_t lanes = 0;        ///< of registers, for the others: (rays - single_rays) / lanes is how full they were

    void add(const ListLevel& other) {
        lists += other.lists;
        rays += other.rays;
        single_rays += other.single_rays;
        lanes += other.lanes;
    }
};

/// What one thread did. A cache line each, so that counting does not make threads wait for each other.
struct alignas(64) ThreadReport {
    std::int64_t paths = 0;
    std::int64_t segments = 0;         ///< rays traced, camera rays included
    std::int64_t box_tests = 0;        ///< with count_work
    std::int64_t primitive_tests = 0;  ///< with count_work
    double busy_s = 0;                 ///< working
    double processor_s = 0;            ///< on a processor meanwhile; what waits by spinning at barriers is on one too
    double wait_s = 0;                 ///< waiting for the others

    void add(const ThreadReport& later) {
        paths += later.paths;
        segments += later.segments;
        box_tests += later.box_tests;
        primitive_tests += later.primitive_tests;
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

struct RenderReport {
    /// Wall clock of all that an engine does for a render: setup_s, the parallel loops, and what brings sums that were
    /// kept elsewhere into the framebuffer. Of these, threads are busy or wait in all but setup_s.
    double seconds = 0;
    double setup_s = 0;  ///< of checking the stack, and of making pools, the stages' memory and accumulators
    std::vector<ThreadReport> threads;
    SampleStatistics statistics;
    std::vector<RoundReport> rounds;  ///< of a wavefront engine, with log_rounds or a trace
    std::vector<ListLevel> lists;     ///< of a wavefront engine, with count_work: by level, the root first
    std::size_t record_bytes = 0;     ///< of a wavefront engine: moved in and out of the pool by a record
    std::size_t pool_rays = 0;        ///< of a wavefront engine: records that each pool has room for
    std::size_t pool_bytes = 0;       ///< of a wavefront engine: all pools, streams and accumulators at their largest

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

/// What is rendered at a time: samples [first_sample, end_sample) of some pixels, in rising order; of all where null.
struct RenderUnit {
    std::int64_t first_sample = 0;
    std::int64_t end_sample = 0;
    const std::vector<std::uint32_t>* pixels = nullptr;
};

/// A render in units: pieces between checkpoints, a rank's share, passes of an adaptive render. It holds what is set up
/// once for all of them: pools, the stages' memory, accumulators. What it was made of outlives it; for one thread.
class RenderSession {
  public:
    RenderSession() = default;
    RenderSession(const RenderSession&) = delete;
    RenderSession& operator=(const RenderSession&) = delete;
    virtual ~RenderSession() = default;

    /// Renders the unit. Its samples are in the framebuffer, or kept until merge(). Returns what this unit took.
    RenderReport add(const RenderUnit& unit) {
        RenderReport part = render(unit);
        report_.add(part);
        return part;
    }
    /// Brings all that was added into the framebuffer. More may be added afterwards. Returns what it took.
    RenderReport merge() {
        RenderReport part = collect();
        report_.add(part);
        return part;
    }
    /// Of the setup, and all that was added and merged.
    [[nodiscard]] const RenderReport& report() const { return report_; }
    /// Merges, and gives the report away: nothing may be added afterwards.
    RenderReport finish() {
        merge();
        return std::move(report_);
    }

  protected:
    virtual RenderReport render(const RenderUnit& unit) = 0;
    virtual RenderReport collect() { return {}; }

    RenderReport report_;
};

/// Renders the samples and pixels of `settings`, the only unit of its session.
RenderReport render_whole(RenderSession& session, const RenderSettings& settings);

/// Says that the build has no double precision (RAYPOOL_BUILD_DOUBLE): what engines do then in place of begin().
[[noreturn]] void refuse_double();

class Engine {
  public:
    Engine() = default;
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;
    virtual ~Engine() = default;

    [[nodiscard]] virtual std::string name() const = 0;
    /// Whether threads get parts of the image, as RenderSettings::schedule and grain say. Where not, the two do
    /// nothing.
    [[nodiscard]] virtual bool loops_over_image() const { return true; }

    /// Begins a render into the framebuffer, which has the scene's size. Of the settings, the samples and pixels are
    /// left to the units. Throws InputError for settings that this engine cannot carry out on this machine, and for
    /// pools and accumulators that do not fit into its memory; the framebuffer is then untouched.
    [[nodiscard]] virtual std::unique_ptr<RenderSession> begin(const CompiledScene<float>& scene,
                                                               const RenderSettings& settings,
                                                               Framebuffer& framebuffer) const = 0;
    [[nodiscard]] virtual std::unique_ptr<RenderSession> begin(const CompiledScene<double>& scene,
                                                               const RenderSettings& settings,
                                                               Framebuffer& framebuffer) const = 0;

    /// Adds the samples of the settings to the framebuffer.
    template <class Scalar>
    RenderReport render(const CompiledScene<Scalar>& scene, const RenderSettings& settings,
                        Framebuffer& framebuffer) const {
        return render_whole(*begin(scene, settings, framebuffer), settings);
    }
};

/// The paths that a render will follow.
template <class Scalar>
std::int64_t path_count(const SceneView<Scalar>& scene, const RenderUnit& unit) {
    const auto pixels = unit.pixels == nullptr ? scene.pixel_count() : static_cast<std::int64_t>(unit.pixels->size());
    return pixels * (unit.end_sample - unit.first_sample);
}
template <class Scalar>
std::int64_t path_count(const SceneView<Scalar>& scene, const RenderSettings& settings) {
    return path_count(scene, RenderUnit{settings.first_sample, settings.end_sample, settings.pixels});
}

/// What engines refuse alike, as an InputError.
void check_settings(const RenderSettings& settings, const Framebuffer& framebuffer);

/// Makes the calling thread treat denormal numbers as zero while it lives; engines hold one in every thread. A path
/// whose throughput fades would otherwise cost hundreds of times more for light that cannot be seen.
class FlushDenormals {
  public:
    FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | kFlushToZero | kDenormalsAreZero); }
    ~FlushDenormals() { _mm_setcsr(before_); }
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

  private:
    static constexpr unsigned kFlushToZero = 0x8000;
    static constexpr unsigned kDenormalsAreZero = 0x0040;
    unsigned before_;
};

}  // namespace raypool
