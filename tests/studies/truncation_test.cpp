// What a limit of depth cuts off: the figures of study `depth`, against cases worked out by hand and by chance.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "bench/studies/truncation.h"
#include "tests/small_render.h"

namespace raypool::studies {
namespace {

constexpr double kScale = 1024;

/// Sums of `half_spp` samples of these radiances.
std::vector<std::int64_t> sums(const std::vector<double>& radiance, std::int64_t half_spp) {
    std::vector<std::int64_t> out;
    for (const double value : radiance) out.push_back(std::llround(value * kScale * static_cast<double>(half_spp)));
    return out;
}

TEST(TruncationLoss, IsTheLightMissing) {
    const Halves deep{sums({1, 0.5, 0}, 4), sums({1, 0.5, 0}, 4)};
    const Halves cut{sums({0.75, 0.5, 0}, 4), sums({0.75, 0.5, 0}, 4)};
    const Loss loss = truncation_loss(deep, cut, kScale, 4);
    EXPECT_DOUBLE_EQ(loss.relative, 0.25 / 1.5);
    EXPECT_DOUBLE_EQ(loss.paired_rmse, std::sqrt(0.0625 / 3));
    EXPECT_DOUBLE_EQ(loss.rmse, loss.paired_rmse);
}

TEST(TruncationLoss, IsNothingAgainstItselfAndInTheDark) {
    const Halves image{sums({1, 2}, 1), sums({3, 4}, 1)};
    const Loss none = truncation_loss(image, image, kScale, 1);
    EXPECT_EQ(none.relative, 0);
    EXPECT_EQ(none.rmse, 0);
    const Halves black{sums({0, 0}, 1), sums({0, 0}, 1)};
    EXPECT_EQ(truncation_loss(black, black, kScale, 1).relative, 0);
}

/// A path in a hundred loses 100 times as much: what two images differ by is mostly chance, what is expected is not.
TEST(TruncationLoss, OfTheExpectedImagesIsFreeOfTheNoiseOfRarePaths) {
    std::mt19937 random(1);
    std::bernoulli_distribution is_lost(0.01);
    Halves deep;
    for (std::vector<std::int64_t>* half : {&deep.first, &deep.second}) {
        half->resize(200'000);
        for (std::int64_t& sum : *half) sum = is_lost(random) ? std::llround(100 * kScale) : 0;
    }
    const Halves cut{std::vector<std::int64_t>(200'000), std::vector<std::int64_t>(200'000)};
    const Loss loss = truncation_loss(deep, cut, kScale, 1);
    EXPECT_NEAR(loss.rmse, 1, 0.5);  // three deviations of about 20 products of 10^4, over 200 000
    EXPECT_GT(loss.paired_rmse, 6);  // expected: sqrt(0.5 * 99 + 1) = 7.1
}

TEST(NoiseRmse, IsThatOfSoManySamples) {
    std::mt19937 random(1);
    std::normal_distribution<double> value(10, 0.5);  // the mean of a half of 4 samples, of deviation 1 each
    Halves image;
    for (std::vector<std::int64_t>* half : {&image.first, &image.second})
        for (int i = 0; i < 20'000; ++i) half->push_back(std::llround(value(random) * 4 * kScale));
    EXPECT_NEAR(noise_rmse(image, kScale, 4, 1), 1, 0.03);
    EXPECT_NEAR(noise_rmse(image, kScale, 4, 100), 0.1, 0.003);
}

TEST(AliveShare, IsWhatTraceOneMoreSegment) {
    const CompiledScene<float> scene = compile<float>(small_scene("furnace", 32));
    RenderSettings settings;
    const auto segments = [&](std::int32_t depth) {
        settings.depth = depth;
        return render(recursive::IterativeEngine(), scene, settings).report.segments();
    };
    const std::int64_t paths = scene.pixel_count();
    const double alive = alive_share(segments(1), segments(2), paths);
    settings.depth = 1;
    const double light = render(recursive::IterativeEngine(), scene, settings).mean(0);
    EXPECT_GT(alive, 0.1);
    EXPECT_DOUBLE_EQ(alive, 1 - light) << "in a white furnace what is cut off is what would go on";
}

}  // namespace
}  // namespace raypool::studies
