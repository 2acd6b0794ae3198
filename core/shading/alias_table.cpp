#include "core/shading/alias_table.h"

#include <cmath>

namespace raypool {

namespace {

constexpr double kRandomSteps = 1 << 24;  ///< random numbers are multiples of 2^-24

/// The number of random numbers that draw an entry before `entry`.
template <class Scalar>
double steps_before(std::size_t entry, std::size_t count) {
    if (entry == count) return kRandomSteps;
    const auto drawn = [count](double step) {  // as draw_entry() does, whose product is rounded
        return std::floor(static_cast<Scalar>(step / kRandomSteps) * static_cast<Scalar>(count));
    };
    const auto first = static_cast<double>(entry);
    double step = std::ceil(first * kRandomSteps / static_cast<double>(count));
    while (step > 0 && drawn(step - 1) >= first) --step;
    return step;
}

}  // namespace

std::vector<AliasEntry> alias_table(std::vector<double> shares) {
    const std::size_t count = shares.size();
    std::vector<AliasEntry> table(count);
    std::vector<std::size_t> poor;
    std::vector<std::size_t> rich;
    for (std::size_t i = 0; i < count; ++i) {
        shares[i] *= static_cast<double>(count);
        table[i].alias = i;
        (shares[i] < 1 ? poor : rich).push_back(i);
    }
    while (!poor.empty() && !rich.empty()) {
        const std::size_t filled = poor.back();
        poor.pop_back();
        const std::size_t giver = rich.back();
        table[filled] = {shares[filled], giver};
        shares[giver] -= 1 - shares[filled];
        if (shares[giver] < 1) {
            rich.pop_back();
            poor.push_back(giver);
        }
    }
    // What is left is 1 to rounding. Random numbers go by steps, and a threshold of whole steps is met exactly.
    for (AliasEntry& entry : table) entry.threshold = std::round(entry.threshold * kRandomSteps) / kRandomSteps;
    return table;
}

template <class Scalar>
std::vector<double> draw_chances(std::size_t count) {
    std::vector<double> chances(count);
    double before = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double end = steps_before<Scalar>(i + 1, count);
        chances[i] = (end - before) / kRandomSteps;
        before = end;
    }
    return chances;
}

std::vector<double> alias_chances(const std::vector<AliasEntry>& table, const std::vector<double>& drawn) {
    std::vector<double> chances(table.size());
    for (std::size_t i = 0; i < table.size(); ++i) {
        chances[i] += drawn[i] * table[i].threshold;
        chances[table[i].alias] += drawn[i] * (1 - table[i].threshold);
    }
    return chances;
}

template std::vector<double> draw_chances<float>(std::size_t);
template std::vector<double> draw_chances<double>(std::size_t);

}  // namespace raypool
