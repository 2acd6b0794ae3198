#include "core/image/heat_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/image/colour_map.h"
#include "core/image/tiny_font.h"

namespace raypool {

namespace {

/// The values that the colours stand for.
struct Scale {
    double step;  ///< from tick to tick
    int ticks;    ///< above zero
    bool is_clipped;

    [[nodiscard]] double top() const { return step * ticks; }
};

/// About five ticks, at round numbers.
Scale make_scale(const std::vector<std::int64_t>& values) {
    constexpr double kPart = 0.995;
    std::vector<std::int64_t> sorted = values;
    const auto at = static_cast<std::ptrdiff_t>(std::ceil(kPart * static_cast<double>(sorted.size()))) - 1;
    std::nth_element(sorted.begin(), sorted.begin() + at, sorted.end());
    const auto high = static_cast<double>(std::max<std::int64_t>(sorted[static_cast<std::size_t>(at)], 1));
    const auto most = static_cast<double>(*std::max_element(values.begin(), values.end()));

    constexpr double kTicks = 5;
    const double power = std::pow(10, std::floor(std::log10(high / kTicks)));
    double step = power;
    for (const double factor : {2.0, 2.5, 5.0, 10.0})
        if (kTicks * step < high) step = factor * power;
    const int ticks = std::max(1, static_cast<int>(std::ceil(high / step * (1 - 1e-12))));
    return {step, ticks, most > step * ticks};
}

/// How a figure is written: divided by `divisor`, with `suffix` behind it, in `unit`.
struct Notation {
    double divisor;
    const char* suffix;
    const char* unit;
};

Notation notation(Cost cost, double top) {
    const int thousands = top < 1e4 ? 0 : top < 1e7 ? 1 : top < 1e10 ? 2 : 3;
    const double divisor = std::pow(1000, thousands);
    if (cost == Cost::Nanoseconds) {
        constexpr std::array<const char*, 4> kUnits{"ns", "us", "ms", "s"};  // the font shows u as the micro sign
        return {divisor, "", kUnits[static_cast<std::size_t>(thousands)]};
    }
    constexpr std::array<const char*, 4> kSuffixes{"", "k", "M", "G"};
    return {divisor, kSuffixes[static_cast<std::size_t>(thousands)], cost == Cost::Tests ? "tests" : "segments"};
}

void fill(Image& picture, std::int64_t x, std::int64_t y, std::int64_t width, std::int64_t height, const float* rgb) {
    for (std::int64_t row = y; row < y + height; ++row)
        for (std::int64_t column = x; column < x + width; ++column) std::copy_n(rgb, 3, picture.pixel(column, row));
}

constexpr float kInk[3] = {0, 0, 0};

/// From its left and upper edge on; a dot of the font is a square of `dot` pixels.
void write(Image& picture, std::int64_t x, std::int64_t y, std::int64_t dot, const std::string& text) {
    for (const char letter : text) {
        const Glyph& glyph = glyph_of(letter);
        for (int row = 0; row < kGlyphRows; ++row)
            for (int column = 0; column < kGlyphWidth; ++column)
                if (has_dot(glyph, column, row)) fill(picture, x + column * dot, y + row * dot, dot, dot, kInk);
        x += (kGlyphWidth + 1) * dot;
    }
}

}  // namespace

Image heat_map(const CostImage& cost) {
    const Scale scale = make_scale(cost.values);
    const Notation how = notation(cost.cost, scale.top());

    // Sizes, in pixels.
    constexpr std::int64_t kLeastHeight = 240;
    constexpr std::int64_t kMostMagnified = 1200;
    const std::int64_t square = std::max<std::int64_t>(
        1, std::min((kLeastHeight + cost.height - 1) / cost.height, kMostMagnified / cost.width));
    const std::int64_t height = std::max(kLeastHeight, cost.height * square);
    const std::int64_t dot = std::max<std::int64_t>(2, height / 400);
    const std::int64_t bar = cost.width * square + 6 * dot;
    const std::int64_t bar_width = 10 * dot;
    const std::int64_t tick_width = 3 * dot;
    const std::int64_t label = bar + bar_width + tick_width + 2 * dot;
    const std::int64_t line = (kGlyphHeight + 2) * dot;
    const std::int64_t bar_top = 2 * dot + 2 * line + kGlyphHeight * dot;
    const std::int64_t bar_bottom = height - kGlyphHeight * dot;

    Image picture(label + 8 * (kGlyphWidth + 1) * dot, height);
    std::fill(picture.rgb.begin(), picture.rgb.end(), 1.0F);
    for (std::int64_t y = 0; y < cost.height; ++y) {
        for (std::int64_t x = 0; x < cost.width; ++x) {
            float rgb[3];
            inferno(static_cast<double>(cost.values[static_cast<std::size_t>(y * cost.width + x)]) / scale.top(), rgb);
            fill(picture, x * square, y * square, square, square, rgb);
        }
    }

    for (std::int64_t y = bar_top; y < bar_bottom; ++y) {
        float rgb[3];
        inferno(static_cast<double>(bar_bottom - 1 - y) / static_cast<double>(bar_bottom - 1 - bar_top), rgb);
        fill(picture, bar, y, bar_width, 1, rgb);
    }
    for (int i = 0; i <= scale.ticks; ++i) {
        const std::int64_t y = bar_bottom - 1 - (bar_bottom - 1 - bar_top) * i / scale.ticks;
        fill(picture, bar + bar_width, y, tick_width, 1, kInk);
        const char* sign = i == scale.ticks && scale.is_clipped ? ">" : "";  // the font shows it as greater or equal
        write(picture, label, y - kGlyphHeight * dot / 2, dot,
              fmt::format("{}{:g}{}", sign, scale.step * i / how.divisor, i == 0 ? "" : how.suffix));
    }
    write(picture, bar, 2 * dot, dot, how.unit);
    write(picture, bar, 2 * dot + line, dot, "per pixel");
    return picture;
}

}  // namespace raypool
