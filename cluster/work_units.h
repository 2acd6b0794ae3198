/// How a render is cut into what ranks take at a time: large units first and small ones last. Pure.
#pragma once

#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/film/checkpoint.h"

namespace raypool::cluster {

/// Lines in an order of which any stretch lies evenly over the image, since cheap and dear lines lie together: each is
/// a golden section of the height behind the one before.
class SpreadLines {
  public:
    explicit SpreadLines(std::int64_t height)
        : height_(height), step_(std::llround(0.618034 * static_cast<double>(height))) {
        while (std::gcd(step_, height_) != 1) ++step_;
    }
    [[nodiscard]] std::int64_t line(std::int64_t i) const { return i * step_ % height_; }

  private:
    std::int64_t height_;
    std::int64_t step_;
};

/// Some samples of places [first_place, end_place): of pixels, in the order of a list, or of spread lines.
struct WorkUnit {
    SampleRange samples;
    std::int64_t first_place;
    std::int64_t end_place;
    bool operator==(const WorkUnit&) const = default;

    [[nodiscard]] std::int64_t paths() const { return (samples.end - samples.first) * (end_place - first_place); }
};

/// So many units make a rank's equal share of the paths that are left. A rank holds two of them, the one at hand and
/// the one after it, and at a quarter of the others' speed it shall be done with both before they have done all the
/// rest.
inline constexpr int kUnitsAShare = 6;
/// But no less than this many paths, some five milliseconds of a thread: a unit costs a message, a start of all
/// threads, and the filling and draining of the pools.
inline constexpr std::int64_t kLeastUnitPaths = 1 << 14;

/// Cuts up `samples` of `places`, every one of them into exactly one unit: many samples of parts of the image, which is
/// faster than few of all of it, and parts that spread over it cost nearly alike.
std::vector<WorkUnit> work_units(const SampleRange& samples, std::int64_t places, int ranks);

}  // namespace raypool::cluster
