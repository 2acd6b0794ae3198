/// Statistics of error against time, on synthetic data whose truth is known.
#include "bench/accuracy/statistics.h"

#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace raypool::accuracy {
namespace {

constexpr std::size_t kValues = 30'000;

/// A wave of amplitude `bias` around 1, with noise of deviation `noise` in each value.
Values image(std::uint64_t seed, double noise, double bias = 0) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> chance(0, 1);
    Values values(kValues);
    for (std::size_t i = 0; i < kValues; ++i) values[i] = 1 + (i % 2 == 0 ? bias : -bias) + noise * chance(random);
    return values;
}

struct NoiseCase {
    const char* what;
    double image_noise, reference_noise, bias;
};
class NoiseCorrection : public testing::TestWithParam<NoiseCase> {};

TEST_P(NoiseCorrection, LeavesTheErrorOfTheImageAlone) {
    const NoiseCase& c = GetParam();
    const Halves reference{image(1, c.reference_noise), image(2, c.reference_noise)};
    const double truth = c.image_noise * c.image_noise + c.bias * c.bias;
    const double half_variance = 0.5 * c.reference_noise * c.reference_noise;
    EXPECT_NEAR(noise_of(reference), half_variance, 0.05 * half_variance);
    const Values x = image(3, c.image_noise, c.bias);
    EXPECT_NEAR(corrected_mse(x, reference), truth, 0.05 * (truth + half_variance)) << c.what;
    EXPECT_NEAR(mean_squared_difference(x, mean_of(reference)), truth + half_variance, 0.05 * (truth + half_variance));
}

INSTANTIATE_TEST_SUITE_P(Cases, NoiseCorrection,
                         testing::Values(NoiseCase{"a perfect reference", 0.5, 0, 0},
                                         NoiseCase{"a reference as noisy as the image", 0.5, 0.5, 0},
                                         NoiseCase{"a reference noisier than the image", 0.1, 0.5, 0},
                                         NoiseCase{"an image with a bias", 0.1, 0.2, 0.3},
                                         NoiseCase{"a bias alone", 0, 0.2, 0.3}),
                         [](const auto& info) { return std::to_string(info.index); });

TEST(MeanSquaredExpectation, FindsABiasFarBelowTheNoise) {
    for (const double bias : {0.0, 0.02, 0.1}) {
        std::vector<Values> samples;
        for (std::uint64_t seed = 1; seed <= 8; ++seed) {
            Values difference = image(seed, 0.3, bias);
            for (double& value : difference) value -= 1;
            samples.push_back(difference);
        }
        const Estimate found = mean_squared_expectation(samples);
        EXPECT_NEAR(found.value, bias * bias, 4 * found.error) << bias;
        EXPECT_GT(found.error, 0);
        EXPECT_LT(found.error, 3e-4) << "the square of the noise is 0.09";
    }
}

TEST(MeanSquaredExpectation, HasAStandardErrorThatIsTheSpreadOfItsEstimates) {
    std::vector<double> values;
    double claimed = 0;
    for (std::uint64_t trial = 0; trial < 60; ++trial) {
        std::vector<Values> samples;
        for (std::uint64_t i = 0; i < 6; ++i) {
            Values difference = image(100 * trial + i, 0.3, 0.05);
            difference.resize(1000);
            for (double& value : difference) value -= 1;
            samples.push_back(difference);
        }
        const Estimate found = mean_squared_expectation(samples);
        values.push_back(found.value);
        claimed += found.error / 60;
    }
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / 60;
    double squares = 0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    const double spread = std::sqrt(squares / 59);
    EXPECT_NEAR(mean, 0.05 * 0.05, 4 * spread / std::sqrt(60.0));
    EXPECT_NEAR(claimed / spread, 1, 0.5);
}

TEST(Variances, AreEachTheVarianceOfAnImageWithoutItsBias) {
    const std::vector<double> found = variances({image(1, 0.5, 0.3), image(2, 0.5, 0.3), image(3, 0.5, 0.3)});
    ASSERT_EQ(found.size(), 3);
    for (const double variance : found) EXPECT_NEAR(variance, 0.25, 0.01);
    const std::vector<double> pair = variances({image(1, 0.5), image(2, 0.5)});
    EXPECT_NEAR(pair[0], 0.5 * mean_squared_difference(image(1, 0.5), image(2, 0.5)), 1e-12);
}

TEST(LogLogSlope, IsTheExponent) {
    const std::vector<double> x{1, 4, 16, 64};
    std::vector<double> y;
    for (const double value : x) y.push_back(3 * std::pow(value, -0.75));
    EXPECT_NEAR(log_log_slope(x, y), -0.75, 1e-12);
}

TEST(StudentT, FallsToThatOfTheNormalDistribution) {
    for (std::size_t degrees = 1; degrees < 100; ++degrees) EXPECT_GT(student_t(degrees), student_t(degrees + 1));
    EXPECT_NEAR(student_t(9), 2.262, 1e-9);
    EXPECT_NEAR(student_t(30), 2.042, 0.005);
    EXPECT_NEAR(student_t(1'000'000), 1.96, 1e-4);
}

}  // namespace
}  // namespace raypool::accuracy
