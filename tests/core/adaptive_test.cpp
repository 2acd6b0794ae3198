/// Adaptive sampling on framebuffers whose statistics are known: the estimate, and who gets more.
#include "core/adaptive.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

constexpr std::int64_t kWidth = 12;
constexpr std::int64_t kHeight = 8;

/// Adds samples uniform in [mean - spread, mean + spread], of their own in each channel.
class Samples {
  public:
    explicit Samples(std::int64_t most) : framebuffer(kWidth, kHeight, FixedPoint::make(most, 2), Moments::Second) {}
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
        estimate_error(samples.framebuffer, std::vector<std::int32_t>(kWidth * kHeight, kCount));
    const double deviation = 0.3 / std::sqrt(3.0);
    EXPECT_NEAR(estimate.rmse, deviation / std::sqrt(kCount), 0.02 * deviation / std::sqrt(kCount));
    for (const float pixel : estimate.deviation) EXPECT_NEAR(pixel, deviation, 0.05 * deviation);
}

TEST(ErrorEstimate, IsNothingForPixelsWithoutNoise) {
    Samples samples(64);
    for (std::size_t i = 0; i < kWidth * kHeight; ++i) samples.add(i, 64, 0.7, 0);
    EXPECT_LT(estimate_error(samples.framebuffer, std::vector<std::int32_t>(kWidth * kHeight, 64)).rmse, 1e-7);
}

TEST(ErrorEstimate, SpreadsAPixelsNoiseOverItsNeighbours) {
    Samples samples(64);
    for (std::size_t i = 0; i < kWidth * kHeight; ++i) samples.add(i, 64, 0.5, i == 3 * kWidth + 5 ? 0.5 : 0);
    const std::vector<float> deviation =
        estimate_error(samples.framebuffer, std::vector<std::int32_t>(kWidth * kHeight, 64)).deviation;
    for (std::size_t i = 0; i < deviation.size(); ++i) {
        const auto x = static_cast<int>(i % kWidth), y = static_cast<int>(i / kWidth);
        const bool is_near = std::abs(x - 5) <= 1 && std::abs(y - 3) <= 1;
        EXPECT_EQ(deviation[i] > 0.01F, is_near) << i;
    }
}

/// Carries a plan out on pixels of which the right half has `ratio` times the deviation of the left one.
AdaptivePlan carried_out(double target, std::int64_t most, double ratio) {
    AdaptivePlan plan(target, most, kWidth, kHeight);
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

TEST(AdaptivePlan, GivesEveryPixelItsFirstSamplesAndNoMoreWhereNothingIsNoisy) {
    AdaptivePlan plan(1e-3, 1000, kWidth, kHeight);
    Samples samples(1000);
    const auto first = plan.next(samples.framebuffer);
    ASSERT_EQ(first.size(), 1U);
    EXPECT_EQ(first[0].pixels.size(), static_cast<std::size_t>(kWidth * kHeight));
    EXPECT_EQ(first[0].end, AdaptivePlan::kFirstSamples);
    for (std::size_t i = 0; i < kWidth * kHeight; ++i) samples.add(i, AdaptivePlan::kFirstSamples, 0.25, 0);
    EXPECT_TRUE(plan.next(samples.framebuffer).empty());
}

TEST(AdaptivePlan, AsksForEachSampleOnce) {
    AdaptivePlan plan(0.01, 5000, kWidth, kHeight);
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
