/// Sobol's points: the published sequence, its evenness after shuffling and scrambling, and what it buys.
#include "core/math/sobol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/math/random.h"
#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

using Point = std::array<double, sobol::kDimensions>;

TEST(Sobol, BeginsAsPublished) {
    // Joe and Kuo's program lists the points in the order of Gray's code: number i there is i ^ (i >> 1) here.
    const Point published[] = {
        {0, 0, 0, 0}, {.5, .5, .5, .5}, {.75, .25, .25, .25}, {.25, .75, .75, .75}, {.375, .375, .625, .875}};
    for (std::uint32_t i = 0; i < 5; ++i) {
        for (int d = 0; d < sobol::kDimensions; ++d) {
            std::uint32_t reversed = d == 0 ? i ^ i >> 1U : 0;
            for (int bit = 0; d > 0 && bit < 32; ++bit)
                if (((i ^ i >> 1U) >> bit & 1U) != 0) reversed ^= sobol::kDirections[d - 1].reversed[bit];
            EXPECT_EQ(sobol::reversed_bits<std::uint32_t>(reversed) * 0x1p-32, published[i][d]) << i << ' ' << d;
        }
    }
}

TEST(Sobol, ScramblingLetsABitDependOnItselfAndLowerOnes) {
    RandomInputs random(1);
    for (int i = 0; i < kInputs / 100; ++i) {
        const std::uint32_t x = random.word(), key = random.word();
        const std::uint32_t image = sobol::scrambled_reversed<std::uint32_t>(x, key);
        for (int bit = 0; bit < 32; ++bit) {
            const std::uint32_t other = sobol::scrambled_reversed<std::uint32_t>(x ^ 1U << bit, key);
            ASSERT_EQ(std::countr_zero(image ^ other), bit) << x << ' ' << key;
        }
    }
}

/// What a render draws.
Point point_of(std::uint32_t pixel, std::uint32_t sample, std::uint32_t step, const RandomSeed& seed) {
    const std::array<double, 4> drawn = random_block<double>({pixel, sample}, step, RandomPurpose::Scatter, seed);
    return {drawn[0], drawn[1], drawn[2], drawn[3]};
}

/// Whether each box of 2^-digits[d] along dimension d holds equally many of the points, which are 2^quality times as
/// many as the boxes.
bool fill_boxes_evenly(const std::vector<Point>& points, const std::array<int, 4>& digits, int quality) {
    std::vector<int> counts(points.size() >> quality);
    for (const Point& point : points) {
        std::size_t box = 0;
        for (int d = 0; d < sobol::kDimensions; ++d)
            box = (box << digits[d]) + static_cast<std::size_t>(std::ldexp(point[d], digits[d]));
        ++counts[box];
    }
    return std::ranges::all_of(counts, [&](int count) { return count == 1 << quality; });
}

/// Dimensions and the t of the (t, s)-sequence that they are: by Niederreiter, the sum of the degrees less one of the
/// polynomials, which are of degree 1, 2 and 3 for dimensions 1, 2 and 3.
struct Projection {
    std::vector<int> dimensions;
    int quality;
};
const std::vector<Projection> kProjections{{{0}, 0},    {{1}, 0},    {{2}, 0},       {{3}, 0},
                                           {{0, 1}, 0}, {{0, 2}, 1}, {{0, 3}, 2},    {{1, 2}, 1},
                                           {{1, 3}, 2}, {{2, 3}, 3}, {{0, 1, 2}, 1}, {{0, 1, 2, 3}, 3}};

/// Calls visit(digits) with every way to share out `total` digits among `dimensions`.
void for_every_shape(const std::vector<int>& dimensions, int total, std::array<int, 4> digits, std::size_t next,
                     const std::function<void(const std::array<int, 4>&)>& visit) {
    const auto dimension = static_cast<std::size_t>(dimensions[next]);
    if (next + 1 == dimensions.size()) {
        digits[dimension] = total;
        return visit(digits);
    }
    for (int i = 0; i <= total; ++i) {
        digits[dimension] = i;
        for_every_shape(dimensions, total - i, digits, next + 1, visit);
    }
}

TEST(SobolSampler, FillsEveryElementaryIntervalOfEveryPowerOfTwoEvenly) {
    struct Key {
        std::uint32_t pixel, step, run;
        std::uint64_t seed;
    };
    // The run counts sets of 2^k samples: each of them is even, not only the first.
    for (const Key& key : {Key{0, 0, 0, 0}, {1, 0, 0, 0}, {12345, 7, 0, 1}, {0xffffffffU, 51, 0, 2}, {99, 2, 5, 3}}) {
        const RandomSeed seed = random_seed(key.seed, Sampler::Sobol);
        for (int log_count = 0; log_count <= 10; ++log_count) {
            const std::uint32_t count = 1U << log_count;
            std::vector<Point> points;
            for (std::uint32_t i = 0; i < count; ++i)
                points.push_back(point_of(key.pixel, key.run * count + i, key.step, seed));
            for (const Projection& projection : kProjections) {
                if (log_count < projection.quality) continue;
                for_every_shape(projection.dimensions, log_count - projection.quality, {}, 0,
                                [&](const std::array<int, 4>& digits) {
                                    ASSERT_TRUE(fill_boxes_evenly(points, digits, projection.quality))
                                        << "pixel " << key.pixel << ", 2^" << log_count << " points, digits "
                                        << digits[0] << ' ' << digits[1] << ' ' << digits[2] << ' ' << digits[3];
                                });
            }
        }
    }
}

TEST(SobolSampler, StaysBelowOne) {
    const RandomSeed seed = random_seed(0, Sampler::Sobol);
    float most = 0;
    for (std::uint32_t i = 0; i < kInputs; ++i)
        for (const float number : random_block<float>({i % 3, i}, 0, RandomPurpose::Film, seed))
            most = std::max(most, number);
    EXPECT_LT(most, 1);
    EXPECT_GT(most, 1 - 10.0F / kInputs);
}

/// The slope of log RMSE against log N of the mean of N samples, over many pixels.
double rmse_slope(Sampler sampler, const std::function<double(const Point&)>& f, double expected) {
    constexpr std::uint32_t kPixels = 200;
    double sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0, n = 0;
    for (int log_count = 4; log_count <= 12; log_count += 2) {
        const std::uint32_t count = 1U << log_count;
        double squares = 0;
        for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
            double sum = 0;
            for (std::uint32_t i = 0; i < count; ++i) sum += f(point_of(pixel, i, 2, random_seed(1, sampler)));
            squares += std::pow(sum / count - expected, 2);
        }
        const double x = log_count, y = std::log2(std::sqrt(squares / kPixels));
        sum_x += x, sum_y += y, sum_xx += x * x, sum_xy += x * y, ++n;
    }
    return (sum_xy - sum_x * sum_y / n) / (sum_xx - sum_x * sum_x / n);
}

double edge(const Point& p) {
    return p[0] * p[0] + p[1] * p[1] < 0.5 ? 1 : 0;
}
constexpr double kEdge = std::numbers::pi / 8;
double smooth(const Point& p) {
    return std::exp(p[0]) * std::cos(p[1]);
}
const double kSmooth = (std::numbers::e - 1) * std::sin(1.0);

TEST(IndependentSampler, HasAnErrorOfTheSquareRoot) {
    EXPECT_NEAR(rmse_slope(Sampler::Independent, edge, kEdge), -0.5, 0.1);
    EXPECT_NEAR(rmse_slope(Sampler::Independent, smooth, kSmooth), -0.5, 0.1);
}
TEST(SobolSampler, HasAnErrorThatFallsFasterAcrossAnEdgeAndFasterStillWhereAllIsSmooth) {
    EXPECT_NEAR(rmse_slope(Sampler::Sobol, edge, kEdge), -0.74, 0.1);
    EXPECT_NEAR(rmse_slope(Sampler::Sobol, smooth, kSmooth), -1.43, 0.1);
}

/// Variance of the mean of f over a pixel's samples, times their number. f gets a number of each of three steps.
double variance_of_mean(std::uint32_t samples, const std::function<double(double, double, double)>& f) {
    constexpr std::uint32_t kPixels = 2000;
    const RandomSeed seed = random_seed(7, Sampler::Sobol);
    double sum = 0, squares = 0;
    for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
        double mean = 0;
        for (std::uint32_t i = 0; i < samples; ++i)
            mean += f(point_of(pixel, i, 0, seed)[0], point_of(pixel, i, 1, seed)[1], point_of(pixel, i, 2, seed)[2]);
        mean /= samples;
        sum += mean, squares += mean * mean;
    }
    return samples * (squares / kPixels - std::pow(sum / kPixels, 2));
}

// As docs/sampling.md tells. Samples 2k and 2k + 1 lie in opposite halves in every block, since each two of them are
// even. So the product of the signs of a number in two blocks is the same for both of them, and its mean over n samples
// has twice the variance of n independent ones; with the finer digits a product of numbers comes to 1.58. The product
// of three signs is opposite, and sums to nothing.
TEST(SobolSampler, EvensEachBlockAndMakesProductsOfTwoBlocksNoisierThanIndependentNumbersWould) {
    for (const std::uint32_t samples : {16U, 64U, 256U}) {
        const auto two = [](double x, double y, double) { return (x - 0.5) * (y - 0.5); };
        EXPECT_NEAR(variance_of_mean(samples, two) * 144, 1.58, 0.16) << samples;
        const auto three = [](double x, double y, double z) { return (x - 0.5) * (y - 0.5) * (z - 0.5); };
        EXPECT_NEAR(variance_of_mean(samples, three) * 1728, 0.57, 0.06) << samples;
        const auto whole = [](double x, double y, double) { return x * y; };
        EXPECT_NEAR(variance_of_mean(samples, whole) * 144 / 7, 0.23, 0.03) << samples;
    }
}

}  // namespace
}  // namespace raypool::test
