/// A render in units: the sums of one render, whatever the units, the engine and the accumulator, with what is set up
/// once for all of them; and a report in which no second is missing.
#include <algorithm>
#include <numeric>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/runtime/trace.h"
#include "tests/small_render.h"
#include "tests/trace_spans.h"
#include "wavefront/engine.h"

namespace raypool::wavefront {
namespace {

constexpr Accumulator kExact[] = {Accumulator::OwnedInt64, Accumulator::AtomicInt64, Accumulator::PrivateInt64,
                                  Accumulator::OwnedPlanarInt64, Accumulator::AtomicPlanarInt64};

struct NamedEngine {
    std::string name;
    std::unique_ptr<Engine> engine;
};
std::vector<NamedEngine> engines() {
    std::vector<NamedEngine> all;
    all.push_back({"recursive", std::make_unique<recursive::RecursiveEngine>()});
    all.push_back({"iterative", std::make_unique<recursive::IterativeEngine>()});
    for (const PoolScope scope : {PoolScope::PerThread, PoolScope::Shared}) {
        for (const Accumulator accumulator : kExact) {
            if (scope == PoolScope::Shared && needs_owned_pixels(accumulator)) continue;
            const PoolSettings pool{.scope = scope, .accumulator = accumulator, .capacity = 100, .batch = 30};
            all.push_back(
                {fmt::format("scope {}, accumulator {}", static_cast<int>(scope), static_cast<int>(accumulator)),
                 std::make_unique<WavefrontEngine>(pool)});
        }
    }
    return all;
}

RenderSettings session_settings(std::int64_t spp, int threads) {
    RenderSettings settings;
    settings.end_sample = spp;
    settings.threads = threads;
    return settings;
}

Framebuffer empty_framebuffer(const CompiledScene<float>& scene, std::int64_t spp, Halves halves = Halves::Together) {
    return {scene.width, scene.height, FixedPoint::make(spp, scene.max_radiance), halves};
}

/// Every pixel whose number is `rest` modulo `step`.
std::vector<std::uint32_t> every(std::int64_t count, std::uint32_t step, std::uint32_t rest) {
    std::vector<std::uint32_t> pixels;
    for (std::uint32_t i = rest; i < count; i += step) pixels.push_back(i);
    return pixels;
}

TEST(Session, AddsUpToOneRenderWhateverItsUnitsAndHoweverOftenItIsMerged) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 37, 11));
    constexpr std::int64_t kSpp = 6;
    for (const Halves halves : {Halves::Together, Halves::Apart}) {
        Framebuffer expected = empty_framebuffer(scene, kSpp, halves);
        const RenderReport whole = recursive::IterativeEngine().render(scene, session_settings(kSpp, 1), expected);
        for (const NamedEngine& named : engines()) {
            for (const Grain& grain : {Grain{Grain::Kind::Pixel, 1}, {Grain::Kind::Line, 1}, {Grain::Kind::Tile, 5}}) {
                for (const int threads : {1, 3}) {
                    SCOPED_TRACE(
                        fmt::format("{}, grain {}, {} threads", named.name, static_cast<int>(grain.kind), threads));
                    RenderSettings settings = session_settings(1, threads);  // samples are the units' business
                    settings.grain = grain;
                    if (grain.kind != Grain::Kind::Line) settings.schedule = {LoopSchedule::Kind::Dynamic, 1};
                    Framebuffer framebuffer = empty_framebuffer(scene, kSpp, halves);
                    const auto session = named.engine->begin(scene, settings, framebuffer);
                    session->add({0, 2, nullptr});
                    session->merge();
                    session->merge();
                    for (std::uint32_t rest = 0; rest < 3; ++rest) {
                        const std::vector<std::uint32_t> pixels = every(scene.pixel_count(), 3, rest);
                        session->add({2, 5, &pixels});
                    }
                    const std::vector<std::uint32_t> none;
                    session->add({0, kSpp, &none});
                    session->add({5, 5, nullptr});
                    session->merge();
                    std::vector<std::uint32_t> head(20);
                    std::iota(head.begin(), head.end(), 0U);
                    std::vector<std::uint32_t> tail(static_cast<std::size_t>(scene.pixel_count()) - head.size());
                    std::iota(tail.begin(), tail.end(), 20U);
                    session->add({5, kSpp, &tail});
                    session->add({5, kSpp, &head});
                    session->merge();
                    EXPECT_EQ(framebuffer.hash(), expected.hash());
                    EXPECT_EQ(session->report().paths(), whole.paths());
                    EXPECT_EQ(session->report().segments(), whole.segments());
                    EXPECT_EQ(session->report().threads.size(), static_cast<std::size_t>(threads));
                }
            }
        }
    }
}

TEST(Session, HasEverySecondOfItsReportAsSetupOrAsWorkOrWaitingOfEachThread) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 48));
    for (const NamedEngine& named : engines()) {
        SCOPED_TRACE(named.name);
        Framebuffer framebuffer = empty_framebuffer(scene, 4);
        const auto session = named.engine->begin(scene, session_settings(4, 2), framebuffer);
        const RenderReport setup = session->report();
        EXPECT_EQ(setup.seconds, setup.setup_s);
        if (named.name != "iterative") {  // which has nothing to set up
            EXPECT_GT(setup.setup_s, 0);
        }
        const std::vector<std::uint32_t> some = every(scene.pixel_count(), 5, 2);
        double seconds = setup.seconds;
        seconds += session->add({0, 2, nullptr}).seconds;
        seconds += session->add({2, 4, &some}).seconds;
        seconds += session->merge().seconds;
        const RenderReport& report = session->report();
        EXPECT_NEAR(report.seconds, seconds, 1e-9);
        for (const ThreadReport& thread : report.threads)
            EXPECT_NEAR(thread.busy_s + thread.wait_s, report.seconds - report.setup_s, 1e-6);
    }
}

TEST(Session, TimesTheLastPassOfAccumulatorsThatHaveOne) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 48));
    for (const Accumulator accumulator :
         {Accumulator::OwnedInt64, Accumulator::AtomicInt64, Accumulator::PrivateInt64, Accumulator::OwnedPlanarInt64,
          Accumulator::AtomicPlanarInt64, Accumulator::AtomicFloat, Accumulator::AtomicDouble}) {
        Framebuffer framebuffer = empty_framebuffer(scene, 1);
        Trace trace;
        RenderSettings settings = session_settings(1, 2);
        settings.trace = &trace;
        const PoolSettings pool{.accumulator = accumulator};
        const auto session = WavefrontEngine(pool).begin(scene, settings, framebuffer);
        session->add({0, 1, nullptr});
        const RenderReport last = session->merge();
        const bool has_one = accumulator != Accumulator::OwnedInt64 && accumulator != Accumulator::AtomicInt64;
        EXPECT_EQ(last.seconds > 0, has_one);
        for (const Trace::Lane& lane : trace.lanes()) {
            EXPECT_EQ(test::named(lane, "setup").size(), 1U);
            EXPECT_EQ(test::named(lane, "merge").size(), has_one ? 1U : 0U);
        }
        test::expect_agreement(trace, session->report());
    }
}

TEST(Session, TakesTheMemoryOfOneRenderForAnyNumberOfUnits) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 16));
    for (const NamedEngine& named : engines()) {
        Framebuffer framebuffer = empty_framebuffer(scene, 20);
        const auto session = named.engine->begin(scene, session_settings(20, 2), framebuffer);
        const std::size_t before = session->report().memory_bytes;
        for (std::int64_t sample = 0; sample < 20; ++sample) session->add({sample, sample + 1, nullptr});
        session->merge();
        EXPECT_EQ(session->report().memory_bytes, before) << named.name;
    }
}

TEST(Session, LeavesCopiesOfItsReportAsTheyWere) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 8));
    Framebuffer framebuffer = empty_framebuffer(scene, 3);
    RenderSettings settings = session_settings(3, 1);
    settings.log_rounds = true;
    const auto session = WavefrontEngine({}).begin(scene, settings, framebuffer);
    for (std::int64_t sample = 0; sample < 3; ++sample) {
        const RenderReport before = session->report();
        const std::size_t rounds = pool_report(before).rounds.size();
        const RenderReport part = session->add({sample, sample + 1, nullptr});
        EXPECT_GT(pool_report(part).rounds.size(), 0U);
        EXPECT_EQ(pool_report(before).rounds.size(), rounds);
        EXPECT_EQ(pool_report(session->report()).rounds.size(), rounds + pool_report(part).rounds.size());
    }
}

TEST(PrefixSumAppend, TakesTheMemoryOfAPoolForEachThreadAndOneMore) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 8));
    const auto pool_bytes = [&](Append append, int threads) {
        const PoolSettings pool{
            .scope = PoolScope::Shared, .append = append, .accumulator = Accumulator::AtomicInt64, .capacity = 1 << 16};
        Framebuffer framebuffer = empty_framebuffer(scene, 1);
        return WavefrontEngine(pool).begin(scene, session_settings(1, threads), framebuffer)->report().memory_bytes;
    };
    const std::size_t one = pool_bytes(Append::Atomic, 3) - pool_bytes(Append::InPlace, 3);
    EXPECT_GE(one, (std::size_t{1} << 16) * 52);
    EXPECT_EQ(pool_bytes(Append::PrefixSum, 3), pool_bytes(Append::InPlace, 3) + 3 * one);
}

TEST(Threads, ThatOpenMpDoesNotGiveAreInNoReportAndNoTraceAndAllIsRenderedWithoutThem) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 24));
    Framebuffer expected = empty_framebuffer(scene, 2);
    recursive::IterativeEngine().render(scene, session_settings(2, 1), expected);
    for (const NamedEngine& named : engines()) {
        SCOPED_TRACE(named.name);
        Framebuffer framebuffer = empty_framebuffer(scene, 2);
        Trace trace;
        RenderSettings settings = session_settings(2, 3);
        settings.trace = &trace;
        RenderReport report;
#pragma omp parallel num_threads(2)
        {
#pragma omp master
            report = named.engine->render(scene, settings, framebuffer);  // a team within a team is of one thread
        }
        EXPECT_EQ(framebuffer.hash(), expected.hash());
        EXPECT_EQ(report.threads.size(), 1U);
        ASSERT_EQ(trace.lanes().size(), 1U);
        EXPECT_GT(report.threads[0].busy_s, 0);
        test::expect_agreement(trace, report);
    }
}

TEST(Memory, ThatIsNotThereIsRefusedBeforeAnythingIsTakenOrRendered) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 8));
    for (const PoolScope scope : {PoolScope::PerThread, PoolScope::Shared}) {
        PoolSettings pool{.scope = scope, .accumulator = Accumulator::AtomicInt64};
        pool.capacity = std::numeric_limits<std::int32_t>::max();
        Framebuffer framebuffer = empty_framebuffer(scene, 1);
        const std::string before = framebuffer.hash();
        Progress progress;
        RenderSettings settings = session_settings(1, 4000);
        settings.progress = &progress;
        try {
            WavefrontEngine(pool).render(scene, settings, framebuffer);
            FAIL() << "this machine has petabytes";
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("--pool-rays"), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find(" GB"), std::string::npos) << error.what();
        }
        EXPECT_EQ(framebuffer.hash(), before);
        EXPECT_EQ(progress.paths, 0);
    }
}

}  // namespace
}  // namespace raypool::wavefront
