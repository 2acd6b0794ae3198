#include "core/tile_bias.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/error.h"
#include "tests/significance.h"

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

TEST(TileBias, OfNoiseStaysWithinWhatChanceMakesOfManyTiles) {
    int alarms = 0;
    for (unsigned i = 0; i < 50; ++i) {
        const TileBias bias = greatest_tile_bias(noise(128, 80, 2 * i), noise(128, 80, 2 * i + 1));
        EXPECT_EQ(bias.tile_count, 40);
        EXPECT_GT(std::abs(bias.z), 1) << "the greatest of 40";
        alarms += std::abs(bias.z) > bias.z_limit ? 1 : 0;
    }
    EXPECT_LE(alarms, 3);  // 0.5 expected
}

TEST(TileBias, FindsATileThatIsBrighterByLessThanTheNoiseOfAPixel) {
    Image a = noise(128, 80, 1);
    brighten(a, 48, 32, 16, 0.06F);
    const TileBias bias = greatest_tile_bias(a, noise(128, 80, 2));
    EXPECT_GT(bias.z, bias.z_limit);
    EXPECT_NEAR(bias.difference, 0.06, 0.03);
    EXPECT_EQ(bias.x_begin, 48);
    EXPECT_EQ(bias.x_end, 64);
    EXPECT_EQ(bias.y_begin, 32);
    EXPECT_EQ(bias.y_end, 48);

    const TileBias darker = greatest_tile_bias(noise(128, 80, 2), a);
    EXPECT_DOUBLE_EQ(darker.z, -bias.z);
}

TEST(TileBias, OfThePixelsWorkedOutByHand) {
    Image a(2, 1), b(2, 1);
    a.rgb = {1, 2, 3, 4, 5, 6};  // less b: means 2 and 4 of a pixel, so 3, and a standard error of 1
    b.rgb = {0, 0, 0, 1, 1, 1};
    const TileBias bias = greatest_tile_bias(a, b);
    EXPECT_DOUBLE_EQ(bias.difference, 3);
    EXPECT_DOUBLE_EQ(bias.z, 3);
    EXPECT_EQ(bias.tile_count, 1);
}

TEST(TileBias, IsNothingBetweenEqualImagesAndInfiniteWhereAllPixelsDifferAlike) {
    Image a(20, 20);
    EXPECT_EQ(greatest_tile_bias(a, a).z, 0);
    EXPECT_EQ(greatest_tile_bias(a, a).x_end, 20);
    Image b = a;
    for (float& value : b.rgb) value = 0.5F;
    EXPECT_EQ(greatest_tile_bias(b, a).z, std::numeric_limits<double>::infinity());
}

TEST(TileBias, LeavesOutWhatIsNotFinite) {
    Image a = noise(16, 16, 1), b = noise(16, 16, 2);
    a.rgb[5] = std::numeric_limits<float>::quiet_NaN();
    b.rgb[90] = std::numeric_limits<float>::infinity();
    EXPECT_TRUE(std::isfinite(greatest_tile_bias(a, b).z));
}

TEST(TileBias, CoversEveryPixelOfImagesOfAnySize) {
    for (const auto& [width, height] : {std::pair{1, 1}, {15, 3}, {17, 16}, {47, 33}}) {
        for (const auto& [x, y] : {std::pair{0, 0}, {width - 1, height - 1}}) {
            Image a = noise(width, height, 1), b = a;
            brighten(a, x, y, 1, 1);
            const TileBias bias = greatest_tile_bias(a, b);
            EXPECT_GT(bias.difference, 0) << width << " x " << height;
            EXPECT_TRUE(x >= bias.x_begin && x < bias.x_end && y >= bias.y_begin && y < bias.y_end);
        }
    }
}

TEST(TileBias, RefusesImagesOfTwoSizes) {
    EXPECT_THROW(greatest_tile_bias(Image(2, 1), Image(1, 2)), InputError);
}

TEST(SidakLimit, IsTheQuantileOfTheNormalForOneAndHoldsForTheFamily) {
    EXPECT_NEAR(sidak_limit(1, 0.01), 2.5758, 1e-4);
    for (const int count : {1, 40, 1000})
        EXPECT_NEAR(1 - std::pow(1 - test::p_value_of_z(sidak_limit(count, 0.01)), count), 0.01, 1e-9);
}

}  // namespace
}  // namespace raypool
