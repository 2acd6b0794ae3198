/// Fixed-point sums: no overflow, no order, bad samples left out and accounted for, and a hash that sees every bit.
#include "core/film/framebuffer.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

__extension__ using Int128 = __int128;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(FixedPoint, HoldsAllSamplesOfTheGreatestRadiance) {
    constexpr Int128 kMost = std::numeric_limits<std::int64_t>::max();
    for (const std::int64_t spp : {0L, 1L, 2L, 3L, 100L, 127L, 128L, 129L, 1'000'000L, 1L << 31U}) {
        for (const double radiance : {0.0, 1e-300, 1e-6, 0.3, 0.5, 1.0, 1.0000001, 7.0, 64.0, 1e6}) {
            const FixedPoint fixed = FixedPoint::make(spp, radiance);
            ASSERT_GE(fixed.limit, 2 * radiance);
            SampleConverter converter(fixed);
            const double most = fixed.limit;
            const FixedRgb brightest = converter.convert<double>(vec3<double>(most, most, most));
            ASSERT_EQ(converter.statistics().clamped, 0);
            ASSERT_GT(brightest[0], 0);
            const std::int64_t held = std::max(spp, FixedPoint::kExtensibleSamples);
            ASSERT_LE(Int128{brightest[0]} * held, kMost) << spp << ' ' << radiance;
            // Nor is a bit wasted beyond the three that rounding up to powers of two can cost.
            ASSERT_GT(Int128{brightest[0]} * held * 8, kMost) << spp << ' ' << radiance;
        }
    }
}

TEST(FixedPoint, HasOneStepForAllRendersThatCanBeExtendedToOneAnother) {
    EXPECT_EQ(FixedPoint::make(1, 3), FixedPoint::make(FixedPoint::kExtensibleSamples, 3));
    EXPECT_EQ(FixedPoint::make(64, 3), FixedPoint::make(128, 3));
    EXPECT_NE(FixedPoint::make(1, 3), FixedPoint::make(FixedPoint::kExtensibleSamples + 1, 3));
}

TEST(FixedPoint, RoundsToTheNearestStep) {
    const FixedPoint fixed = FixedPoint::make(100, 1);
    SampleConverter converter(fixed);
    const double step = 1 / fixed.scale();
    const FixedRgb sample = converter.convert<double>(vec3<double>(0.4 * step, 0.6 * step, 1000.4 * step));
    EXPECT_EQ(sample, (FixedRgb{0, 1, 1000}));
    EXPECT_LT(step, 1e-13);
}

TEST(SampleConverter, LeavesOutAndCountsSamplesThatAreNotFinite) {
    SampleConverter converter(FixedPoint::make(1, 1));
    std::int64_t count = 0;
    for (const float bad : {kNan, -kNan, kInf, -kInf}) {
        for (int channel = 0; channel < 3; ++channel) {
            Vec3<float> radiance = vec3<float>(0.5F, 0.5F, 0.5F);
            radiance[channel] = bad;
            EXPECT_EQ(converter.convert<float>(radiance), FixedRgb{});
            EXPECT_EQ(converter.statistics().non_finite, ++count);
        }
    }
    EXPECT_EQ(converter.statistics().clamped, 0);
    EXPECT_EQ(converter.statistics().clamped_energy, 0);
}

TEST(SampleConverter, CutsToTheLimitAndReportsTheEnergy) {
    const FixedPoint fixed = FixedPoint::make(1, 1);
    ASSERT_EQ(fixed.limit, 2);
    SampleConverter converter(fixed);
    const FixedRgb sample = converter.convert<float>(vec3<float>(5, 0.5F, 2));
    const auto scale = static_cast<std::int64_t>(fixed.scale());
    EXPECT_EQ(sample, (FixedRgb{2 * scale, scale / 2, 2 * scale}));
    EXPECT_EQ(converter.statistics().clamped, 1);
    EXPECT_EQ(converter.statistics().clamped_energy, 3);
}

TEST(SampleConverter, CutsNegativeRadianceToZero) {
    SampleConverter converter(FixedPoint::make(1, 1));
    EXPECT_EQ(converter.convert<float>(vec3<float>(-1, -0.0F, 0)), FixedRgb{});
    EXPECT_EQ(converter.statistics().clamped, 1);
    EXPECT_EQ(converter.statistics().clamped_energy, -1);
}

TEST(SampleStatistics, AddsUpOverThreads) {
    SampleStatistics a{1, 2, 0.5};
    a.add({10, 20, 5});
    EXPECT_EQ(a.non_finite, 11);
    EXPECT_EQ(a.clamped, 22);
    EXPECT_EQ(a.clamped_energy, 5.5);
}

/// Samples of very unequal size: their sum in float or double depends on their order.
std::vector<Vec3<float>> heavy_tailed_samples() {
    RandomInputs random(1);
    std::vector<Vec3<float>> samples;
    for (int i = 0; i < 100'000; ++i) {
        const float x = std::abs(random.magnitude<float>(-30, 10));
        samples.push_back(vec3<float>(x, 0.1F * x, static_cast<float>(i % 7) * 0.3F));
    }
    return samples;
}

TEST(Framebuffer, SumsAreTheSameInAnyOrder) {
    std::vector<Vec3<float>> samples = heavy_tailed_samples();
    RandomInputs random(2);
    std::set<std::string> hashes;
    std::set<double> sums_in_double;
    const FixedPoint fixed = FixedPoint::make(static_cast<std::int64_t>(samples.size()), 1024);
    for (int shuffle = 0; shuffle < 10; ++shuffle) {
        for (std::size_t i = samples.size() - 1; i > 0; --i)
            std::swap(samples[i], samples[static_cast<std::size_t>(random.below(static_cast<int>(i + 1)))]);
        Framebuffer framebuffer(1, 1, fixed);
        SampleConverter converter(fixed);
        double sum = 0;
        for (const Vec3<float>& sample : samples) {
            framebuffer.add(0, converter.convert<float>(sample));
            sum += sample[0];
        }
        EXPECT_EQ(converter.statistics().clamped, 0);
        hashes.insert(framebuffer.hash());
        sums_in_double.insert(sum);
    }
    EXPECT_EQ(hashes.size(), 1U);
    EXPECT_GT(sums_in_double.size(), 1U) << "these samples would not notice an order";
}

TEST(Framebuffer, AddsToTheRightPixelAndChannel) {
    Framebuffer framebuffer(3, 2, FixedPoint::make(1, 1));
    framebuffer.add(4, {10, 20, 30});
    framebuffer.add(4, {1, 2, 3});
    for (std::size_t i = 0; i < framebuffer.sums().size(); ++i)
        EXPECT_EQ(framebuffer.sums()[i], i == 12 ? 11 : i == 13 ? 22 : i == 14 ? 33 : 0);
}

TEST(Framebuffer, HashSeesEveryBitOfEverySumTheSizeAndTheStep) {
    const FixedPoint fixed = FixedPoint::make(1, 1);
    std::set<std::string> hashes{Framebuffer(3, 2, fixed).hash(), Framebuffer(2, 3, fixed).hash(),
                                 Framebuffer(6, 1, fixed).hash(), Framebuffer(3, 2, FixedPoint::make(1, 2)).hash()};
    for (std::size_t i = 0; i < 18; ++i) {
        for (unsigned bit = 0; bit < 64; ++bit) {
            Framebuffer framebuffer(3, 2, fixed);
            framebuffer.sums()[i] = static_cast<std::int64_t>(std::uint64_t{1} << bit);
            hashes.insert(framebuffer.hash());
        }
    }
    EXPECT_EQ(hashes.size(), 4U + 18 * 64);
    for (const std::string& hash : hashes) EXPECT_EQ(hash.size(), 16U);
}

TEST(Framebuffer, ImageIsTheMean) {
    const FixedPoint fixed = FixedPoint::make(4, 1);
    Framebuffer framebuffer(2, 1, fixed);
    SampleConverter converter(fixed);
    for (const float value : {0.0F, 0.25F, 0.5F, 1.0F})
        framebuffer.add(1, converter.convert<float>(vec3<float>(value, 1, 2 * value)));
    const Image image = framebuffer.image(4);
    EXPECT_EQ(image.rgb, (std::vector<float>{0, 0, 0, 0.4375F, 1, 0.875F}));
}

}  // namespace
}  // namespace raypool::test
