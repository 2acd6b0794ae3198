/// What the engines that render pixel by pixel record: a span for each work item, and what each pixel cost. Recording
/// changes no bit of the image.
#include "recursive/item_log.h"

#include <numeric>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/runtime/balanced_items.h"
#include "tests/small_render.h"
#include "tests/trace_spans.h"
#include "wavefront/engine.h"

namespace raypool::recursive {
namespace {

const RecursiveEngine kRecursive;
const IterativeEngine kIterative;
const Engine* const kEngines[] = {&kRecursive, &kIterative};
constexpr Grain kGrains[] = {{Grain::Kind::Pixel, 1}, {Grain::Kind::Line, 1}, {Grain::Kind::Tile, 5}};
constexpr const char* kSpans[] = {"pixels", "line", "tile"};
constexpr LoopSchedule kSchedules[] = {{LoopSchedule::Kind::Static, 0}, {LoopSchedule::Kind::Dynamic, 1}};

TEST(ItemTrace, HasASpanForEachItemAndAllPixelsInThem) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 23, 13));
    RenderSettings settings;
    const std::string expected = render(kIterative, scene, settings).hash();
    for (const Engine* engine : kEngines) {
        for (const Grain& grain : kGrains) {
            for (const LoopSchedule& schedule : kSchedules) {
                SCOPED_TRACE(fmt::format("{}, grain {}", engine->name(), kSpans[static_cast<int>(grain.kind)]));
                Trace trace;
                settings.trace = &trace;
                settings.threads = 3;
                settings.grain = grain;
                settings.schedule = schedule;
                const Rendered got = render(*engine, scene, settings);
                EXPECT_EQ(got.hash(), expected);
                test::expect_agreement(trace, got.report);
                std::int64_t pixels = 0;
                std::int64_t spans = 0;
                for (const Trace::Lane& lane : trace.lanes()) {
                    const test::Events items = test::named(lane, kSpans[static_cast<int>(grain.kind)]);
                    spans += std::ssize(items);
                    pixels += test::sum(items, "pixels");
                    for (std::size_t i = 1; i < items.size() && grain.kind == Grain::Kind::Pixel; ++i)
                        EXPECT_NE(test::figure(items[i], "y"), test::figure(items[i - 1], "y"));
                }
                EXPECT_EQ(pixels, scene.pixel_count());
                if (grain.kind == Grain::Kind::Pixel) {
                    EXPECT_GE(spans, scene.height);
                    EXPECT_LE(spans, settings.threads * scene.height);
                } else {
                    EXPECT_EQ(spans, WorkItems(scene.width, scene.height, grain).count());
                }
            }
        }
    }
}

TEST(ItemTrace, HasASpanForEachBalancedItem) {
    for (const auto& [width, spp] : {std::pair{23, 3}, {1, 500}}) {
        const CompiledScene<float> scene = compile<float>(small_scene("paper", width, 5));
        Trace trace;
        RenderSettings settings;
        settings.end_sample = spp;
        settings.threads = 3;
        const std::string expected = render(kIterative, scene, settings).hash();
        settings.trace = &trace;
        const Rendered got = render(kRecursive, scene, settings);
        EXPECT_EQ(got.hash(), expected);
        test::expect_agreement(trace, got.report);
        std::int64_t spans = 0;
        for (const Trace::Lane& lane : trace.lanes()) spans += std::ssize(test::named(lane, "item"));
        EXPECT_EQ(spans, BalancedItems(scene.pixel_count(), spp, 3).count());
    }
}

TEST(PixelCosts, AddUpToTheReportOfTheRenderWhateverTheLoop) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 23, 13));
    for (const int split_depth : {0, 2}) {
        for (const Cost cost : {Cost::Segments, Cost::Tests}) {
            std::vector<std::int64_t> first;
            for (const Engine* engine : kEngines) {
                for (const LoopSchedule& schedule : {LoopSchedule{}, {LoopSchedule::Kind::Tasks, 0}, kSchedules[1]}) {
                    for (const int threads : {1, 3}) {
                        CostImage image(cost, scene.width, scene.height);
                        RenderSettings settings;
                        settings.end_sample = 2;
                        settings.split_depth = split_depth;
                        settings.schedule = schedule;
                        settings.grain = {Grain::Kind::Tile, 5};
                        settings.threads = threads;
                        const std::string expected = render(kIterative, scene, settings).hash();
                        settings.cost_image = &image;
                        const Rendered got = render(*engine, scene, settings);
                        EXPECT_EQ(got.hash(), expected);
                        const std::int64_t total = cost == Cost::Segments
                                                       ? got.report.segments()
                                                       : got.report.total(&ThreadReport::box_tests) +
                                                             got.report.total(&ThreadReport::primitive_tests);
                        EXPECT_GT(total, 0);
                        EXPECT_EQ(std::accumulate(image.values.begin(), image.values.end(), std::int64_t{0}), total);
                        if (first.empty()) first = image.values;
                        EXPECT_EQ(image.values, first) << "a pixel's cost depends on the loop";
                    }
                }
            }
            EXPECT_GT(std::set<std::int64_t>(first.begin(), first.end()).size(), 5U) << "all pixels cost the same";
        }
    }
}

TEST(PixelCosts, InNanosecondsArePartOfTheThreadsBusyTime) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 16));
    CostImage image(Cost::Nanoseconds, scene.width, scene.height);
    RenderSettings settings;
    settings.cost_image = &image;
    const RenderReport report = render(kRecursive, scene, settings).report;
    for (const std::int64_t value : image.values) EXPECT_GT(value, 0);
    const std::int64_t all = std::accumulate(image.values.begin(), image.values.end(), std::int64_t{0});
    EXPECT_LE(static_cast<double>(all) * 1e-9, report.threads[0].busy_s);
}

TEST(PixelCosts, AreRefusedByAPoolWhichNamesTheEnginesThatKnowThem) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 8));
    CostImage image(Cost::Segments, scene.width, scene.height);
    RenderSettings settings;
    settings.cost_image = &image;
    Framebuffer framebuffer(scene.width, scene.height, FixedPoint::make(1, scene.max_radiance));
    try {
        wavefront::WavefrontEngine(wavefront::PoolSettings{}).render(scene, settings, framebuffer);
        FAIL() << "rendered";
    } catch (const InputError& error) {
        for (const char* part : {"--cost-image", "recursive", "iterative"})
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace raypool::recursive
