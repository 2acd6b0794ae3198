#include "core/image/image_diff.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/error.h"

namespace raypool {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Image image_of(std::int64_t width, std::int64_t height, std::vector<float> rgb) {
    Image image(width, height);
    EXPECT_EQ(image.rgb.size(), rgb.size());
    image.rgb = std::move(rgb);
    return image;
}

TEST(ImageDiff, OfAnImageWithItselfIsNothing) {
    const Image image = image_of(2, 1, {0, -1, 0.5F, 1e30F, kInfinity, kNaN});
    const ImageDiff diff = compare_images(image, image);
    EXPECT_EQ(diff.rmse, 0);
    EXPECT_EQ(diff.rel_mse, 0);
    EXPECT_EQ(diff.psnr, kInfinity);
    EXPECT_EQ(diff.max_abs, 0);
    EXPECT_EQ(diff.max_ulp, 0U);
    EXPECT_EQ(diff.differing_pixels, 0);
}

TEST(ImageDiff, MatchesFiguresWorkedOutByHand) {
    const Image a = image_of(2, 1, {1, 0, 0, 0.5F, 2, 0});
    const Image b = image_of(2, 1, {1, 0, 0, 1, 4, 0});
    const ImageDiff diff = compare_images(a, b);
    // Squared errors 0.25 and 4; the squares of b are 1, 1 and 16, their mean 3, a hundredth of it 0.03.
    EXPECT_DOUBLE_EQ(diff.mse, 4.25 / 6);
    EXPECT_DOUBLE_EQ(diff.rmse, std::sqrt(4.25 / 6));
    EXPECT_DOUBLE_EQ(diff.rel_mse, (0.25 / 1.03 + 4 / 16.03) / 6);
    EXPECT_NEAR(diff.psnr, 10 * std::log10(6 / 4.25), 1e-12);
    EXPECT_EQ(diff.max_abs, 2);
    EXPECT_EQ(diff.max_ulp, std::uint64_t{1} << 23);  // from 0.5 to 1 and from 2 to 4
    EXPECT_EQ(diff.differing_pixels, 1);
    EXPECT_EQ(diff.mean_a, (std::array<double, 3>{0.75, 1, 0}));
    EXPECT_EQ(diff.mean_b, (std::array<double, 3>{1, 2, 0}));
}

TEST(ImageDiff, TheReferenceOfTheRelativeErrorIsTheSecondImage) {
    const Image a = image_of(1, 1, {1, 1, 1});
    const Image b = image_of(1, 1, {2, 2, 2});
    EXPECT_DOUBLE_EQ(compare_images(a, b).rel_mse, 1 / 4.04);
    EXPECT_DOUBLE_EQ(compare_images(b, a).rel_mse, 1 / 1.01);
}

TEST(ImageDiff, CountsFloatsBetweenTwoValuesAcrossZero) {
    const float smallest = std::numeric_limits<float>::denorm_min();
    const auto ulps = [](float a, float b) {
        return compare_images(image_of(1, 1, {a, 0, 0}), image_of(1, 1, {b, 0, 0})).max_ulp;
    };
    EXPECT_EQ(ulps(1, std::nextafter(1.0F, 2.0F)), 1U);
    EXPECT_EQ(ulps(-smallest, smallest), 2U);
    EXPECT_EQ(ulps(-kInfinity, kInfinity), 2U * 0x7f800000U);
    EXPECT_EQ(ulps(kNaN, 1), std::numeric_limits<std::uint64_t>::max());
}

TEST(ImageDiff, ZeroesOfEitherSignDifferInBitsOnly) {
    const ImageDiff diff = compare_images(image_of(1, 1, {-0.0F, 0, 0}), image_of(1, 1, {0, 0, 0}));
    EXPECT_EQ(diff.differing_pixels, 1);
    EXPECT_EQ(diff.max_ulp, 0U);
    EXPECT_EQ(diff.rmse, 0);
    EXPECT_EQ(diff.rel_mse, 0);
}

TEST(ImageDiff, WhatIsNotFiniteOnOneSideIsAnInfiniteError) {
    for (const float odd : {kNaN, -kNaN, kInfinity, -kInfinity}) {
        for (const float even : {0.0F, 1.0F, odd == kInfinity ? kNaN : kInfinity}) {
            for (const bool swap : {false, true}) {
                const Image a = image_of(1, 1, {swap ? even : odd, 0, 0});
                const Image b = image_of(1, 1, {swap ? odd : even, 0, 0});
                const ImageDiff diff = compare_images(a, b);
                EXPECT_EQ(diff.rmse, kInfinity);
                EXPECT_EQ(diff.rel_mse, kInfinity);
                EXPECT_EQ(diff.psnr, -kInfinity);
                EXPECT_EQ(diff.max_abs, kInfinity);
                EXPECT_EQ(diff.differing_pixels, 1);
            }
        }
    }
}

TEST(ImageDiff, AnyErrorAgainstBlackIsRelativelyInfinite) {
    const Image black = image_of(1, 1, {0, 0, 0});
    EXPECT_EQ(compare_images(image_of(1, 1, {0.1F, 0, 0}), black).rel_mse, kInfinity);
    EXPECT_EQ(compare_images(black, black).rel_mse, 0);
}

TEST(ImageDiff, RefusesImagesOfDifferentSizes) {
    EXPECT_THROW(compare_images(Image(2, 3), Image(3, 2)), InputError);
    EXPECT_THROW(false_colour(Image(2, 3), Image(3, 2)), InputError);
}

double luminance(const float* rgb) {
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

TEST(FalseColour, GetsBrighterWithTheErrorAndIsBlackForEqualPixelsOnly) {
    constexpr std::int64_t kPixels = 9;
    Image a(kPixels, 1);
    const Image b(kPixels, 1);
    for (std::int64_t x = 1; x < kPixels; ++x) a.pixel(x, 0)[1] = std::pow(10.0F, static_cast<float>(x - 7));
    const Image picture = false_colour(a, b);
    EXPECT_EQ(luminance(picture.pixel(0, 0)), 0);
    for (std::int64_t x = 1; x < kPixels; ++x) {
        EXPECT_GT(luminance(picture.pixel(x, 0)), luminance(picture.pixel(x - 1, 0))) << x;
    }
    EXPECT_GT(luminance(picture.pixel(kPixels - 1, 0)), 0.9);
}

TEST(FalseColour, ShowsTheSmallestDifferenceAndMarksNaNAsTheLargest) {
    const Image b = image_of(3, 1, {0, 0, 0, 0, 0, 0, 0, 0, 0});
    const Image a = image_of(3, 1, {-0.0F, 0, 0, 0, kNaN, 0, 1000, 1000, 1000});
    const Image picture = false_colour(a, b);
    EXPECT_GT(luminance(picture.pixel(0, 0)), 0);
    EXPECT_LT(luminance(picture.pixel(0, 0)), 0.02);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(picture.pixel(1, 0)[c], picture.pixel(2, 0)[c]);
    for (const float value : picture.rgb) EXPECT_TRUE(value >= 0 && value <= 1);
}

}  // namespace
}  // namespace raypool
