/// Russian roulette as programs often have it.
#pragma once

#include <algorithm>

namespace raypool::naive {

/// The chance to go on that is capped from above: a path that loses next to nothing is killed all the same, and those
/// that live are blown up. With an albedo a and a cap below a^2 the variance of a long path has no bound.
inline double capped_survival(double throughput) {
    return std::min(0.95, throughput);
}

}  // namespace raypool::naive
