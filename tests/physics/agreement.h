/// Whether an estimate agrees with what theory says, by the rules of tests/significance.h.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/significance.h"

namespace raypool {

/// More comparisons than this folder makes. Each may then be off by four standard errors.
inline constexpr int kComparisonCount = 250;

inline testing::AssertionResult estimate_agrees(double estimate, double standard_error, double expected) {
    const double off = (estimate - expected) / standard_error;
    const bool is_off = test::is_significant(test::p_value_of_z(off), kComparisonCount);
    return (is_off ? testing::AssertionFailure() : testing::AssertionSuccess())
           << estimate << " +- " << standard_error << " against " << expected << ": " << off << " standard errors off";
}

/// The mean of independent values against its expectation.
inline testing::AssertionResult mean_agrees(const std::vector<double>& values, double expected) {
    const auto count = static_cast<double>(values.size());
    double sum = 0;
    for (const double value : values) sum += value;
    const double mean = sum / count;
    double squares = 0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    return estimate_agrees(mean, std::sqrt(squares / (count - 1) / count), expected);
}

/// `successes` of `trials` against the chance of one.
inline testing::AssertionResult share_agrees(double successes, double trials, double chance) {
    return estimate_agrees(successes / trials, std::sqrt(chance * (1 - chance) / trials), chance);
}

}  // namespace raypool
