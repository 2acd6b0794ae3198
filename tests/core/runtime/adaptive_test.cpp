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

/// Adds samples uniform in [mean - spread, mean + spread], of their own in each channel.
class Samples {
  public:
    explicit Samples(std::int64_t most)
        : framebuffer(kWidth, kHeight, FixedPoint::make(most, kBrightest), Moments::Second) {}
    void add(std::size_t pixel, std::int64_t count, double mean, double spread) {
        SampleConverter converter(framebuffer.fixed_point());
        for (std::int64_t i = 0; i < count; ++i) {
            const auto value = [&] { return mean + spread * random_.uniform(-1, 1); };
            const FixedRgb sample = converter.convert<double>(vec3<double>(value(), value(), value()));
            framebuffer.add(static_cast<std::int64_t>(pixel), sample);
            framebuffer.add_square(static_cast<std::int64_t>(pixel), converter.square(sample));
        }
    }
    Framebuffer framebuffer;

  private:
    RandomInputs random_{1};
};

TEST(ErrorEstimate, IsTheStandardErrorOfTheMeans) {
    constexpr std::int32_t kCount = 400;
    Samples samples(kCount);
    for (std::size_t i = 0; i < kWidth * kHeight; ++i) samples.add(i, kCount, 0.5, 0.3);
    const ErrorEstimate estimate =
        estimate_error(samples.framebuffer, std::vector<std::int32_t>(kWidth * kHeight, kCount), kBrightest);
    const double deviation = 0.3 / std::sqrt(3.0);
    EXPECT_NEAR(estimate.rmse, deviation / std::sqrt(kCount), 0.02 * deviation / std::sqrt(kCount));
    for (const float pixel : estimate.deviation) EXPECT_NEAR(pixel, deviation, 0.05 * deviation);
}

TEST(ErrorEstimate, IsExactlyNothingForPixelsWithoutNoiseAndSaysThatItKnowsNone) {
    Samples samples(64);
    for (std::size_t i = 0; i < kWidth * kHeight; ++i) samples.add(i, 64, 0.7, 0);
    const ErrorEstimate estimate =
        estimate_error(samples.framebuffer, std::vector<std::int32_t>(kWidth * kHeight, 64), kBrightest);
    EXPECT_EQ(estimate.rmse, 0);
    EXPECT_EQ(estimate.flat_pixels, kWidth * kHeight);
    // By the rule of three, for 99 %: fewer than ln 100 samples of all that there are should have found light.
    EXPECT_NEAR(estimate.most_rmse, kBrightest * std::sqrt(std::log(100.0) / (kWidth * kHeight)) / 64, 1e-9);
    EXPECT_EQ(estimate.unseen_rmse, estimate.most_rmse);
}

TEST(ErrorEstimate, OfAPixelIsThatOfThePixelsAroundItAndNotItsOwn) {
    Samples samples(64);
    for (std::size_t i = 0; i < kWidth * kHeight; ++i) samples.add(i, 64, 0.5, i == 3 * kWidth + 5 ? 0.5 : 0);
    const std::vector<float> deviation =
        estimate_error(samples.framebuffer, std::vector<std::int32_t>(kWidth * kHeight, 64), kBrightest).deviation;
    for (std::size_t i = 0; i < deviation.size(); ++i) {
        const auto x = static_cast<int>(i % kWidth), y = static_cast<int>(i / kWidth);
        const bool is_near = std::abs(x - 5) <= 2 && std::abs(y - 3) <= 2 && (x != 5 || y != 3);
        EXPECT_EQ(deviation[i] > 0.01F, is_near) << i;
    }
}

TEST(ErrorEstimate, SeesDimNoiseWhateverElseTheSceneHolds) {
    for (const double brightest : {1.0, 1e3, 1e6}) {
        Framebuffer framebuffer(1, 1, FixedPoint::make(4096, brightest), Moments::Second);
        SampleConverter converter(framebuffer.fixed_point());
        for (int i = 0; i < 16; ++i) {
            const double value = i % 2 == 0 ? 0.039 : 0.041;
            const FixedRgb sample = converter.convert<double>(vec3<double>(value, value, value));
            framebuffer.add(0, sample);
            framebuffer.add_square(0, converter.square(sample));
        }
        const double rmse = estimate_error(framebuffer, {16}, brightest).rmse;
        EXPECT_NEAR(rmse, 0.001 / std::sqrt(15.0), 1e-4 * rmse) << brightest;
    }
}

TEST(ErrorEstimate, KeepsItsDigitsWhereVarianceIsTinyBesideTheMean) {
    Framebuffer framebuffer(1, 1, FixedPoint::make(1, 1), Moments::Second);
    SampleConverter converter(framebuffer.fixed_point());
    constexpr std::int64_t kMean = std::int64_t{1} << 44;
    for (const std::int64_t apart : {-1, 1, -1, 1}) {
        const FixedRgb sample{kMean + apart, kMean + apart, kMean + apart};
        framebuffer.add(0, sample);
        framebuffer.add_square(0, converter.square(sample));
    }
    EXPECT_DOUBLE_EQ(estimate_error(framebuffer, {4}, 1).rmse * framebuffer.fixed_point().scale(), std::sqrt(1.0 / 3));
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
    const std::vector<std::int32_t> counts(kWidth * kHeight, kSamples);
    const double error = radiance * std::sqrt(chance * (1 - chance) / kSamples);
    RandomInputs random(3);
    int broken = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        Framebuffer framebuffer(kWidth, kHeight, FixedPoint::make(kSamples, radiance), Moments::Second);
        SampleConverter converter(framebuffer.fixed_point());
        const FixedRgb lit = converter.convert<double>(vec3<double>(radiance, radiance, radiance));
        for (std::int64_t i = 0; i < kWidth * kHeight * kSamples; ++i) {
            if (random.uniform(0, 1) >= chance) continue;
            framebuffer.add(i / kSamples, lit);
            framebuffer.add_square(i / kSamples, converter.square(lit));
        }
        broken += estimate_error(framebuffer, counts, radiance).most_rmse < error ? 1 : 0;
    }
    EXPECT_LE(broken, 0.02 * kTrials);
}
INSTANTIATE_TEST_SUITE_P(Chances, RareLight,
                         testing::Values(RareCase{1e-5, 1e4}, RareCase{3e-4, 300}, RareCase{2e-3, 50},
                                         RareCase{0.02, 5}, RareCase{0.5, 1}),
                         [](const auto& info) { return std::to_string(info.index); });

/// Carries a plan out on pixels of which the right half has `ratio` times the deviation of the left one.
AdaptivePlan carried_out(double target, std::int64_t most, double ratio) {
    AdaptivePlan plan({target, kBrightest, most}, kWidth, kHeight);
    Samples samples(most);
    for (auto passes = plan.next(samples.framebuffer); !passes.empty(); passes = plan.next(samples.framebuffer)) {
        for (const SamplePass& pass : passes)
            for (const std::uint32_t pixel : pass.pixels)
                samples.add(pixel, pass.end - pass.first, 0.5, pixel % kWidth < kWidth / 2 ? 0.4 : 0.4 * ratio);
    }
    return plan;
}

TEST(AdaptivePlan, ReachesTheErrorWithSamplesInProportionToDeviation) {
    const AdaptivePlan plan = carried_out(0.004, 1 << 20, 0.25);
    EXPECT_LE(plan.rmse(), 0.004);
    EXPECT_GT(plan.rmse(), 0.8 * 0.004) << "and not with far more than it takes";
    const double left = plan.sample_counts()[2];            // away from the border,
    const double right = plan.sample_counts()[kWidth - 3];  // where smoothing mixes the halves
    EXPECT_NEAR(left / right, 4, 1.2);
}

TEST(AdaptivePlan, StopsAtTheMostSamples) {
    const AdaptivePlan plan = carried_out(1e-6, 100, 1);
    EXPECT_EQ(plan.sample_counts(), std::vector<std::int32_t>(kWidth * kHeight, 100));
    EXPECT_GT(plan.rmse(), 1e-6);
}

/// Carries a plan out on pixels whose samples are all equal.
AdaptivePlan carried_out_without_noise(const AdaptiveTarget& target) {
    AdaptivePlan plan(target, kWidth, kHeight);
    Framebuffer framebuffer(kWidth, kHeight, FixedPoint::make(target.most_samples, target.max_radiance),
                            Moments::Second);
    SampleConverter converter(framebuffer.fixed_point());
    const FixedRgb sample = converter.convert<double>(vec3<double>(0.25, 0.25, 0.25));
    for (auto passes = plan.next(framebuffer); !passes.empty(); passes = plan.next(framebuffer)) {
        for (const SamplePass& pass : passes) {
            for (const std::uint32_t pixel : pass.pixels) {
                for (std::int64_t i = pass.first; i < pass.end; ++i) {
                    framebuffer.add(pixel, sample);
                    framebuffer.add_square(pixel, converter.square(sample));
                }
            }
        }
    }
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
    Framebuffer framebuffer(kWidth, kHeight, FixedPoint::make(1, radiance), Moments::Second);
    SampleConverter converter(framebuffer.fixed_point());
    const FixedRgb lit = converter.convert<double>(vec3<double>(radiance, radiance, radiance));
    RandomInputs random(seed);
    for (auto passes = plan.next(framebuffer); !passes.empty(); passes = plan.next(framebuffer)) {
        for (const SamplePass& pass : passes) {
            for (const std::uint32_t pixel : pass.pixels) {
                for (std::int64_t i = pass.first; i < pass.end; ++i) {
                    if (random.uniform(0, radiance) >= 1) continue;
                    framebuffer.add(pixel, lit);
                    framebuffer.add_square(pixel, converter.square(lit));
                }
            }
        }
    }
    const Image image = framebuffer.image(plan.sample_counts());
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
    std::vector<std::int64_t> counts(kWidth * kHeight);
    for (auto passes = plan.next(samples.framebuffer); !passes.empty(); passes = plan.next(samples.framebuffer)) {
        for (const SamplePass& pass : passes) {
            EXPECT_TRUE(std::is_sorted(pass.pixels.begin(), pass.pixels.end()));
            for (const std::uint32_t pixel : pass.pixels) {
                ASSERT_EQ(counts[pixel], pass.first);
                counts[pixel] = pass.end;
                samples.add(pixel, pass.end - pass.first, 0.5, 0.01 * static_cast<double>(pixel % 40));
            }
        }
    }
    EXPECT_EQ(std::vector<std::int64_t>(plan.sample_counts().begin(), plan.sample_counts().end()), counts);
}

}  // namespace
}  // namespace raypool::test
