#include "cluster/work_units.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

namespace raypool::cluster {
namespace {

class WorkUnits : public testing::TestWithParam<std::tuple<std::int64_t, std::int64_t, int>> {};

TEST_P(WorkUnits, hold_every_sample_of_every_place_once) {
    const auto [samples, places, ranks] = GetParam();
    const SampleRange range{7, 7 + samples};
    SampleRange whole{7, 7};
    SampleRange samples_of_this_part{};
    std::int64_t next_place = 0;
    for (const WorkUnit& unit : work_units(range, places, ranks)) {
        ASSERT_GT(unit.paths(), 0);
        ASSERT_EQ(unit.first_place, next_place);
        ASSERT_EQ(unit.samples.first, whole.end);
        ASSERT_TRUE(unit.first_place == 0 || unit.samples == samples_of_this_part);
        samples_of_this_part = unit.samples;
        next_place = unit.end_place == places ? 0 : unit.end_place;
        if (next_place == 0) whole.end = unit.samples.end;
    }
    EXPECT_EQ(whole, range);
    EXPECT_EQ(next_place, 0);
}

TEST_P(WorkUnits, shrink_to_the_least_and_are_no_more_than_their_part_of_what_is_left) {
    const auto [samples, places, ranks] = GetParam();
    std::int64_t left = samples * places;
    for (const WorkUnit& unit : work_units({0, samples}, places, ranks)) {
        EXPECT_LE(unit.paths(), std::max(left / (kUnitsAShare * ranks), kLeastUnitPaths));
        left -= unit.paths();
    }
    EXPECT_EQ(left, 0);
}

INSTANTIATE_TEST_SUITE_P(sizes, WorkUnits,
                         testing::Values(std::tuple{100, 640 * 360, 2}, std::tuple{1, 640 * 360, 5},
                                         std::tuple{1000, 100, 3}, std::tuple{1, 1, 10000},
                                         std::tuple{17, kLeastUnitPaths, 64},
                                         std::tuple{9, kLeastUnitPaths + 1, 1000}));

}  // namespace
}  // namespace raypool::cluster
