/// Adaptive sampling on framebuffers whose statistics are known: the estimate, and which pixels get more.
#include "core/runtime/adaptive.h"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

constexpr std::int64_t kWidth = 12;
constexpr std::int64_t kHeight = 8;
/// No sample below is brighter.
constexpr double kBrightest = 1;

/// A framebuffer that knows how many samples each pixel has.
class Samples {
  public:
    explicit Samples(std::int64_t most, double brightest = kBrightest, std::int64_t width = kWidth,
                     std::int64_t height = kHeight)
        : framebuffer(width, height, FixedPoint::make(most, brightest), Halves::Apart),
          counts(static_cast<std::size_t>(width * height)) {}
    void add(std::size_t pixel, const FixedRgb& sample) {
        const auto number = static_cast<std::uint32_t>(counts[pixel]++);
        framebuffer.add(cell_of(true, static_cast<std::uint32_t>(pixel), number), sample);
    }
    void add(std::size_t pixel, double grey) {
        add(pixel, SampleConverter(framebuffer.fixed_point()).convert<double>(vec3<double>(grey, grey, grey)));
    }
    /// Samples uniform in [mean - spread, mean + spread], of their own in each channel.
    void add(std::size_t pixel, std::int64_t count, double mean, double spread) {
        SampleConverter converter(framebuffer.fixed_point());
        for (std::int64_t i = 0; i < count; ++i) {
            const auto value = [&] { return mean + spread * random_.uniform(-1, 1); };
            add(pixel, converter.convert<double>(vec3<double>(value(), value(), value())));
        }
    }
    [[nodiscard]] ErrorEstimate estimate(double brightest = kBrightest) const {
        return estimate_error(framebuffer, counts, brightest);
    }
    Framebuffer framebuffer;
    std::vector<std::int32_t> counts;

  private:
    RandomInputs random_{1};
};

/// Carries `plan` out: add(pixel) adds a sample.
template <class Add>
void carry_out(AdaptivePlan& plan, Samples& samples, Add add) {
    for (auto passes = plan.next(samples.framebuffer); !passes.empty(); passes = plan.next(samples.framebuffer)) {
        for (const SamplePass& pass : passes) {
            EXPECT_TRUE(std::is_sorted(pass.pixels.begin(), pass.pixels.end()));
            for (const std::uint32_t pixel : pass.pixels) {
                ASSERT_EQ(samples.counts[pixel], pass.first);
                for (std::int64_t i = pass.first; i < pass.end; ++i) add(pixel);
            }
        }
    }
}

TEST(Halves, ShareEachPairOfSamplesByChance) {
    int first_in_b = 0, changes = 0, alike = 0;
    constexpr std::uint32_t kPairs = 4000;
    for (std::uint32_t pixel = 0; pixel < 3; ++pixel) {
        for (std::uint32_t pair = 0; pair < kPairs; ++pair) {
            const std::uint32_t half = half_of_sample(pixel, 2 * pair);
            ASSERT_EQ(half + half_of_sample(pixel, 2 * pair + 1), 1U);
            first_in_b += static_cast<int>(half);
            changes += half != half_of_sample(pixel, 2 * pair + 2) ? 1 : 0;
            alike += half == half_of_sample(pixel + 1, 2 * pair) ? 1 : 0;
        }
    }
    for (const int count : {first_in_b, changes, alike}) EXPECT_NEAR(count, 1.5 * kPairs, 4 * std::sqrt(0.75 * kPairs));
}

/// Also where counts are odd, so that the halves are of different size and samples far from zero.
TEST(ErrorEstimate, IsTheStandardErrorOfTheMeans) {
    for (const std::int32_t count : {2, 3, 7, 400}) {
        constexpr std::int64_t kSide = 100;
        Samples samples(count, kBrightest, kSide, kSide);
        for (std::size_t i = 0; i < kSide * kSide; ++i) samples.add(i, count, 0.5, 0.3);
        const ErrorEstimate estimate = samples.estimate();
        const double deviation = 0.3 / std::sqrt(3.0);
        // 3 kSide^2 squares of nearly normal differences: their mean is known to 0.8 %, a root to 0.4 %, four of which
        // are allowed.
        EXPECT_NEAR(estimate.rmse / (deviation / std::sqrt(count)), 1, 0.016) << count;
        // 24 pixels around, or eight at a corner: a root is known to 5.9 %, or to 10 %.
        for (const float pixel : estimate.deviation) EXPECT_NEAR(pixel / deviation, 1, 0.5) << count;
    }
}

TEST(ErrorEstimate, IsExactlyNothingForPixelsWithoutNoiseAndSaysThatItKnowsNone) {
    for (const std::int32_t count : {64, 65}) {
        Samples samples(count);
        for (std::size_t i = 0; i < kWidth * kHeight; ++i) samples.add(i, count, 0.7, 0);
        const ErrorEstimate estimate = samples.estimate();
        EXPECT_EQ(estimate.rmse, 0);
        EXPECT_EQ(estimate.flat_pixels, kWidth * kHeight);
        // By the rule of three, for 99 %: fewer than ln 100 samples of all that there are should have found light.
        EXPECT_NEAR(estimate.most_rmse, kBrightest * std::sqrt(std::log(100.0) / (kWidth * kHeight)) / count, 1e-9);
        EXPECT_EQ(estimate.unseen_rmse, estimate.most_rmse);
    }
}

TEST(ErrorEstimate, OfAPixelIsThatOfThePixelsAroundItAndNotItsOwn) {
    Samples samples(64);
    for (std::size_t i = 0; i < kWidth * kHeight; ++i) samples.add(i, 64, 0.5, i == 3 * kWidth + 5 ? 0.5 : 0);
    const std::vector<float> deviation = samples.estimate().deviation;
    for (std::size_t i = 0; i < deviation.size(); ++i) {
        const auto x = static_cast<int>(i % kWidth), y = static_cast<int>(i / kWidth);
        const bool is_near = std::abs(x - 5) <= 2 && std::abs(y - 3) <= 2 && (x != 5 || y != 3);
        EXPECT_EQ(deviation[i] > 0.01F, is_near) << i;
    }
}

TEST(ErrorEstimate, SeesDimNoiseWhateverElseTheSceneHolds) {
    for (const double brightest : {1.0, 1e3, 1e6}) {
        Samples samples(4096, brightest, 1, 1);
        // One half has all of the brighter ones: halves that are 16 * 0.001 apart.
        for (std::uint32_t i = 0; i < 16; ++i) samples.add(0, half_of_sample(0U, i) == 0 ? 0.039 : 0.041);
        const double rmse = samples.estimate(brightest).rmse;
        EXPECT_NEAR(rmse, 0.001, 1e-4 * rmse) << brightest;
    }
}

TEST(ErrorEstimate, KeepsItsDigitsWhereVarianceIsTinyBesideTheMean) {
    Samples samples(1, 1, 1, 1);
    constexpr std::int64_t kMean = std::int64_t{1} << 44;
    for (std::uint32_t i = 0; i < 4; ++i) {
        const std::int64_t grey = kMean + (half_of_sample(0U, i) == 0 ? -1 : 1);
        samples.add(0, {grey, grey, grey});
    }
    EXPECT_DOUBLE_EQ(samples.estimate(1).rmse * samples.framebuffer.fixed_point().scale(), 1);
}

struct RareCase {
    double chance;  ///< that a sample finds light
    double radiance;
};
class RareLight : public testing::TestWithParam<RareCase> {};

/// Error limits of images in whose pixels light is found with the same small chance.
TEST_P(RareLight, RarelyBreaksTheLimitOfItsError) {
    const auto [chance, radiance] = GetParam();
    constexpr int kSamples = 16;
    constexpr int kTrials = 400;
    const double error = radiance * std::sqrt(chance * (1 - chance) / kSamples);
    RandomInputs random(3);
    int broken = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        Samples samples(kSamples, radiance);
        for (std::size_t i = 0; i < kWidth * kHeight * kSamples; ++i)
            samples.add(i / kSamples, random.uniform(0, 1) < chance ? radiance : 0);
        broken += samples.estimate(radiance).most_rmse < error ? 1 : 0;
    }
    EXPECT_LE(broken, 0.02 * kTrials);
}
INSTANTIATE_TEST_SUITE_P(Chances, RareLight,
                         testing::Values(RareCase{1e-5, 1e4}, RareCase{3e-4, 300}, RareCase{2e-3, 50},
                                         RareCase{0.02, 5}, RareCase{0.5, 1}),
                         [](const auto& info) { return std::to_string(info.index); });

/// Carries a plan out on pixels of which the right half has `ratio` times the deviation of the left one. There are
/// many, since of few an error is not known well, and more samples are taken for it.
constexpr std::int64_t kManyWidth = 50;
constexpr std::int64_t kManyHeight = 40;
AdaptivePlan carried_out(double target, std::int64_t most, double ratio) {
    AdaptivePlan plan({target, kBrightest, most}, kManyWidth, kManyHeight);
    Samples samples(most, kBrightest, kManyWidth, kManyHeight);
    carry_out(plan, samples, [&](std::size_t pixel) {
        samples.add(pixel, 1, 0.5, pixel % kManyWidth < kManyWidth / 2 ? 0.4 : 0.4 * ratio);
    });
    return plan;
}

TEST(AdaptivePlan, ReachesTheErrorWithSamplesInProportionToDeviation) {
    const AdaptivePlan plan = carried_out(0.01, 1 << 20, 0.25);
    EXPECT_LE(plan.rmse(), 0.01);
    EXPECT_GT(plan.rmse(), 0.8 * 0.01) << "and not with far more than it takes";
    double left = 0, right = 0;  // away from where smoothing mixes the halves
    for (std::int64_t i = 0; i < kManyWidth * kManyHeight; ++i) {
        const std::int64_t x = i % kManyWidth;
        (x < kManyWidth / 2 ? left : right) +=
            std::abs(2 * x - kManyWidth) > 6 ? plan.sample_counts()[static_cast<std::size_t>(i)] : 0;
    }
    EXPECT_NEAR(left / right, 4, 0.6);
}

TEST(AdaptivePlan, StopsAtTheMostSamples) {
    const AdaptivePlan plan = carried_out(1e-6, 100, 1);
    EXPECT_EQ(plan.sample_counts(), std::vector<std::int32_t>(kManyWidth * kManyHeight, 100));
    EXPECT_GT(plan.rmse(), 1e-6);
}

/// Carries a plan out on pixels whose samples are all equal.
AdaptivePlan carried_out_without_noise(const AdaptiveTarget& target) {
    AdaptivePlan plan(target, kWidth, kHeight);
    Samples samples(target.most_samples, target.greatest_sample);
    carry_out(plan, samples, [&](std::size_t pixel) { samples.add(pixel, 0.25); });
    return plan;
}

TEST(AdaptivePlan, GivesEveryPixelItsFirstSamplesAndNoMoreWhereNothingBrightCanHide) {
    const AdaptivePlan plan = carried_out_without_noise({0.03, kBrightest, 1000});
    EXPECT_EQ(plan.sample_counts(), std::vector<std::int32_t>(kWidth * kHeight, AdaptivePlan::kFirstSamples));
    EXPECT_EQ(plan.status(), TargetStatus::Reached);
}

TEST(AdaptivePlan, GoesOnUntilUnseenLightIsBoundedThoughNoSampleDiffers) {
    const AdaptivePlan plan = carried_out_without_noise({1e-3, kBrightest, 1000});
    EXPECT_EQ(plan.status(), TargetStatus::Reached);
    EXPECT_GT(plan.report().sample_counts[0], 200);
    EXPECT_LE(plan.report().most_rmse, 1e-3);
}

TEST(AdaptivePlan, DoesNotCallATargetReachedThatALampMayBreakWhichNoSampleFound) {
    const AdaptivePlan plan = carried_out_without_noise({0.01, 1e6, 100});
    EXPECT_EQ(plan.rmse(), 0);
    EXPECT_EQ(plan.status(), TargetStatus::Unknown);
    EXPECT_EQ(plan.report().flat_pixels, kWidth * kHeight);
    EXPECT_EQ(plan.sample_counts(), std::vector<std::int32_t>(kWidth * kHeight, 100)) << "it searched for it";
}

/// Renders pixels in which a sample is `radiance` with the chance 1 / radiance, else 0: their mean is 1.
std::pair<AdaptivePlan, double> carried_out_in_rare_light(double target, double radiance, std::uint64_t seed) {
    AdaptivePlan plan({target, radiance, 1 << 16}, kWidth, kHeight);
    Samples samples(1, radiance);
    RandomInputs random(seed);
    carry_out(plan, samples,
              [&](std::size_t pixel) { samples.add(pixel, random.uniform(0, radiance) < 1 ? radiance : 0); });
    const Image image = samples.framebuffer.image(plan.sample_counts());
    double mean = 0;
    for (const float value : image.rgb) mean += value / static_cast<double>(image.rgb.size());
    return {plan, mean};
}

TEST(AdaptivePlan, KeepsTheMeanAndTheTargetWhereLightIsRare) {
    constexpr int kTrials = 16;
    for (const double radiance : {30.0, 300.0}) {
        double mean = 0;
        for (int seed = 0; seed < kTrials; ++seed) {
            const auto [plan, own_mean] = carried_out_in_rare_light(1, radiance, static_cast<std::uint64_t>(seed));
            EXPECT_EQ(plan.status(), TargetStatus::Reached);
            mean += own_mean / kTrials;
        }
        // The standard error of a mean is the target over the root of all pixels; 3 % are four of them.
        EXPECT_NEAR(mean, 1, 0.11) << radiance;
    }
}

TEST(AdaptivePlan, AsksForEachSampleOnce) {
    AdaptivePlan plan({0.01, kBrightest, 5000}, kWidth, kHeight);
    Samples samples(5000);
    carry_out(plan, samples,
              [&](std::size_t pixel) { samples.add(pixel, 1, 0.5, 0.01 * static_cast<double>(pixel % 40)); });
    EXPECT_EQ(plan.sample_counts(), samples.counts);
}

}  // namespace
}  // namespace raypool::test
