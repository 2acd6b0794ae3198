/// The trace of a pool shows its rounds, in them the stages and the waiting, and how many records the pool holds.
#include "core/runtime/trace.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/small_render.h"
#include "tests/trace_spans.h"
#include "wavefront/engine.h"

namespace raypool::wavefront {
namespace {

using namespace test;

struct Traced {
    Trace trace;
    Rendered rendered;
};
Traced traced(const CompiledScene<float>& scene, RenderSettings settings, const PoolSettings& pool) {
    Trace trace;
    settings.trace = &trace;
    Rendered rendered = render(WavefrontEngine(pool), scene, settings);
    return {std::move(trace), std::move(rendered)};
}

TEST(PoolTrace, OfASharedPoolShowsRoundsStagesWaitingAndTheRecordsInThePool) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 24));
    RenderSettings settings;
    settings.end_sample = 3;
    settings.threads = 2;
    const std::string expected = render(recursive::IterativeEngine(), scene, settings).hash();
    for (const Append append : {Append::InPlace, Append::Atomic, Append::PrefixSum}) {
        PoolSettings pool{.scope = PoolScope::Shared,
                          .refill = Refill::Drain,
                          .camera = CameraStage::Staged,
                          .append = append,
                          .accumulator = Accumulator::AtomicInt64,
                          .capacity = 300,
                          .batch = 64};
        const auto [trace, rendered] = traced(scene, settings, pool);
        EXPECT_EQ(rendered.hash(), expected);
        expect_agreement(trace, rendered.report);

        const std::vector<RoundReport>& rounds = pool_report(rendered.report).rounds;
        std::vector<std::int64_t> records_in(rounds.size());
        std::int64_t generated = 0;
        std::int64_t accumulated = 0;
        for (const Trace::Lane& lane : trace.lanes()) {
            const Events spans = named(lane, "round");
            ASSERT_EQ(spans.size(), rounds.size());
            for (std::size_t i = 0; i < rounds.size(); ++i) {
                EXPECT_EQ(figure(spans[i], "round"), static_cast<std::int64_t>(i));
                records_in[i] += figure(spans[i], "records");
            }
            const std::size_t waits_in_a_round = append == Append::PrefixSum ? 4 : 3;
            EXPECT_EQ(named(lane, "wait").size(), 2 + waits_in_a_round * rounds.size());
            generated += sum(named(lane, "generate"), "records");
            accumulated += sum(named(lane, "accumulate"), "records");
            for (const char* stage : {"intersect", "shade", "append"})
                for (const Trace::Event& span : named(lane, stage)) EXPECT_GE(figure(span, "records"), 0);
            for (const Trace::Event& span : named(lane, "shade")) EXPECT_GE(figure(span, "batch"), 0);
        }
        for (std::size_t i = 0; i < rounds.size(); ++i) EXPECT_EQ(records_in[i], rounds[i].records_in);
        EXPECT_EQ(generated, rendered.report.paths());
        EXPECT_LE(accumulated, rendered.report.paths());
        EXPECT_GT(accumulated, 0);

        EXPECT_TRUE(named(trace.lanes()[1], "records in pool").empty()) << "one counter for one pool";
        const Events counter = named(trace.lanes()[0], "records in pool");
        ASSERT_EQ(counter.size(), rounds.size());
        for (std::size_t i = 0; i + 1 < rounds.size(); ++i)
            EXPECT_EQ(figure(counter[i], "records"), rounds[i + 1].records_in) << "the next round finds what was left";
        EXPECT_EQ(figure(counter.back(), "records"), 0);
    }
}

TEST(PoolTrace, OfAPoolForEachThreadShowsTheRoundsOfEach) {
    const CompiledScene<float> scene = compile<float>(small_scene("glass_stack", 24));
    for (const int split_depth : {0, 2}) {
        for (const CameraStage camera : {CameraStage::Staged, CameraStage::Fused, CameraStage::Beam}) {
            RenderSettings settings;
            settings.end_sample = 3;
            settings.threads = 3;
            settings.split_depth = split_depth;
            const std::string expected = render(recursive::IterativeEngine(), scene, settings).hash();
            const PoolSettings pool{.camera = camera, .sort = Sort::Material, .capacity = 100};
            const auto [trace, rendered] = traced(scene, settings, pool);
            EXPECT_EQ(rendered.hash(), expected);
            expect_agreement(trace, rendered.report);
            std::int64_t records = 0;
            for (const Trace::Lane& lane : trace.lanes()) {
                const Events rounds = named(lane, "round");
                records += sum(rounds, "records");
                for (const char* stage : {"intersect", "sort", "shade", "accumulate"})
                    EXPECT_EQ(named(lane, stage).size(), rounds.size()) << stage;
                const Events counter = named(lane, "records in pool");
                ASSERT_EQ(counter.size(), rounds.size());
                for (std::size_t i = 0; i < rounds.size(); ++i)
                    EXPECT_EQ(figure(counter[i], "records"), figure(rounds[i], "survivors"));
                EXPECT_LE(named(lane, "generate").size(), rounds.size() + 1) << "camera rays are not joined";
            }
            const std::int64_t in_registers = camera != CameraStage::Staged ? rendered.report.paths() : 0;
            EXPECT_EQ(records, rendered.report.segments() - in_registers);
        }
    }
}

TEST(PoolTrace, ShowsTheShadowRaysThatAreTracedWithinAStageInIt) {
    const CompiledScene<float> scene = compile<float>(small_scene("cornell", 24));
    for (const CameraStage camera : {CameraStage::Staged, CameraStage::Beam}) {
        RenderSettings settings;
        settings.end_sample = 3;
        settings.threads = 2;
        settings.light_sampling = LightSampling::Mis;
        const auto [trace, rendered] = traced(scene, settings, {.camera = camera, .capacity = 100});
        expect_agreement(trace, rendered.report);
        std::int64_t shadow_rays = 0;
        for (const Trace::Lane& lane : trace.lanes()) shadow_rays += sum(named(lane, "shadow"), "records");
        EXPECT_EQ(shadow_rays, rendered.report.total(&ThreadReport::shadow_rays));
    }
}

TEST(PoolTrace, OfARenderWithoutSegmentsIsEmpty) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 8));
    RenderSettings settings;
    settings.depth = 0;
    EXPECT_EQ(traced(scene, settings, {}).trace.event_count(), 0);
}

}  // namespace
}  // namespace raypool::wavefront
