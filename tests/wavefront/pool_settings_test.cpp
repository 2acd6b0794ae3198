/// What single settings of a pool mean: by which schedule batches are handed out, and which accumulators go with which
/// scope.
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/wavefront/pool_renders.h"

namespace raypool::wavefront {
namespace {

TEST(SharedPool, HandsOutBatchesByItsOwnScheduleWhateverThatOfTheImage) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 24));
    RenderSettings settings = settings_of(4, 50, 2);
    PoolSettings pool = shared_pool(256);
    pool.batch = 64;
    pool.batch_schedule = {LoopSchedule::Kind::Static, 1};
    const auto segments_of_second_thread = [&](const LoopSchedule& schedule) {
        settings.schedule = schedule;
        return render_pool(scene, settings, pool).report.threads[1].segments;
    };
    for (const LoopSchedule schedule : {LoopSchedule{LoopSchedule::Kind::Static, 1}, {LoopSchedule::Kind::Static, 64}})
        EXPECT_GT(segments_of_second_thread(schedule), 0);

    pool.batch_schedule = {LoopSchedule::Kind::Static, 64};  // more than the batches that there are
    EXPECT_EQ(segments_of_second_thread({LoopSchedule::Kind::Static, 1}), 0);
}

TEST(LoopOverTheImage, IsHadByAllButASharedPool) {
    EXPECT_FALSE(WavefrontEngine(shared_pool()).loops_over_image());
    EXPECT_TRUE(WavefrontEngine(PoolSettings{}).loops_over_image());
    EXPECT_TRUE(recursive::RecursiveEngine().loops_over_image());
}

TEST(OwnedAccumulator, IsRefusedWithASharedPoolBeforeAnythingIsAdded) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 8));
    for (const Accumulator accumulator : {Accumulator::OwnedInt64, Accumulator::OwnedPlanarInt64}) {
        PoolSettings pool = shared_pool();
        pool.accumulator = accumulator;
        Framebuffer framebuffer(scene.width, scene.height, FixedPoint::make(1, scene.max_radiance));
        const std::string before = framebuffer.hash();
        try {
            WavefrontEngine(pool).render(scene, settings_of(1, 50), framebuffer);
            FAIL() << "rendered";
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("--accumulator"), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find("--pool-scope"), std::string::npos) << error.what();
        }
        EXPECT_EQ(framebuffer.hash(), before);
    }
}

TEST(RoundedAccumulators, MakeAnImageThatIsOnlyClose) {
    const CompiledScene<float> scene = compile<float>(small_scene("paper", 16));
    const Rendered expected = render_recursive(scene, settings_of(16, 50));
    for (const Accumulator accumulator : {Accumulator::AtomicFloat, Accumulator::AtomicDouble}) {
        PoolSettings pool = shared_pool(100);
        pool.accumulator = accumulator;
        const Rendered got = render_pool(scene, settings_of(16, 50, 2), pool);
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(got.mean(channel), expected.mean(channel), 1e-5 * expected.mean(channel));
        EXPECT_EQ(got.report.segments(), expected.report.segments());
    }
}

}  // namespace
}  // namespace raypool::wavefront
