#include "core/image/tile_bias.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/base/error.h"

namespace raypool {
namespace {

/// Grey noise of mean 1 and deviation 0.1, the same number in each channel of a pixel.
Image noise(std::int64_t width, std::int64_t height, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> value(1, 0.1F);
    Image image(width, height);
    for (std::size_t i = 0; i < image.rgb.size(); i += 3)
        image.rgb[i] = image.rgb[i + 1] = image.rgb[i + 2] = value(random);
    return image;
}
void brighten(Image& image, std::int64_t x_begin, std::int64_t y_begin, std::int64_t edge, float by) {
    for (std::int64_t y = y_begin; y < y_begin + edge; ++y)
        for (std::int64_t x = x_begin; x < x_begin + edge; ++x)
            for (std::int64_t c = 0; c < 3; ++c)
                image.rgb[static_cast<std::size_t>(3 * (y * image.width + x) + c)] += by;
}

/// The mean of `spp` samples a pixel, each of which is `rare` with the probability `chance` and `common` otherwise.
Image rare_light(std::int64_t edge, int spp, double common, double rare, double chance, std::mt19937& random) {
    std::binomial_distribution<int> events(spp, chance);
    Image image(edge, edge);
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
        const int count = events(random);
        const double mean = common + (rare - common) * count / spp;
        image.rgb[i] = image.rgb[i + 1] = image.rgb[i + 2] = static_cast<float>(mean);
    }
    return image;
}

BiasVerdict verdict(const Image& a, const Image& b, SampleCounts counts) {
    const std::optional<TileBias> bias = greatest_tile_bias(a, b);
    return bias ? bias_verdict(*bias, counts) : BiasVerdict::Chance;
}

TEST(TileBias, OfNoiseStaysWithinWhatChanceMakesOfManyTiles) {
    int alarms = 0;
    for (unsigned i = 0; i < 200; ++i) {
        const TileBias bias = *greatest_tile_bias(noise(128, 80, 2 * i), noise(128, 80, 2 * i + 1));
        EXPECT_EQ(bias.tile_count, 40);
        EXPECT_GT(std::abs(bias.t), 1) << "the greatest of 40";
        alarms += bias_verdict(bias, SampleCounts::Equal) == BiasVerdict::Bias ? 1 : 0;
    }
    EXPECT_LE(alarms, 6);  // 2 expected
}

TEST(TileBias, OfRareLightRaisesNoMoreFalseAlarmsThanItSays) {
    // A caustic, a small lamp in a room, and a room seen well: light that few samples meet.
    struct Light {
        double common, rare, chance;
    };
    std::mt19937 random(7);
    for (const Light& light : {Light{0.1, 400, 1e-4}, Light{0.02, 20, 3e-3}, Light{0.1, 1, 0.2}}) {
        int alarms = 0, second_alarms = 0;
        for (int i = 0; i < 100; ++i) {
            const auto render = [&](int spp) {
                return rare_light(48, spp, light.common, light.rare, light.chance, random);
            };
            const Image a = render(16), b = render(16);
            alarms += verdict(a, b, SampleCounts::Equal) == BiasVerdict::Bias ? 1 : 0;
            const Image reference = render(30'000);
            for (const auto& few : {a, render(256)}) {
                second_alarms += verdict(few, reference, SampleCounts::FirstHasFewer) == BiasVerdict::Bias ? 1 : 0;
                second_alarms += verdict(reference, few, SampleCounts::SecondHasFewer) == BiasVerdict::Bias ? 1 : 0;
            }
        }
        EXPECT_LE(alarms, 4) << light.rare;          // at most 1 expected
        EXPECT_LE(second_alarms, 12) << light.rare;  // at most 4 expected
    }
}

TEST(TileBias, OfRareLightThatFewSamplesMissIsNamedAsSuch) {
    std::mt19937 random(3);
    const Image few = rare_light(48, 16, 0.1, 400, 1e-5, random);
    const Image many = rare_light(48, 1'000'000, 0.1, 400, 1e-5, random);
    EXPECT_EQ(verdict(few, many, SampleCounts::FirstHasFewer), BiasVerdict::RareLight);
    EXPECT_EQ(verdict(many, few, SampleCounts::SecondHasFewer), BiasVerdict::RareLight);
    EXPECT_EQ(verdict(few, many, SampleCounts::Unknown), BiasVerdict::BiasIfEqual);
}

TEST(TileBias, OfAFewPixelsIsNoVerdict) {
    int alarms = 0;
    for (unsigned i = 0; i < 2000; ++i) {
        alarms += verdict(noise(2, 2, 2 * i), noise(2, 2, 2 * i + 1), SampleCounts::Equal) == BiasVerdict::Bias ? 1 : 0;
        alarms += verdict(noise(3, 3, 2 * i), noise(3, 3, 2 * i + 1), SampleCounts::Equal) == BiasVerdict::Bias ? 1 : 0;
    }
    EXPECT_LE(alarms, 35);  // 20 expected, all of them of 3 x 3
}

TEST(TileBias, FindsATileThatIsBrighterByLessThanTheNoiseOfAPixel) {
    Image a = noise(128, 80, 1);
    brighten(a, 48, 32, 16, 0.06F);
    const TileBias bias = *greatest_tile_bias(a, noise(128, 80, 2));
    EXPECT_NEAR(bias.difference, 0.06, 0.03);
    EXPECT_EQ(bias.x_begin, 48);
    EXPECT_EQ(bias.x_end, 64);
    EXPECT_EQ(bias.y_begin, 32);
    EXPECT_EQ(bias.y_end, 48);
    EXPECT_EQ(bias_verdict(bias, SampleCounts::Equal), BiasVerdict::Bias);
    EXPECT_EQ(bias_verdict(bias, SampleCounts::FirstHasFewer), BiasVerdict::Bias) << "rare light does not brighten";
    EXPECT_EQ(bias_verdict(bias, SampleCounts::SecondHasFewer), BiasVerdict::RareLight);

    const TileBias darker = *greatest_tile_bias(noise(128, 80, 2), a);
    EXPECT_DOUBLE_EQ(darker.t, -bias.t);
    EXPECT_DOUBLE_EQ(darker.p_value, bias.p_value);
}

TEST(TileBias, OfThePixelsWorkedOutByHand) {
    Image a(2, 1), b(2, 1);
    a.rgb = {1, 2, 3, 4, 5, 6};  // less b: means 2 and 4 of a pixel, so 3, and a standard error of 1
    b.rgb = {0, 0, 0, 1, 1, 1};
    const TileBias bias = *greatest_tile_bias(a, b);
    EXPECT_DOUBLE_EQ(bias.difference, 3);
    EXPECT_DOUBLE_EQ(bias.t, 3);
    EXPECT_EQ(bias.pixel_count, 2);
    EXPECT_EQ(bias.p_value, 0.5) << "two differences have one sign every other time";
    EXPECT_EQ(bias.tile_count, 1);
}

TEST(TileBias, UsesTheDistributionOfStudent) {
    Image a(11, 1);
    const Image b(11, 1);
    for (std::size_t i = 0; i < a.rgb.size(); ++i) a.rgb[i] = static_cast<float>(i / 3);
    const TileBias bias = *greatest_tile_bias(a, b);  // of 0 to 10: mean 5, standard error 1
    EXPECT_NEAR(bias.t, 5, 1e-12);
    EXPECT_NEAR(bias.p_value, std::exp2(-10), 1e-12) << "Student's is 0.000537, but one sign has a greater chance";
    Image c = a;
    for (float& value : c.rgb) value -= 3;                            // mean 2
    EXPECT_NEAR(greatest_tile_bias(c, b)->p_value, 0.0733880, 1e-6);  // of a table: t = 2, 10 degrees of freedom
}

TEST(TileBias, IsNoneWhereThereIsNothingToEstimateFrom) {
    const Image a(20, 20);
    EXPECT_FALSE(greatest_tile_bias(a, a)) << "no pixel differs";
    EXPECT_FALSE(greatest_tile_bias(noise(1, 1, 1), noise(1, 1, 2))) << "one pixel";
    Image nowhere = a;
    for (float& value : nowhere.rgb) value = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(greatest_tile_bias(nowhere, a)) << "no pixel is finite";
    nowhere.rgb[0] = nowhere.rgb[1] = nowhere.rgb[2] = 1;
    EXPECT_FALSE(greatest_tile_bias(nowhere, a)) << "one is";
}

TEST(TileBias, IsInfiniteWhereAllPixelsDifferAlike) {
    const Image a(20, 20);
    Image b = a;
    for (float& value : b.rgb) value = 0.5F;
    const TileBias bias = *greatest_tile_bias(b, a);
    EXPECT_EQ(bias.t, std::numeric_limits<double>::infinity());
    EXPECT_EQ(bias_verdict(bias, SampleCounts::Equal), BiasVerdict::Bias);
}

TEST(TileBias, LeavesOutWhatIsNotFinite) {
    Image a = noise(16, 16, 1), b = noise(16, 16, 2);
    a.rgb[5] = std::numeric_limits<float>::quiet_NaN();
    b.rgb[90] = std::numeric_limits<float>::infinity();
    const TileBias bias = *greatest_tile_bias(a, b);
    EXPECT_TRUE(std::isfinite(bias.t));
    EXPECT_EQ(bias.pixel_count, 254);
}

TEST(TileBias, CoversEveryPixelOfImagesOfAnySize) {
    for (const auto& [width, height] : {std::pair{2, 1}, {15, 3}, {17, 16}, {47, 33}}) {
        for (const auto& [x, y] : {std::pair{0, 0}, {width - 1, height - 1}}) {
            Image a = noise(width, height, 1), b = a;
            brighten(a, x, y, 1, 1);
            const TileBias bias = *greatest_tile_bias(a, b);
            EXPECT_GT(bias.difference, 0) << width << " x " << height;
            EXPECT_TRUE(x >= bias.x_begin && x < bias.x_end && y >= bias.y_begin && y < bias.y_end);
        }
    }
}

TEST(TileBias, RefusesImagesOfTwoSizes) {
    EXPECT_THROW(greatest_tile_bias(Image(2, 1), Image(1, 2)), InputError);
}

}  // namespace
}  // namespace raypool
