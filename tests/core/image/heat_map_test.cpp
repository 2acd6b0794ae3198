/// A heat map shows each pixel's cost, beside a scale that can be read at any size.
#include "core/image/heat_map.h"

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/image/colour_map.h"
#include "core/image/tiny_font.h"

namespace raypool {
namespace {

CostImage ramp(std::int64_t width, std::int64_t height, Cost cost = Cost::Tests) {
    CostImage image(cost, width, height);
    for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = static_cast<std::int64_t>(i);
    return image;
}

bool is_colour(const Image& picture, std::int64_t x, std::int64_t y, double position) {
    float rgb[3];
    inferno(position, rgb);
    return std::equal(rgb, rgb + 3, picture.pixel(x, y));
}

TEST(HeatMap, GivesEachPixelASquareOfItsColour) {
    const CostImage cost = ramp(10, 10);
    const Image picture = heat_map(cost);  // the scale goes to 100, the least multiple of 20 above 99
    ASSERT_EQ(picture.height, 240);
    for (std::int64_t y = 0; y < 240; ++y)
        for (std::int64_t x = 0; x < 240; ++x)
            ASSERT_TRUE(is_colour(picture, x, y, static_cast<double>(y / 24 * 10 + x / 24) / 100)) << x << " " << y;
}

TEST(HeatMap, HasRoomForItsScaleBesideImagesOfAnySize) {
    for (const auto& [width, height] : {std::pair{1, 1}, {8, 6}, {3000, 1}, {1, 3000}, {400, 225}, {1600, 900}}) {
        const Image picture = heat_map(ramp(width, height));
        EXPECT_GE(picture.height, std::max(240, height));
        EXPECT_LE(picture.width, std::max(1200, width) + picture.height);
        const auto has_ink = [&](std::int64_t x) {
            for (std::int64_t y = 0; y < picture.height; ++y)
                if (std::all_of(picture.pixel(x, y), picture.pixel(x, y) + 3, [](float v) { return v == 0; }))
                    return true;
            return false;
        };
        std::int64_t inked = 0;
        for (std::int64_t x = width; x < picture.width; ++x) inked += has_ink(x) ? 1 : 0;
        EXPECT_GE(inked, 60);
        EXPECT_FALSE(has_ink(picture.width - 1)) << "the scale touches the edge";
    }
}

TEST(HeatMap, IsNotDarkenedByAFewDearPixels) {
    CostImage cost = ramp(100, 10);
    cost.values[500] = 1'000'000'000;
    const Image picture = heat_map(cost);
    constexpr std::int64_t kSquare = 12;
    EXPECT_TRUE(is_colour(picture, 0, 5 * kSquare, 1)) << "what lies above the scale has its last colour";
    EXPECT_TRUE(is_colour(picture, 99 * kSquare, 9 * kSquare, 0.999)) << "the scale goes to 1000";
}

TEST(HeatMap, OfNothingIsBlackAndHasAScale) {
    const Image picture = heat_map(CostImage(Cost::Segments, 4, 4));
    EXPECT_TRUE(is_colour(picture, 0, 0, 0));
}

TEST(TinyFont, HasEveryLetterOfTheScales) {
    for (const char letter : std::string("0123456789.>kMGtestssegmentsperpixelnsums")) {
        const Glyph& glyph = glyph_of(letter);
        EXPECT_EQ(glyph.letter, letter);
        EXPECT_EQ((glyph.dots.size() + 1) % (kGlyphWidth + 1), 0U) << "rows are whole";
        EXPECT_LE(glyph.dots.size(), static_cast<std::size_t>(kGlyphRows * (kGlyphWidth + 1) - 1));
        EXPECT_NE(glyph.dots.find('#'), std::string_view::npos);
    }
    EXPECT_EQ(glyph_of('?').letter, ' ');
}

}  // namespace
}  // namespace raypool
