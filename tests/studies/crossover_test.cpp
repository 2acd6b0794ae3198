// Where a pool begins to beat recursion, and what a spread decides.

#include "bench/studies/crossover.h"

#include <gtest/gtest.h>

#include "bench/studies/verdict.h"

namespace raypool::studies {
namespace {

TEST(Crossover, IsTheSmallestCapacityThatWinsInEveryRun) {
    const Crossover found = crossover({{64, {0.8, 0.7, 0.9}}, {256, {1.2, 0.9, 1.5}}, {1024, {1.3, 1.1, 1.4}}});
    EXPECT_EQ(found.from, 1024) << "at 256 one run lost";
    EXPECT_TRUE(found.lost_beyond.empty());
    EXPECT_EQ(to_text(found), "1024");
}

TEST(Crossover, IsNeverWhereNoCapacityWins) {
    EXPECT_EQ(to_text(crossover({{64, {0.8, 0.7, 0.9}}, {256, {1.0, 1.0, 1.0}}})), "never") << "a draw is no win";
    EXPECT_EQ(to_text(crossover({})), "never");
}

TEST(Crossover, NamesTheLargerCapacitiesThatLoseAgain) {
    const Crossover found =
        crossover({{64, {1.2, 1.1, 1.3}}, {256, {0.9, 0.8, 1.1}}, {1024, {2, 2, 2}}, {4096, {0.5, 0.4, 0.6}}});
    EXPECT_EQ(found.from, 64);
    EXPECT_EQ(found.lost_beyond, (std::vector<std::int64_t>{256, 4096}));
    EXPECT_EQ(to_text(found), "64, but not 256, 4096");
}

TEST(RatioVerdict, IsOpenWhereRunsAreFewOrOnBothSides) {
    EXPECT_EQ(is_at_least({4.2, 4.0, 4.4, 5}, 4), Verdict::Holds);
    EXPECT_EQ(is_at_least({3.8, 3.6, 3.9, 5}, 4), Verdict::DoesNotHold);
    EXPECT_EQ(is_at_least({4.1, 3.9, 4.2, 5}, 4), Verdict::CannotTell);
    EXPECT_EQ(is_at_least({4.2, 4.0, 4.4, 4}, 4), Verdict::CannotTell);
    EXPECT_EQ(why_open({4.1, 3.9, 4.2, 5}, 4), "the spread of the runs includes 4");
    EXPECT_EQ(why_open({4.2, 4.0, 4.4, 5}, 4), "");
}

}  // namespace
}  // namespace raypool::studies
