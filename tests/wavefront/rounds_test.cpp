/// What a render by the pool reports: the work of recursion, to the segment, and rounds whose figures add up.
#include <gtest/gtest.h>

#include "tests/wavefront/pool_renders.h"

namespace raypool::wavefront {
namespace {

class Report : public testing::TestWithParam<const char*> {};

TEST_P(Report, CountsTheSegmentsOfRecursionAndItsRoundsAddUpToThem) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam(), 24));
    const Rendered expected = render_recursive(scene, settings_of(2, 50));
    for (const Variant& variant : variants()) {
        for (const int threads : {1, 3}) {
            SCOPED_TRACE(fmt::format("{}, {} threads", variant.name, threads));
            const Rendered got = render_pool(scene, settings_of(2, 50, threads), variant.pool);
            const RenderReport& report = got.report;
            EXPECT_EQ(got.hash(), expected.hash());
            EXPECT_EQ(report.segments(), expected.report.segments());
            EXPECT_EQ(report.paths(), 2 * scene.pixel_count());

            const std::int64_t in_registers = variant.pool.camera != CameraStage::Staged ? report.paths() : 0;
            EXPECT_EQ(sum(report, &RoundReport::records_in), report.segments() - in_registers);
            EXPECT_LE(sum(report, &RoundReport::records_out), sum(report, &RoundReport::records_in));
            for (const RoundReport& round : pool_report(report).rounds) {
                EXPECT_LE(round.records_out, round.records_in);
                EXPECT_GE(round.lanes, round.records_in);
                if (variant.pool.width == StageWidth::Scalar) {
                    EXPECT_EQ(round.lanes, round.records_in);
                }
                EXPECT_GE(round.wait_s, 0);
                if (variant.pool.scope == PoolScope::Shared) {
                    EXPECT_LE(round.records_in, variant.pool.capacity);
                } else {
                    EXPECT_LE(round.records_in, threads * variant.pool.capacity);
                    EXPECT_EQ(round.wait_s, 0);
                }
            }
        }
    }
}

TEST_P(Report, CountsTheTestsOfRecursionWhereRaysAreTracedOneByOne) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam(), 24));
    const Rendered expected = render_recursive(scene, settings_of(1, 50));
    const Rendered got = render_pool(scene, settings_of(1, 50, 2), shared_pool(300));
    for (const auto figure : {&ThreadReport::box_tests, &ThreadReport::primitive_tests})
        EXPECT_EQ(got.report.total(figure), expected.report.total(figure));
    const Rendered in_streams = render_pool(scene, settings_of(1, 50), PoolSettings{});
    EXPECT_GE(in_streams.report.total(&ThreadReport::primitive_tests), in_streams.report.segments() / 2);
}

TEST(Report, CountsTheShadowRaysOfRecursionAndInEachPoolAsManyThatMeetSomething) {
    const CompiledScene<float> scene = compile<float>(small_scene("cornell", 24));
    const auto with_lights = [](int threads) {
        RenderSettings settings = settings_of(2, 50, threads);
        settings.light_sampling = LightSampling::Mis;
        return settings;
    };
    const Rendered expected = render_recursive(scene, with_lights(1));
    std::int64_t hits = -1;
    for (const Variant& variant : variants()) {
        for (const int threads : {1, 3}) {
            SCOPED_TRACE(fmt::format("{}, {} threads", variant.name, threads));
            const Rendered got = render_pool(scene, with_lights(threads), variant.pool);
            const RenderReport& report = got.report;
            EXPECT_EQ(got.hash(), expected.hash());
            EXPECT_EQ(report.total(&ThreadReport::shadow_rays), expected.report.total(&ThreadReport::shadow_rays));
            EXPECT_EQ(sum(report, &RoundReport::shadow_rays), report.total(&ThreadReport::shadow_rays));
            if (hits < 0) hits = sum(report, &RoundReport::shadow_hits);
            EXPECT_EQ(sum(report, &RoundReport::shadow_hits), hits);
            double shadow_s = 0;
            double stages_s = 0;
            for (const RoundReport& round : pool_report(report).rounds) {
                EXPECT_LE(round.shadow_hits, round.shadow_rays);
                EXPECT_GE(round.shadow_lanes, round.shadow_rays);
                EXPECT_LE(round.shadow_lanes, 16 * round.shadow_rays);
                EXPECT_EQ(round.shadow_rays > 0, round.stage_s[static_cast<std::size_t>(Stage::Shadow)] > 0);
                for (const double seconds : round.stage_s) {
                    EXPECT_GE(seconds, 0) << "the shadow rays that are traced within a stage are none of its";
                    stages_s += seconds;
                }
                shadow_s += round.stage_s[static_cast<std::size_t>(Stage::Shadow)];
            }
            double busy_s = 0;
            for (const ThreadReport& thread : report.threads) busy_s += thread.busy_s;
            EXPECT_GT(shadow_s, 0);
            EXPECT_LE(stages_s, busy_s);
        }
    }
    EXPECT_GT(hits, 0);
    EXPECT_LT(hits, expected.report.total(&ThreadReport::shadow_rays));
}

TEST_P(Report, CountsTheListsOfEachLevel) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam(), 24));
    PoolSettings pool;
    pool.capacity = 300;
    for (const int split_depth : {0, 2}) {
        RenderSettings settings = settings_of(2, 50, 2);
        settings.split_depth = split_depth;
        const RenderReport report = render_pool(scene, settings, pool).report;
        const std::vector<ListLevel>& lists = pool_report(report).lists;
        ASSERT_FALSE(lists.empty());
        // Camera rays go down in beams; any other ray begins at the root of each tree.
        const std::int64_t trees = (scene.sphere_tree.nodes.empty() ? 0 : 1) + (scene.quad_tree.nodes.empty() ? 0 : 1);
        EXPECT_EQ(lists[0].rays, trees * (report.segments() - report.paths()));
        std::int64_t entered = 0;
        for (std::size_t level = 0; level < lists.size(); ++level) {
            const ListLevel& at = lists[level];
            const std::int64_t together = at.rays - at.single_rays;
            EXPECT_GE(at.single_rays, 0);
            EXPECT_GE(together, 0);
            EXPECT_GE(at.lanes, together);
            EXPECT_LT(at.lanes, together + 16 * std::max<std::int64_t>(at.lists, 1));
            EXPECT_LE(at.lists, at.rays);
            if (level == 0) continue;
            entered += at.rays;
            EXPECT_LE(at.rays, 8 * (lists[level - 1].rays - lists[level - 1].single_rays));
        }
        EXPECT_GT(entered, 0);
        EXPECT_LE(entered, report.total(&ThreadReport::box_tests));
    }
    const Rendered singly = render_pool(scene, settings_of(1, 50), shared_pool(300));
    for (const ListLevel& level : pool_report(singly.report).lists)
        EXPECT_EQ(level.lists, 0) << "of rays that are traced one by one";
}

TEST_P(Report, ShowsTheRoundsOfAPoolThatTakesAllPathsAtOnceAsTheBouncesOfAllPaths) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam(), 24));
    const Rendered got = render_pool(scene, settings_of(2, 50, 2), shared_pool(2 * scene.pixel_count()));
    const std::vector<RoundReport>& rounds = pool_report(got.report).rounds;
    ASSERT_GE(rounds.size(), 2U);
    ASSERT_LE(rounds.size(), 51U);
    EXPECT_EQ(rounds[0].records_in, 0) << "the first round only takes in camera paths";
    EXPECT_EQ(rounds[1].records_in, 2 * scene.pixel_count());
    for (std::size_t i = 2; i < rounds.size(); ++i) EXPECT_EQ(rounds[i].records_in, rounds[i - 1].records_out);
    EXPECT_EQ(rounds.back().records_out, 0);
    EXPECT_GT(rounds.back().records_in, 0) << "a round that advanced nothing";
}

TEST_P(Report, IsOfOneSegmentAPathAtDepthOneAndOfNoneAtDepthZero) {
    const CompiledScene<float> scene = compile<float>(small_scene(GetParam(), 24));
    for (const std::int32_t depth : {0, 1}) {
        const Rendered expected = render_recursive(scene, settings_of(2, depth));
        for (const Variant& variant : variants()) {
            const Rendered got = render_pool(scene, settings_of(2, depth, 2), variant.pool);
            EXPECT_EQ(got.hash(), expected.hash()) << variant.name;
            EXPECT_EQ(got.report.paths(), 2 * scene.pixel_count());
            EXPECT_EQ(got.report.segments(), depth * 2 * scene.pixel_count());
            EXPECT_EQ(sum(got.report, &RoundReport::records_out), 0);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Report, testing::Values("paper", "cornell", "mirror_corridor"),
                         [](const auto& test) { return std::string(test.param); });

TEST(RoundsReport, IsEmptyUnlessRoundsAreLogged) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 16));
    RenderSettings settings = settings_of(1, 50);
    settings.log_rounds = false;
    EXPECT_TRUE(pool_report(render_pool(scene, settings, shared_pool()).report).rounds.empty());
    settings.count_work = false;
    const Rendered got = render_pool(scene, settings, shared_pool());
    EXPECT_TRUE(pool_report(got.report).rounds.empty());
    const Features& code = kCompiledFeatures[compiled_features_index(scene.features, kFirstCompiledFeatures<float>)];
    EXPECT_EQ(pool_report(got.report).record_bytes, ray_record_bytes(code, sizeof(float)));
    EXPECT_EQ(got.report.segments(), render_recursive(scene, settings).report.segments());
}

TEST(RoundsReport, NeedsNoCountingOfWork) {
    const CompiledScene<float> scene = compile<float>(small_scene("cornell", 16));
    RenderSettings settings = settings_of(2, 50, 2);
    settings.count_work = false;
    for (const Variant& variant : variants()) {
        SCOPED_TRACE(variant.name);
        const RenderReport got = render_pool(scene, settings, variant.pool).report;
        const std::int64_t in_registers = variant.pool.camera != CameraStage::Staged ? got.paths() : 0;
        EXPECT_EQ(sum(got, &RoundReport::records_in), got.segments() - in_registers);
        EXPECT_EQ(got.total(&ThreadReport::box_tests) + got.total(&ThreadReport::primitive_tests), 0);
    }
}

TEST(RoundsReport, HasTimeInTheStagesThatRanAndInNoOther) {
    const CompiledScene<float> scene = compile<float>(small_scene("glass_stack", 24));
    for (const int split_depth : {0, 2}) {
        for (const Variant& variant : variants()) {
            SCOPED_TRACE(fmt::format("{}, split depth {}", variant.name, split_depth));
            RenderSettings settings = settings_of(4, 50, 2);
            settings.split_depth = split_depth;
            const RenderReport report = render_pool(scene, settings, variant.pool).report;
            const auto seconds = [&](Stage stage) {
                double all = 0;
                for (const RoundReport& round : pool_report(report).rounds)
                    all += round.stage_s[static_cast<std::size_t>(stage)];
                return all;
            };
            for (const Stage stage : {Stage::Generate, Stage::Intersect, Stage::Shade, Stage::Accumulate})
                EXPECT_GT(seconds(stage), 0) << kStageNames[static_cast<std::size_t>(stage)];
            EXPECT_EQ(seconds(Stage::Sort) > 0, variant.pool.sort == Sort::Material);
            EXPECT_EQ(seconds(Stage::Append) > 0, variant.pool.scope == PoolScope::Shared || split_depth > 0);
            double all = 0;
            for (std::size_t i = 0; i < kStageCount; ++i) all += seconds(static_cast<Stage>(i));
            for (const RoundReport& round : pool_report(report).rounds) all += round.wait_s;
            EXPECT_LE(all, settings.threads * report.seconds) << "some time was counted twice";
        }
    }
}

TEST(Progress, ReachesTheNumberOfPathsAtAnyDepthAndInAnyPool) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 24));
    for (const Variant& variant : variants()) {
        for (const std::int32_t depth : {0, 1, 20}) {
            Progress progress;
            RenderSettings settings = settings_of(3, depth, 2);
            settings.progress = &progress;
            render_pool(scene, settings, variant.pool);
            EXPECT_EQ(progress.paths, 3 * scene.pixel_count()) << variant.name << ", depth " << depth;
        }
    }
}

TEST(EmptyRangeOfSamples, AddsNothing) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 8));
    RenderSettings settings = settings_of(4, 50, 2);
    settings.first_sample = 4;
    for (const Variant& variant : variants()) {
        const Rendered got = render_pool(scene, settings, variant.pool);
        EXPECT_EQ(got.report.paths(), 0);
        EXPECT_EQ(got.hash(), render_recursive(scene, settings).hash());
    }
}

}  // namespace
}  // namespace raypool::wavefront
