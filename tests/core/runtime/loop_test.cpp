/// The cut of an image into work items, and the parallel region that runs them.
#include "core/runtime/loop.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

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

TEST(WorkItems, OfAListHoldItsPixelsOnceAndAreNoMoreThanNeeded) {
    for (const auto& size : {std::pair{1, 1}, {1, 17}, {17, 1}, {13, 7}, {16, 16}, {33, 20}}) {
        const std::int64_t width = size.first;  // lambdas take no bindings by reference
        const std::int64_t height = size.second;
        for (const std::uint32_t step : {1U, 2U, 5U, 40U, 1000U}) {
            std::vector<std::uint32_t> list;
            for (auto pixel = step / 2; pixel < static_cast<std::uint32_t>(width * height); pixel += step)
                list.push_back(pixel);
            for (const Grain& grain : kGrains) {
                const WorkItems items(width, height, grain, &list);
                std::vector<std::uint32_t> found;
                for (std::int64_t item = 0; item < items.count(); ++item) {
                    const PixelRange range = items.range(item);
                    std::int64_t in_item = 0;
                    items.for_each_line(item, [&](const LinePixels& line) {
                        for (std::int64_t i = 0; i < line.count; ++i) {
                            const std::int64_t x = line[i] % width;
                            const std::int64_t y = line[i] / width;
                            EXPECT_EQ(y, line[0] / width);
                            EXPECT_TRUE(x >= range.x_begin && x < range.x_end && y >= range.y_begin && y < range.y_end);
                            found.push_back(static_cast<std::uint32_t>(line[i]));
                        }
                        in_item += line.count;
                    });
                    EXPECT_GT(in_item, 0) << "an item without a pixel";
                }
                std::sort(found.begin(), found.end());
                ASSERT_EQ(found, list) << width << ' ' << height << ' ' << step << ' ' << grain.tile;
            }
        }
    }
}

TEST(WorkItems, WithoutAListHaveWholeLines) {
    const WorkItems items(13, 7, {Grain::Kind::Tile, 4});
    std::int64_t pixels = 0;
    for (std::int64_t item = 0; item < items.count(); ++item)
        items.for_each_line(item, [&](const LinePixels& line) { pixels += line.count; });
    EXPECT_EQ(pixels, 13 * 7);
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
        const RenderReport report = run_threads(settings, [&](ThreadReport& work, SampleStatistics& statistics) {
            flushed += flushes_denormals() ? 1 : 0;
            work.paths = 1 + omp_get_thread_num();
            work.segments = 10;
            statistics.clamped = 100;
        });
        EXPECT_EQ(flushed, threads);
        EXPECT_EQ(report.threads.size(), static_cast<std::size_t>(threads));
        EXPECT_EQ(report.paths(), threads * (threads + 1) / 2);
        EXPECT_EQ(report.segments(), 10 * threads);
        EXPECT_EQ(report.statistics.clamped, 100 * threads);
        for (const ThreadReport& thread : report.threads) {
            EXPECT_GE(thread.busy_s, 0);
            EXPECT_GE(thread.wait_s, 0);
            EXPECT_LE(thread.busy_s, report.seconds);
        }
    }
    EXPECT_FALSE(flushes_denormals());
}

TEST(RunThreads, AppliesTheScheduleAndPutsBackWhatOpenMpHadBefore) {
    for (const int dynamic : {0, 1}) {
        omp_set_dynamic(dynamic);
        omp_set_schedule(omp_sched_guided, 7);
        RenderSettings settings;
        settings.schedule = {LoopSchedule::Kind::Dynamic, 3};
        omp_sched_t kind_within{};
        int chunk_within = 0;
        run_threads(settings, [&](ThreadReport&, SampleStatistics&) { omp_get_schedule(&kind_within, &chunk_within); });
        EXPECT_EQ(kind_within & ~omp_sched_monotonic, omp_sched_dynamic);
        EXPECT_EQ(chunk_within, 3);
        EXPECT_THROW(run_threads(settings, [](ThreadReport&, SampleStatistics&) { throw InputError("no"); }),
                     InputError);
        make_by_threads(settings, [](int) {});
        omp_sched_t kind{};
        int chunk = 0;
        omp_get_schedule(&kind, &chunk);
        EXPECT_EQ(kind & ~omp_sched_monotonic, omp_sched_guided);
        EXPECT_EQ(chunk, 7);
        EXPECT_EQ(omp_get_dynamic(), dynamic);
    }
    omp_set_dynamic(0);
}

TEST(RunThreads, ThrowsWhatAnyOfItsThreadsThrew) {
    for (const int guilty : {0, 1, 2}) {
        RenderSettings settings;
        settings.threads = 3;
        const auto fail = [&] {
            if (omp_get_thread_num() == guilty) throw InputError("no");
        };
        EXPECT_THROW(run_threads(settings, [&](ThreadReport&, SampleStatistics&) { fail(); }), InputError);
        EXPECT_THROW(make_by_threads(settings, [&](int) { fail(); }), InputError);
    }
}

TEST(RunThreads, ReportsNoThreadThatOpenMpDidNotGive) {
    RenderSettings settings;
    settings.threads = 3;
    Trace trace;
    settings.trace = &trace;
    RenderReport report;
    int made = 0;
#pragma omp parallel num_threads(2)
    {
#pragma omp master
        {
            report = run_threads(settings, [](ThreadReport&, SampleStatistics&) {});
            made = make_by_threads(settings, [](int) {});
        }
    }
    EXPECT_EQ(report.threads.size(), 1U);
    EXPECT_EQ(trace.lanes().size(), 1U);
    EXPECT_EQ(made, 1);
}

}  // namespace
}  // namespace raypool::test
