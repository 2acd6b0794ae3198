/// Confidence limits for sums of rare, large contributions: what samples can tell of light that few or none have found.
///
/// A sum of independent terms, each within [0, 1], is no more likely to fall far below its expectation, or far above
/// it, than a Poisson variable of that expectation. The limits are Chernoff's for that variable, relaxed to square
/// roots, which every machine rounds alike. Nothing is taken to be normal, and nothing seen is not taken for zero:
/// where the sum is 0 its expectation is at most kLogOdds (that of 95 % in place of 99 % is the "rule of three"). Terms
/// within [0, b] are counted in units of b.
#pragma once

#include <cmath>

namespace raypool {

/// Each limit is kept with a probability of at least 1 - exp(-kLogOdds) = 99 %.
inline constexpr double kLogOdds = 4.605170185988092;

/// The greatest expectation of a sum that came out as `seen` (>= 0).
/// With m = seen + sqrt(2 c seen) + c: m - seen - seen ln(m / seen) >= c, since exp(t) >= 1 + t + t^2 / 2.
inline double greatest_expectation(double seen) {
    return seen + std::sqrt(2 * kLogOdds * seen) + kLogOdds;
}

/// The greatest outcome of a sum of expectation `expected` (>= 0). After Bernstein.
inline double greatest_outcome(double expected) {
    return expected + std::sqrt(2 * kLogOdds * expected) + kLogOdds / 3;
}

}  // namespace raypool
