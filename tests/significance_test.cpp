/// The decisions of tests/significance.h: known quantiles, and a fair and a loaded die.
#include "tests/significance.h"

#include <array>

#include <gtest/gtest.h>

#include "tests/random_inputs.h"

namespace raypool::test {
namespace {

TEST(Significance, KnowsTheQuantilesOfTheTables) {
    EXPECT_NEAR(p_value_of_chi_square(3.841459, 1), 0.05, 1e-7);
    EXPECT_NEAR(p_value_of_chi_square(18.307038, 10), 0.05, 1e-7);
    EXPECT_NEAR(p_value_of_chi_square(149.449253, 100), 0.001, 1e-8);
    EXPECT_NEAR(p_value_of_chi_square(2.0, 2), std::exp(-1.0), 1e-14);
    EXPECT_NEAR(p_value_of_z(1.959964), 0.05, 1e-7);
    EXPECT_NEAR(p_value_of_z(-2.575829), 0.01, 1e-7);
}

TEST(Significance, AsksMoreOfEachTestTheMoreTestsThereAre) {
    EXPECT_TRUE(is_significant(0.009, 1));
    EXPECT_FALSE(is_significant(0.011, 1));
    EXPECT_FALSE(is_significant(0.009, 2));
    EXPECT_TRUE(is_significant(0.00009, 100));
    EXPECT_FALSE(is_significant(0.00011, 100));
}

TEST(Significance, TellsALoadedDieFromAFairOne) {
    RandomInputs random(1);
    std::array<std::int64_t, 6> fair{};
    std::array<std::int64_t, 6> loaded{};
    for (int i = 0; i < 60'000; ++i) {
        ++fair[random.below(6)];
        ++loaded[random.one_in(50) ? 5 : random.below(6)];
    }
    EXPECT_FALSE(is_significant(p_value_of_uniform_counts(fair), 1));
    EXPECT_TRUE(is_significant(p_value_of_uniform_counts(loaded), 1));
}

TEST(Significance, FindsASmallCorrelation) {
    RandomInputs random(2);
    Correlation independent;
    Correlation related;
    for (int i = 0; i < 100'000; ++i) {
        const double x = random.uniform(0, 1);
        const double y = random.uniform(0, 1);
        independent.add(x, y);
        related.add(x, y + 0.02 * x);
    }
    EXPECT_FALSE(is_significant(independent.p_value(), 1));
    EXPECT_TRUE(is_significant(related.p_value(), 1));
    EXPECT_NEAR(related.value(), 0.02, 0.01);
}

}  // namespace
}  // namespace raypool::test
