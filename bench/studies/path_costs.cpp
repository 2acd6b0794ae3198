// Compiled with -fno-optimize-sibling-calls: the tracer that is timed here is the recursive engine's.
#include "bench/studies/path_costs.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/first_exception.h"
#include "core/runtime/loop.h"
#include "recursive/tracer.h"

namespace raypool::studies {

namespace {

constexpr std::int64_t kMostPaths = std::int64_t{1} << 27;

/// Counts tests and shadow rays, and remembers what had been counted when each segment began.
struct SegmentLog : TestCount {
    std::vector<Tally> begins;
    std::int64_t shadow_rays = 0;
    void begin_segment() { begins.push_back({0, box_tests, primitive_tests, shadow_rays}); }
    void begin_shadow_ray() { ++shadow_rays; }
};

std::uint16_t clipped(std::int64_t count) {
    return static_cast<std::uint16_t>(std::min<std::int64_t>(count, std::numeric_limits<std::uint16_t>::max()));
}

/// The paths of one line.
struct LineLog {
    std::vector<std::uint32_t> path_segments;
    std::vector<SegmentTests> tests;
};

LineLog record_line(const CompiledScene<float>& scene, const RenderSettings& settings, std::int64_t y) {
    recursive::Tracer<kEverything, float, SegmentLog, Splitting::Off> tracer(
        scene, settings, fixed_point(scene, settings, settings.end_sample));
    LineLog line;
    for (std::int64_t x = 0; x < scene.width; ++x) {
        for (std::int64_t s = settings.first_sample; s < settings.end_sample; ++s) {
            const std::int64_t before = tracer.segments();
            tracer.template sample<recursive::Form::Iterative>(x, y, s);
            line.path_segments.push_back(static_cast<std::uint32_t>(tracer.segments() - before));
        }
    }
    SegmentLog log = tracer.work();
    log.begin_segment();  // the end of the last one
    for (std::size_t i = 0; i + 1 < log.begins.size(); ++i)
        line.tests.push_back({clipped(log.begins[i + 1].box_tests - log.begins[i].box_tests),
                              clipped(log.begins[i + 1].primitive_tests - log.begins[i].primitive_tests),
                              clipped(log.begins[i + 1].shadow_rays - log.begins[i].shadow_rays)});
    return line;
}

/// Processor time of every `step`th line, by plain rules, as the engine runs them.
template <Features features>
std::vector<double> time_lines(const CompiledScene<float>& scene, const RenderSettings& settings, std::int64_t step) {
    const FlushDenormals flush;
    recursive::Tracer<features, float, NoTestCount, Splitting::Off, recursive::Rules::Plain> tracer(
        scene, settings, fixed_point(scene, settings, settings.end_sample));
    std::vector<double> seconds;
    for (std::int64_t y = 0; y < scene.height; y += step) {
        const double start = processor_seconds();
        for (std::int64_t x = 0; x < scene.width; ++x)
            for (std::int64_t s = settings.first_sample; s < settings.end_sample; ++s)
                tracer.template sample<recursive::Form::Recursive>(x, y, s);
        seconds.push_back(processor_seconds() - start);
    }
    return seconds;
}
std::vector<double> time_lines(const StudyScene& scene, const RenderSettings& settings, std::int64_t step) {
    return dispatch_features(scene.compiled.features,
                             [&]<Features features>() { return time_lines<features>(scene.compiled, settings, step); });
}

/// Calls visit(item, first path, end) for each line of each item that the grain cuts the image into.
template <class Visit>
void for_each_line(const PathCosts& costs, const Grain& grain, Visit visit) {
    const WorkItems work(costs.width, costs.height, grain);
    for (std::int64_t i = 0; i < work.count(); ++i) {
        const PixelRange range = work.range(i);
        for (std::int64_t y = range.y_begin; y < range.y_end; ++y)
            visit(static_cast<std::size_t>(i),
                  static_cast<std::size_t>((y * costs.width + range.x_begin) * costs.samples),
                  static_cast<std::size_t>((y * costs.width + range.x_end) * costs.samples));
    }
}

/// Least squares through the origin in two variables. Where lines are too few or too noisy for two, in one.
CostModel fit(const std::vector<Tally>& lines, const std::vector<double>& seconds) {
    double ss = 0;
    double st = 0;
    double tt = 0;
    double sy = 0;
    double ty = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const auto s = static_cast<double>(lines[i].segments);
        const auto t = static_cast<double>(lines[i].tests());
        ss += s * s, st += s * t, tt += t * t, sy += s * seconds[i], ty += t * seconds[i];
    }
    const double determinant = ss * tt - st * st;
    const CostModel both{(sy * tt - ty * st) / determinant, (ty * ss - sy * st) / determinant};
    if (determinant > 0 && both.segment_s >= 0 && both.test_s >= 0) return both;
    return tt > 0 ? CostModel{0, ty / tt} : CostModel{sy / std::max(ss, 1.0), 0};
}

}  // namespace

std::vector<std::uint32_t> PathCosts::lengths_by_sample() const {
    const auto count = static_cast<std::size_t>(samples);
    std::vector<std::uint32_t> lengths;
    lengths.reserve(first.size() - 1);
    for (std::size_t sample = 0; sample < count; ++sample)
        for (std::size_t path = sample; path + 1 < first.size(); path += count)
            lengths.push_back(first[path + 1] - first[path]);
    return lengths;
}

Tally PathCosts::tally(std::int64_t first_path, std::int64_t end_path) const {
    const std::uint32_t begin = first[static_cast<std::size_t>(first_path)];
    const std::uint32_t end = first[static_cast<std::size_t>(end_path)];
    Tally tally{.segments = end - begin};
    for (std::uint32_t s = begin; s < end; ++s) {
        tally.box_tests += tests[s].box;
        tally.primitive_tests += tests[s].primitive;
        tally.shadow_rays += tests[s].shadow_rays;
    }
    return tally;
}

std::vector<Tally> PathCosts::items(const Grain& grain) const {
    std::vector<Tally> items;
    for_each_line(*this, grain, [&](std::size_t item, std::size_t begin, std::size_t end) {
        items.resize(item + 1);
        items[item].add(tally(static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end)));
    });
    return items;
}

std::vector<float> PathCosts::segment_costs(const CostModel& model) const {
    std::vector<float> costs;
    costs.reserve(tests.size());
    for (const SegmentTests& t : tests)
        costs.push_back(static_cast<float>(model.seconds({1, t.box, t.primitive, t.shadow_rays})));
    return costs;
}

PathCosts record_costs(const StudyScene& scene, const RenderSettings& settings) {
    const CompiledScene<float>& compiled = scene.compiled;
    PathCosts costs{compiled.width, compiled.height, settings.end_sample - settings.first_sample, {0}, {}};
    if (costs.samples > kMostPaths / (costs.width * costs.height))
        throw InputError(fmt::format("--spp: the costs of {} x {} x {} paths do not fit; at most {} paths", costs.width,
                                     costs.height, costs.samples, kMostPaths));
    std::vector<LineLog> lines(static_cast<std::size_t>(compiled.height));
    FirstException failure;  // what is recorded may take more memory than there is
#pragma omp parallel for schedule(dynamic) num_threads(core_count())
    for (std::int64_t y = 0; y < compiled.height; ++y) {
        failure.run([&] {
            const FlushDenormals flush;
            lines[static_cast<std::size_t>(y)] = record_line(compiled, settings, y);
        });
    }
    failure.rethrow();
    for (LineLog& line : lines) {
        for (const std::uint32_t count : line.path_segments) costs.first.push_back(costs.first.back() + count);
        costs.tests.insert(costs.tests.end(), line.tests.begin(), line.tests.end());
        line = {};
    }
    RAYPOOL_CHECK(costs.first.back() == costs.tests.size(), "every segment was logged once");
    return costs;
}

ItemOrder in_order(const PathCosts& costs, const Grain& grain, const CostModel& model, std::size_t capacity) {
    const std::vector<float> segment_costs = costs.segment_costs(model);
    ItemOrder order{{0}, {}, {{0}, {}}};
    order.cost.reserve(segment_costs.size());
    for_each_line(costs, grain, [&](std::size_t item, std::size_t begin, std::size_t end) {
        for (std::size_t path = begin; path < end; ++path)
            order.first.push_back(order.first.back() + costs.first[path + 1] - costs.first[path]);
        order.cost.insert(order.cost.end(), segment_costs.begin() + costs.first[begin],
                          segment_costs.begin() + costs.first[end]);
        order.items.first_path.resize(item + 2);
        order.items.first_path.back() = static_cast<std::uint32_t>(order.first.size() - 1);
        order.items.most_held.resize(item + 1, capacity);
    });
    return order;
}

CostFit fit_costs(const StudyScene& scene, const RenderSettings& settings, const PathCosts& costs, int repeats) {
    std::vector<double> seconds(static_cast<std::size_t>(scene.compiled.height), std::numeric_limits<double>::max());
    for (int i = 0; i < repeats; ++i) {
        const std::vector<double> run = time_lines(scene, settings, 1);
        for (std::size_t y = 0; y < run.size(); ++y) seconds[y] = std::min(seconds[y], run[y]);
    }

    const std::vector<Tally> lines = costs.items({Grain::Kind::Line, 0});
    CostFit result{fit(lines, seconds), 0, std::accumulate(seconds.begin(), seconds.end(), 0.0)};
    double squares = 0;
    for (std::size_t y = 0; y < lines.size(); ++y) {
        const double miss = seconds[y] - result.model.seconds(lines[y]);
        squares += miss * miss;
    }
    const auto count = static_cast<double>(lines.size());
    if (result.seconds > 0) result.error = std::sqrt(squares / count) / (result.seconds / count);
    return result;
}

std::vector<double> equal_work_seconds(const StudyScene& scene, const RenderSettings& settings, int threads) {
    std::vector<double> seconds(static_cast<std::size_t>(threads));
    FirstException failure;
    int count = 1;
#pragma omp parallel num_threads(threads)
    {
        const int thread = omp_get_thread_num();
        if (thread == 0) count = omp_get_num_threads();
        failure.run([&] {
            const std::vector<double> lines = time_lines(scene, settings, 2);
            seconds[static_cast<std::size_t>(thread)] = std::accumulate(lines.begin(), lines.end(), 0.0);
        });
    }
    failure.rethrow();
    check_threads(count, threads);
    return seconds;
}

CostModel scaled_to(const Engine& engine, const StudyScene& scene, RenderSettings settings, const PathCosts& costs,
                    const CostModel& model, int repeats) {
    settings.threads = 1;
    double least = std::numeric_limits<double>::max();
    for (int i = 0; i < repeats; ++i)
        least = std::min(least, measure(engine, scene, settings).report.threads[0].processor_s);
    const double factor = least / model.seconds(costs.tally(0, static_cast<std::int64_t>(costs.first.size()) - 1));
    return {factor * model.segment_s, factor * model.test_s};
}

}  // namespace raypool::studies
