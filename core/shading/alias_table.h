/// Choosing one of many by given shares, with two random numbers: the alias method (Vose, "A Linear Algorithm for
/// Generating Random Numbers with a Given Distribution", 1991).
///
/// The first number draws an entry, each with the same chance; the second keeps it or takes its alias. Random numbers
/// are multiples of 2^-24, and products are rounded: so that a density is exact, chances are counted, not assumed.
#pragma once

#include <cstddef>
#include <vector>

#include "core/math/real.h"

namespace raypool {

/// Kept with the probability `threshold`, a multiple of 2^-24; else it makes place for the entry `alias`.
struct AliasEntry {
    double threshold = 1;
    std::size_t alias = 0;
};

/// Of shares that add up to 1. What has the share 0 is never chosen.
std::vector<AliasEntry> alias_table(std::vector<double> shares);

/// Which of `count` entries a number in [0, 1) draws.
template <class Real>
RAYPOOL_INLINE Int<Real> draw_entry(const Real& random, ScalarOf<Real> count) {
    return to_int<Real>(min(floor(random * Real(count)), Real(count - 1)));
}

/// With which probability draw_entry() draws each of `count` entries.
template <class Scalar>
std::vector<double> draw_chances(std::size_t count);

/// With which probability each entry is chosen, where draw_entry() draws it with those of `drawn`.
std::vector<double> alias_chances(const std::vector<AliasEntry>& table, const std::vector<double>& drawn);

extern template std::vector<double> draw_chances<float>(std::size_t);
extern template std::vector<double> draw_chances<double>(std::size_t);

}  // namespace raypool
