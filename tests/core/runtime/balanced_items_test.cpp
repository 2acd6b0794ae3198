/// The balanced cut: every sample of every pixel in exactly one item, whatever the shape, and small items at the end.
#include "core/runtime/balanced_items.h"

#include <gtest/gtest.h>

#include <numeric>

#include <fmt/format.h>

namespace raypool::test {
namespace {

constexpr int kThreads[] = {1, 2, 3, 7, 64, 1000, 4096};

struct Shape {
    std::int64_t width, height, samples;
};
constexpr Shape kShapes[] = {{1, 1, 1},   {1, 1, 2},   {1, 1, 1000}, {3, 1, 777},  {1, 17, 40}, {17, 1, 3},
                             {13, 7, 64}, {64, 1, 33}, {40, 25, 5},  {128, 72, 1}, {31, 9, 100}};

TEST(BalancedItems, AreRangesThatFollowEachOtherFromTheFirstPathToTheLast) {
    for (const Shape& shape : kShapes) {
        for (const int threads : kThreads) {
            const BalancedItems items(shape.width * shape.height, shape.samples, threads);
            std::int64_t next = 0;
            for (std::int64_t item = 0; item < items.count(); ++item) {
                const PathRange range = items.range(item);
                ASSERT_EQ(range.begin, next);
                ASSERT_LT(range.begin, range.end);
                ASSERT_GT(items.most_held(item), 0);
                next = range.end;
            }
            EXPECT_EQ(next, shape.width * shape.height * shape.samples);
        }
    }
}

TEST(BalancedItems, HoldEverySampleOfEveryPixelOnceByLines) {
    for (const Shape& shape : kShapes) {
        const std::int64_t pixel_count = shape.width * shape.height;
        std::vector<std::uint32_t> list;
        for (std::uint32_t pixel = 0; pixel < pixel_count; pixel += 1 + pixel % 3) list.push_back(pixel);
        for (const std::vector<std::uint32_t>* pixels : {static_cast<std::vector<std::uint32_t>*>(nullptr), &list}) {
            for (const int threads : kThreads) {
                const RenderUnit unit{10, 10 + shape.samples, pixels};
                const BalancedItems items(shape.width, shape.height, unit, threads);
                std::vector<int> visits(static_cast<std::size_t>(pixel_count * shape.samples));
                for (std::int64_t item = 0; item < items.count(); ++item) {
                    items.for_each_line(item, shape.width, pixels,
                                        [&](const LinePixels& line, std::int64_t first, std::int64_t end) {
                                            EXPECT_EQ(line[0] / shape.width, line[line.count - 1] / shape.width);
                                            EXPECT_TRUE(0 <= first && first < end && end <= shape.samples);
                                            for (std::int64_t i = 0; i < line.count; ++i)
                                                for (std::int64_t s = first; s < end; ++s)
                                                    ++visits.at(static_cast<std::size_t>(line[i] * shape.samples + s));
                                        });
                }
                std::vector<int> expected(visits.size(), pixels == nullptr ? 1 : 0);
                if (pixels != nullptr)
                    for (const std::uint32_t pixel : list)
                        std::fill_n(expected.begin() + pixel * shape.samples, shape.samples, 1);
                ASSERT_EQ(visits, expected)
                    << fmt::format("{} x {} x {}, {} threads", shape.width, shape.height, shape.samples, threads);
            }
        }
    }
}

TEST(BalancedItems, HaveWholePixelsWhereTheySayThatPixelsAreNotSplit) {
    for (const Shape& shape : kShapes) {
        for (const int threads : kThreads) {
            const BalancedItems items(shape.width * shape.height, shape.samples, threads);
            if (items.splits_pixels()) continue;
            for (std::int64_t item = 0; item < items.count(); ++item) {
                EXPECT_EQ(items.range(item).begin % shape.samples, 0);
                EXPECT_EQ(items.range(item).end % shape.samples, 0);
            }
        }
    }
    EXPECT_FALSE(BalancedItems(90'000, 100, 2).splits_pixels());
    EXPECT_FALSE(BalancedItems(4096, 1'000'000, 2).splits_pixels());
    EXPECT_FALSE(BalancedItems(1, 1'000'000, 1).splits_pixels());
    EXPECT_TRUE(BalancedItems(1, 1'000'000, 2).splits_pixels());
    EXPECT_TRUE(BalancedItems(90'000, 100, 4096).splits_pixels());
}

TEST(BalancedItems, ShrinkAndTheLastOfEachThreadIsASmallPartOfItsShare) {
    for (const auto& [pixels, samples] : {std::pair{90'000, 100}, {1, 1'000'000}, {4096, 1000}, {90'000, 16}}) {
        for (const int threads : {2, 3, 64, 1024, 4096}) {
            const BalancedItems items(pixels, samples, threads);
            const double share = static_cast<double>(pixels) * samples / threads;
            const auto size = [&](std::int64_t item) { return items.range(item).end - items.range(item).begin; };
            EXPECT_LE(static_cast<double>(size(0)), std::max(64.0, share / 4));
            for (std::int64_t item = 1; item < items.count(); ++item) {
                ASSERT_LE(size(item), size(item - 1));
                ASSERT_LE(items.most_held(item), items.most_held(item - 1));
            }
            const std::int64_t last = std::max<std::int64_t>(items.count() - threads, 0);
            EXPECT_LE(static_cast<double>(size(last)), std::max(64.0, 0.02 * share))
                << fmt::format("{} pixels, {} samples, {} threads", pixels, samples, threads);
        }
    }
}

TEST(BalancedItems, AreFewHoweverManyPathsThereAre) {
    constexpr std::int64_t kPixels = std::int64_t{65536} * 65536;
    const BalancedItems items(kPixels, 1 << 30, 64);
    EXPECT_LT(items.count(), 64 * 8 * 64);
    EXPECT_EQ(items.range(items.count() - 1).end, kPixels * (1 << 30));
}

TEST(BalancedItems, OfNothingAreNone) {
    const std::vector<std::uint32_t> none;
    EXPECT_EQ(BalancedItems(10, 10, {0, 5, &none}, 2).count(), 0);
    EXPECT_EQ(BalancedItems(10, 10, {5, 5, nullptr}, 2).count(), 0);
}

}  // namespace
}  // namespace raypool::test
