#include "cluster/work_units.h"

#include <algorithm>

namespace raypool::cluster {

namespace {
/// So many samples of a pixel one after the other go through the same parts of the trees, while they are in the cache:
/// by one sample at a time, a path took 7 to 14 % longer.
constexpr std::int64_t kDeepSamples = 64;
/// But a unit is no smaller a part of the image than this: its lines are for all threads of a rank.
constexpr std::int64_t kPartsOfImage = 8;
}  // namespace

std::vector<WorkUnit> work_units(const SampleRange& samples, std::int64_t places, int ranks) {
    std::vector<WorkUnit> units;
    std::int64_t left = (samples.end - samples.first) * places;
    const auto wanted_paths = [&] { return std::max(kLeastUnitPaths, left / (kUnitsAShare * ranks)); };
    const auto add = [&](const WorkUnit& unit) {
        units.push_back(unit);
        left -= unit.paths();
    };
    for (std::int64_t sample = samples.first; sample < samples.end;) {
        const std::int64_t wanted = wanted_paths();
        std::int64_t deep = wanted / places;
        if (deep < kDeepSamples) deep = std::clamp<std::int64_t>(kPartsOfImage * wanted / places, 1, kDeepSamples);
        const SampleRange range{sample, std::min(sample + deep, samples.end)};
        const std::int64_t depth = range.end - range.first;
        for (std::int64_t place = 0; place < places; place = units.back().end_place)
            add({range, place, std::min(place + wanted_paths() / depth, places)});
        sample = range.end;
    }
    return units;
}

}  // namespace raypool::cluster
