/// The cut of an image into work items, and the parallel region that runs them.
#include "core/loop.h"

#include <gtest/gtest.h>

namespace raypool::test {
namespace {

constexpr Grain kGrains[] = {{Grain::Kind::Pixel, 16}, {Grain::Kind::Line, 16}, {Grain::Kind::Tile, 1},
                             {Grain::Kind::Tile, 4},   {Grain::Kind::Tile, 16}, {Grain::Kind::Tile, 1000}};

TEST(WorkItems, HoldEveryPixelOnce) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 17}, {17, 1}, {13, 7}, {16, 16}, {33, 20}}) {
        for (const Grain& grain : kGrains) {
            std::vector<int> visits(static_cast<std::size_t>(width * height));
            const WorkItems items(width, height, grain);
            for (std::int64_t item = 0; item < items.count(); ++item) {
                const PixelRange range = items.range(item);
                EXPECT_LT(range.x_begin, range.x_end);
                EXPECT_LT(range.y_begin, range.y_end);
                for (std::int64_t y = range.y_begin; y < range.y_end; ++y)
                    for (std::int64_t x = range.x_begin; x < range.x_end; ++x)
                        ++visits.at(static_cast<std::size_t>(y * width + x));
            }
            EXPECT_EQ(visits, std::vector<int>(visits.size(), 1)) << width << ' ' << height << ' ' << grain.tile;
        }
    }
}

TEST(ChosenPixels, AreKnownInEveryOrderOfItems) {
    const std::vector<std::uint32_t> list{0, 3, 4, 5, 20, 21, 40, 90};
    for (const std::int64_t stride : {1, 7, 13, 89}) {  // prime to 91
        ChosenPixels chosen(&list);
        for (std::int64_t i = 0; i < 91; ++i) {
            const std::int64_t pixel = i * stride % 91;
            ASSERT_EQ(chosen.contains(pixel), std::count(list.begin(), list.end(), pixel) == 1) << pixel;
        }
    }
    EXPECT_TRUE(ChosenPixels(nullptr).contains(7));
    const std::vector<std::uint32_t> none;
    EXPECT_FALSE(ChosenPixels(&none).contains(0));
}

TEST(ChosenPixels, OfALineAreThoseBetweenItsEnds) {
    const std::vector<std::uint32_t> list{0, 3, 4, 5, 20, 21};
    const auto between = [&](std::int64_t begin, std::int64_t end) {
        const auto some = chosen_between(list, begin, end);
        return std::vector<std::uint32_t>(some.begin(), some.end());
    };
    EXPECT_EQ(between(3, 5), (std::vector<std::uint32_t>{3, 4}));
    EXPECT_EQ(between(0, 100), list);
    EXPECT_TRUE(between(6, 20).empty());
}

TEST(WorkItems, AreCountedIn64Bits) {
    constexpr std::int64_t kSize = 65536;
    const WorkItems pixels(kSize, kSize, {Grain::Kind::Pixel, 1});
    EXPECT_EQ(pixels.count(), std::int64_t{1} << 32U);
    const PixelRange last = pixels.range(pixels.count() - 1);
    EXPECT_EQ(last.x_end, kSize);
    EXPECT_EQ(last.y_begin, kSize - 1);
}

TEST(ProgressBatch, HandsOnEverythingByItsEnd) {
    Progress progress;
    {
        ProgressBatch batch(&progress);
        for (int i = 0; i < 1000; ++i) batch.add(10);
        EXPECT_GT(progress.paths, 0);
    }
    EXPECT_EQ(progress.paths, 10'000);
    ProgressBatch(nullptr).add(100'000);
}

bool flushes_denormals() {
    volatile float tiny = std::numeric_limits<float>::min();
    volatile float half = tiny / 2;
    return half == 0;
}

TEST(RunThreads, RunsTheBodyOncePerThreadWithDenormalsFlushed) {
    for (const int threads : {1, 2, 5}) {
        RenderSettings settings;
        settings.threads = threads;
        std::atomic<int> flushed = 0;
        const RenderReport report = run_threads(settings, [&](ThreadWork& work, SampleAudit& audit) {
            flushed += flushes_denormals() ? 1 : 0;
            work.paths = 1 + omp_get_thread_num();
            work.segments = 10;
            audit.clamped = 100;
        });
        EXPECT_EQ(flushed, threads);
        EXPECT_EQ(report.threads.size(), static_cast<std::size_t>(threads));
        EXPECT_EQ(report.paths(), threads * (threads + 1) / 2);
        EXPECT_EQ(report.segments(), 10 * threads);
        EXPECT_EQ(report.audit.clamped, 100 * threads);
        for (const ThreadWork& thread : report.threads) {
            EXPECT_GE(thread.busy_s, 0);
            EXPECT_GE(thread.wait_s, 0);
            EXPECT_LE(thread.busy_s, report.seconds);
        }
    }
    EXPECT_FALSE(flushes_denormals());
}

TEST(RunThreads, AppliesTheScheduleAndPutsBackTheOneBefore) {
    omp_set_schedule(omp_sched_guided, 7);
    RenderSettings settings;
    settings.schedule = {LoopSchedule::Kind::Dynamic, 3};
    omp_sched_t kind_within{};
    int chunk_within = 0;
    run_threads(settings, [&](ThreadWork&, SampleAudit&) { omp_get_schedule(&kind_within, &chunk_within); });
    EXPECT_EQ(kind_within & ~omp_sched_monotonic, omp_sched_dynamic);
    EXPECT_EQ(chunk_within, 3);
    omp_sched_t kind{};
    int chunk = 0;
    omp_get_schedule(&kind, &chunk);
    EXPECT_EQ(kind & ~omp_sched_monotonic, omp_sched_guided);
    EXPECT_EQ(chunk, 7);
}

}  // namespace
}  // namespace raypool::test
