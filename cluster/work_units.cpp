#include "cluster/work_units.h"

#include <algorithm>

namespace raypool::cluster {

std::vector<WorkUnit> work_units(const SampleRange& samples, std::int64_t places, int ranks) {
    std::vector<WorkUnit> units;
    std::int64_t left = (samples.end - samples.first) * places;
    const auto wanted_paths = [&] { return std::max(kLeastUnitPaths, left / (kUnitsAShare * ranks)); };
    const auto add = [&](const WorkUnit& unit) {
        units.push_back(unit);
        left -= unit.paths();
    };
    for (std::int64_t sample = samples.first; sample < samples.end;) {
        const std::int64_t whole = std::min(wanted_paths() / places, samples.end - sample);
        if (whole > 0) {
            add({{sample, sample + whole}, 0, places});
            sample += whole;
            continue;
        }
        for (std::int64_t place = 0; place < places; place = units.back().end_place)
            add({{sample, sample + 1}, place, std::min(place + wanted_paths(), places)});
        ++sample;
    }
    return units;
}

}  // namespace raypool::cluster
