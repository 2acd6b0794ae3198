/// Which configuration reaches a target on a scene in the least time: found by rendering the scene, not by rules.
///
/// Called by `raypool advise`. A pilot renders a small image of the scene in the trusted way (double, deep) and with
/// one simplification at a time, and measures what each costs in bias, in noise and in time. From these the few most
/// promising combinations are chosen, and each is rendered at the size that is asked for; what they then predict is the
/// advice. An error is the root mean square over channels and pixels against the converged image.
///
/// What is promised holds for light that no pilot has found too: a variance, and what a limit of depth cuts off, count
/// with their upper confidence limits (core/film/rare_events.h), which know how bright the scene's brightest light is.
/// Where pilots of a bounded time find too little light for that, nothing is promised.
///
/// Noise falls with the root of the samples; of Sobol points with the slope that was measured. Bias is taken from pairs
/// of images that share random numbers. Only float and a limit of depth have any: Sobol points, roulette and split
/// paths have the right expectation by construction (and by test), so theirs is measured but not charged.
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/accuracy/pilot.h"

namespace raypool::accuracy {

/// Pilots have found too little light for a promise.
class NothingPromised : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

struct AdviseOptions {
    int threads = 1;
    std::uint64_t seed = 0;  ///< of the pilots, which use none of the small numbers that users render with
    /// What a render costs, in seconds. Tests put a count in its place.
    std::function<double(const RenderReport&)> cost = [](const RenderReport& report) { return report.seconds; };
    Progress* progress = nullptr;  ///< counts the pilots that are done
};

/// One change to the trusted configuration, or to the one named, and what it does.
struct Simplification {
    std::string text;        ///< "float instead of double"
    Estimate bias;           ///< squared
    double unseen_bias = 0;  ///< Pilot's
    double time = 1;         ///< of a sample, over that of the unchanged
    double noise = 1;        ///< squared error of a sample, over that of the unchanged
};

struct Interval {
    double low = 0, high = 0;
};

/// A configuration with the samples that meet the target.
struct Offer {
    Pilot pilot;
    std::int64_t spp = 0;
    double seconds = 0;
    double error = 0;
    Interval error_interval;
    Interval seconds_interval;
};

struct Advice {
    Features features;  ///< what the scene needs
    std::int64_t width = 0, height = 0;
    std::int64_t pilot_width = 0, pilot_height = 0;
    int pilot_seeds = 0;
    std::vector<Simplification> simplifications;
    std::vector<Offer> offers;  ///< the best first; at least one
};

/// The number of pilots, for a progress bar: no more than this.
std::int64_t most_pilots();

/// The scene has the size that the image shall have. Throws InputError for a target that nothing meets, and
/// NothingPromised where pilots cannot tell.
Advice advise(const Scene& scene, const Target& target, const AdviseOptions& options);

}  // namespace raypool::accuracy
