/// The simplifications that advice tries one at a time, and the configuration that they start from.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/accuracy/configuration.h"

namespace raypool::accuracy {

/// What a change is a change of. Groups are combined in this order, at most one change of each.
enum class Group : std::uint8_t { Precision, Engine, Sampler, Roulette, Split, Depth };

/// One simplification: of the trusted configuration where it is of the precision, else of its twin in float.
struct Change {
    std::string text;
    Group group;
    std::function<void(Configuration&)> apply;

    [[nodiscard]] Configuration applied(Configuration to) const {
        apply(to);
        return to;
    }
};

/// The trusted configuration for a scene: as deep as it takes until nothing is left of a path's throughput, and not so
/// deep as to follow paths in a closed room on and on.
Configuration trusted_for(const CompiledScene<double>& scene);

/// The first is that to float.
std::vector<Change> changes(bool has_glass, const Configuration& trusted);

}  // namespace raypool::accuracy
