#include "bench/studies/path_costs.h"

#include <gtest/gtest.h>

#include <numeric>

#include "core/base/error.h"

namespace raypool::studies {
namespace {

RenderSettings three_samples() {
    RenderSettings settings;
    settings.first_sample = 1;
    settings.end_sample = 4;
    settings.depth = 20;
    return settings;
}

TEST(PathCosts, AddUpToWhatTheEngineCounts) {
    const auto scene = study_scene("paper", 48);
    RenderSettings settings = three_samples();
    const PathCosts costs = record_costs(*scene, settings);
    settings.count_work = true;
    const RenderReport report = measure(*recursive_engine().engine, *scene, settings).report;

    EXPECT_EQ(static_cast<std::int64_t>(costs.first.size()), report.paths() + 1);
    const Tally all = costs.tally(0, report.paths());
    EXPECT_EQ(all.segments, report.segments());
    EXPECT_EQ(all.box_tests, report.total(&ThreadReport::box_tests));
    EXPECT_EQ(all.primitive_tests, report.total(&ThreadReport::primitive_tests));
}

TEST(PathCosts, HaveTheShadowRaysWhereLightsAreSampled) {
    const auto scene = study_scene("small_lamp", 32);
    RenderSettings settings = three_samples();
    settings.light_sampling = LightSampling::Mis;
    const PathCosts costs = record_costs(*scene, settings);
    settings.count_work = true;
    const RenderReport report = measure(*recursive_engine().engine, *scene, settings).report;

    const Tally all = costs.tally(0, report.paths());
    EXPECT_GT(all.shadow_rays, 0);
    EXPECT_EQ(all.shadow_rays, report.total(&ThreadReport::shadow_rays));
    EXPECT_EQ(all.tests(), report.total(&ThreadReport::box_tests) + report.total(&ThreadReport::primitive_tests));
    EXPECT_EQ(kShadowRays.seconds(all), static_cast<double>(all.shadow_rays));
}

TEST(PathCosts, OfTheItemsOfAnyGrainAreAllThereIs) {
    const PathCosts costs = record_costs(*study_scene("paper", 37), three_samples());
    for (const Grain& grain :
         {Grain{Grain::Kind::Line, 0}, Grain{Grain::Kind::Pixel, 0}, Grain{Grain::Kind::Tile, 8}}) {
        Tally sum;
        for (const Tally& item : costs.items(grain)) sum.add(item);
        EXPECT_EQ(sum.segments, static_cast<std::int64_t>(costs.tests.size()));
        EXPECT_EQ(sum.tests(), costs.tally(0, static_cast<std::int64_t>(costs.first.size()) - 1).tests());
    }
}

TEST(PathCosts, InTheOrderOfTilesAreThoseOfTheSamePixels) {
    const PathCosts costs = record_costs(*study_scene("paper", 37), three_samples());
    const Grain grain{Grain::Kind::Tile, 8};
    const ItemOrder order = in_order(costs, grain, kTests, 100);
    const std::vector<Tally> items = costs.items(grain);
    ASSERT_EQ(order.items.first_path.size(), items.size() + 1);
    EXPECT_EQ(order.items.first_path.back() + 1, order.first.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        const auto begin = order.cost.begin() + order.first[order.items.first_path[i]];
        const auto end = order.cost.begin() + order.first[order.items.first_path[i + 1]];
        EXPECT_EQ(std::accumulate(begin, end, 0.0), static_cast<double>(items[i].tests()));
    }
}

TEST(PathCosts, RefuseMorePathsThanMemoryShouldHold) {
    RenderSettings settings;
    settings.end_sample = std::numeric_limits<std::int32_t>::max();
    EXPECT_THROW(record_costs(*study_scene("one_sphere", 8), settings), InputError);
}

}  // namespace
}  // namespace raypool::studies
