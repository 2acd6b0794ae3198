/// How a render is cut into what ranks take at a time: large units first and small ones last. Pure.
#pragma once

#include <cstdint>
#include <vector>

#include "core/sums_file.h"

namespace raypool::cluster {

/// Some samples of places [first_place, end_place): of pixels, in the order of the image or of a list.
struct WorkUnit {
    SampleRange samples;
    std::int64_t first_place;
    std::int64_t end_place;
    bool operator==(const WorkUnit&) const = default;

    [[nodiscard]] std::int64_t paths() const { return (samples.end - samples.first) * (end_place - first_place); }
};

/// So many units make a rank's equal share of the paths that are left. A rank holds two of them, the one at hand and the
/// one after it, and at a quarter of the others' speed it shall be done with both before they have done all the rest.
inline constexpr int kUnitsAShare = 6;
/// But no less than this many paths, some ten milliseconds of a thread: a unit costs a message, a start of all threads,
/// and the filling and draining of the pools.
inline constexpr std::int64_t kLeastUnitPaths = 1 << 14;

/// Cuts up `samples` of `places`, every one of them into exactly one unit: whole samples of all places while such are
/// small enough, because all samples cost the same; then, of the last ones, parts of the image.
std::vector<WorkUnit> work_units(const SampleRange& samples, std::int64_t places, int ranks);

}  // namespace raypool::cluster
