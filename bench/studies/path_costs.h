/// What every segment of every path costs, recorded once, for studies that replay schedules.
///
/// A cost is counted: the boxes and the primitives that one ray is tested against (core/geometry/traverse.h), and with
/// it the shadow ray that starts where it ends, where lights are sampled. This is work of the per-pixel engines
/// exactly, and of the pools, whose streams and packets test otherwise, in proportion. A model turns tests into seconds
/// of the recursive engine.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/studies/renders.h"
#include "bench/studies/replay_model.h"

namespace raypool::studies {

/// Of one segment; more than 65535 tests are recorded as so many.
struct SegmentTests {
    std::uint16_t box = 0;
    std::uint16_t primitive = 0;
    std::uint16_t shadow_rays = 0;  ///< whose tests are among those above
};

/// Of any number of segments.
struct Tally {
    std::int64_t segments = 0;
    std::int64_t box_tests = 0;
    std::int64_t primitive_tests = 0;
    std::int64_t shadow_rays = 0;

    [[nodiscard]] std::int64_t tests() const { return box_tests + primitive_tests; }
    void add(const Tally& other) {
        segments += other.segments;
        box_tests += other.box_tests;
        primitive_tests += other.primitive_tests;
        shadow_rays += other.shadow_rays;
    }
};

/// Seconds of the recursive engine: of a segment (camera ray, shading, sky), of a test, and of a shadow ray beside its
/// tests.
struct CostModel {
    double segment_s = 0;
    double test_s = 1;
    double shadow_ray_s = 0;

    [[nodiscard]] double seconds(const Tally& tally) const {
        return segment_s * static_cast<double>(tally.segments) + test_s * static_cast<double>(tally.tests()) +
               shadow_ray_s * static_cast<double>(tally.shadow_rays);
    }
};
/// Counts tests, and nothing else: the work units of the tables on balance.
inline constexpr CostModel kTests{0, 1};
inline constexpr CostModel kSegments{1, 0};
inline constexpr CostModel kShadowRays{0, 0, 1};

/// Paths are numbered by pixel, row by row, and within a pixel by sample.
struct PathCosts {
    std::int64_t width = 0;
    std::int64_t height = 0;
    std::int64_t samples = 0;
    std::vector<std::uint32_t> first;  ///< segment of each path, and the end
    std::vector<SegmentTests> tests;

    /// Segments of each path, all pixels of a sample before the next sample: the order of a GPU's paths.
    [[nodiscard]] std::vector<std::uint32_t> lengths_by_sample() const;
    [[nodiscard]] Tally tally(std::int64_t first_path, std::int64_t end_path) const;
    /// Of the items that a grain cuts the image into.
    [[nodiscard]] std::vector<Tally> items(const Grain& grain) const;
    [[nodiscard]] std::vector<float> segment_costs(const CostModel& model) const;
};

/// Paths of the samples of the settings, by all threads of this machine. Throws InputError for more than 2^27 paths.
PathCosts record_costs(const StudyScene& scene, const RenderSettings& settings);

/// The same paths with every path's segments put in the order in which a loop over the grain takes them, and where each
/// item of the grain begins: what replay_thread_pools() needs.
struct ItemOrder {
    std::vector<std::uint32_t> first;  ///< segment of each path, and the end
    std::vector<float> cost;           ///< of each segment
    PoolItems items;

    [[nodiscard]] SegmentCosts segments() const { return {first, cost}; }
};
/// For pools of `capacity` paths.
ItemOrder in_order(const PathCosts& costs, const Grain& grain, const CostModel& model, std::size_t capacity);

/// How well the model tells the time of a line.
struct CostFit {
    CostModel model;
    double error = 0;    ///< standard deviation of lines around the model, over the mean line
    double seconds = 0;  ///< of the whole image by one thread
};
/// Times the recursive tracer line by line on one thread, in processor time, and fits the model to the fastest of the
/// `repeats` runs of each line: other work on the machine can only add to it.
CostFit fit_costs(const StudyScene& scene, const RenderSettings& settings, const PathCosts& costs, int repeats);

/// Processor time of each of `threads` threads that all trace the same lines, every second one of the image, at once: a
/// perfectly balanced run. Cores of one machine may differ in speed, those of a virtual one most of all.
std::vector<double> equal_work_seconds(const StudyScene& scene, const RenderSettings& settings, int threads);

/// The model in the same proportions, so that the whole image takes as long as the engine does on one thread: least
/// processor time of the repeats.
CostModel scaled_to(const Engine& engine, const StudyScene& scene, RenderSettings settings, const PathCosts& costs,
                    const CostModel& model, int repeats);

}  // namespace raypool::studies
