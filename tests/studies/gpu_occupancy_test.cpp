#include "bench/studies/gpu_occupancy.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "bench/studies/path_costs.h"
#include "bench/studies/renders.h"
#include "gpu/engine.h"
#include "gpu/host_device.h"

namespace raypool::studies {
namespace {

using gpu::Form;
using Counts = std::vector<std::pair<std::int64_t, std::int64_t>>;

Counts counts(Form form, const std::vector<std::uint32_t>& segments, std::int64_t room) {
    Counts out;
    for (const GpuRound& round : gpu_rounds(form, segments, room)) out.emplace_back(round.live, round.lanes);
    return out;
}

TEST(GpuRounds, AreThoseOfAFewPaths) {
    const std::vector<std::uint32_t> segments{3, 1, 1, 2};
    EXPECT_EQ(counts(Form::Mega, segments, 0), (Counts{{4, 32}, {2, 32}, {1, 32}}));
    EXPECT_EQ(counts(Form::MegaRegenerate, segments, 2), (Counts{{2, 32}, {2, 32}, {2, 32}, {1, 32}}));
    EXPECT_EQ(counts(Form::Wave, segments, 3), (Counts{{3, 32}, {2, 32}, {2, 32}}));
    EXPECT_EQ(counts(Form::Wave, segments, 1).size(), 7U);
    for (const Form form : {Form::Mega, Form::MegaRegenerate, Form::Wave}) EXPECT_TRUE(counts(form, {}, 1).empty());
}

/// The warp of the long path is the only one that goes on.
TEST(GpuRounds, OfAThreadAPathWaitForTheLongestOfAWarp) {
    std::vector<std::uint32_t> segments(64, 1);
    segments[40] = 5;
    EXPECT_EQ(counts(Form::Mega, segments, 0), (Counts{{64, 64}, {1, 32}, {1, 32}, {1, 32}, {1, 32}}));
}

TEST(GpuRounds, TraceEverySegmentInNoMoreLanesThanThereAre) {
    std::mt19937 random(3);
    std::vector<std::uint32_t> segments(10000);
    for (std::uint32_t& count : segments) count = 1 + random() % (1 + random() % 20);
    const std::int64_t all = std::accumulate(segments.begin(), segments.end(), std::int64_t{0});
    for (const Form form : {Form::Mega, Form::MegaRegenerate, Form::Wave}) {
        std::int64_t traced = 0;
        for (const GpuRound& round : gpu_rounds(form, segments, 256)) {
            traced += round.live;
            EXPECT_LE(round.live, round.lanes);
            EXPECT_TRUE(form == Form::Mega || round.lanes <= 256);
        }
        EXPECT_EQ(traced, all);
    }
}

/// The engine itself has as many rounds.
TEST(GpuRounds, OfAPoolAreThoseOfTheEngine) {
    const auto scene = study_scene("cornell", 24);
    RenderSettings settings;
    settings.end_sample = 2;
    const PathCosts costs = record_costs(*scene, settings);
    for (const std::int64_t capacity : {100, 1000, 1 << 20}) {
        const gpu::GpuEngine engine({Form::Wave, capacity}, [](int) { return gpu::host_device(1); });
        const RenderReport report = measure(engine, *scene, settings).report;
        EXPECT_EQ(static_cast<std::int64_t>(gpu_rounds(Form::Wave, costs.lengths_by_sample(), capacity).size()),
                  gpu::gpu_report(report).rounds);
    }
}

}  // namespace
}  // namespace raypool::studies
