/// Where a pool begins to beat recursion, from its ratio at each capacity that was measured.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/studies/statistics.h"

namespace raypool::studies {

struct AtCapacity {
    std::int64_t capacity;
    Spread ratio;  ///< rate over that of recursion
};

struct Crossover {
    std::optional<std::int64_t> from;       ///< the smallest capacity that beats recursion; nothing: none does
    std::vector<std::int64_t> lost_beyond;  ///< larger ones that do not
};

/// To beat recursion is to be faster than it in every run. Capacities must ascend.
inline Crossover crossover(const std::vector<AtCapacity>& measured) {
    Crossover found;
    for (const auto& [capacity, ratio] : measured) {
        const bool beats = ratio.low > 1;
        if (beats && !found.from) found.from = capacity;
        if (!beats && found.from) found.lost_beyond.push_back(capacity);
    }
    return found;
}

/// "never", "256", "256, but not 16384, 65536"
inline std::string to_text(const Crossover& found) {
    if (!found.from) return "never";
    return found.lost_beyond.empty() ? fmt::format("{}", *found.from)
                                     : fmt::format("{}, but not {}", *found.from, fmt::join(found.lost_beyond, ", "));
}

}  // namespace raypool::studies
