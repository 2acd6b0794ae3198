/// What is known of a configuration from small renders of it, and what that foretells of a large one.
///
/// What is promised, and why, stands in advise.h. Pure functions.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "bench/accuracy/configuration.h"
#include "bench/accuracy/statistics.h"

namespace raypool::accuracy {

/// More samples a pixel than this no render takes.
inline constexpr std::int64_t kMostSpp = std::numeric_limits<std::int32_t>::max();

/// One of the two.
struct Target {
    std::optional<double> error;    ///< RMSE, > 0: no more than this, in the least time
    std::optional<double> seconds;  ///< of the render, > 0: the least error in no more than this
};

/// What renders of one configuration told.
struct Pilot {
    Configuration configuration;
    std::int64_t spp = 0;
    std::vector<double> mse;      ///< of an image of spp samples that is due to chance, seed by seed
    std::vector<double> seconds;  ///< for such an image, seed by seed
    double slope = -1;            ///< of the MSE by samples: -1 for independent points
    Estimate bias;                ///< squared
    /// What light that no pilot has found may add to the bias: radiance, taken to lie as evenly over the image as what
    /// was found.
    double unseen_bias = 0;
    /// Squared error of an image of one sample a pixel of which a single one is as bright as the scene allows.
    double greatest_share = 0;

    /// Whether the pilot found so much light that its noise is known to a factor of two at least.
    [[nodiscard]] bool is_noise_known() const;
    /// With how many samples a pixel it would be known, if they find as much; infinity where nothing was found.
    [[nodiscard]] double known_spp() const;
    /// The greatest expectation of the MSE due to chance, over that which was found.
    [[nodiscard]] double most_noise(double samples) const;
    [[nodiscard]] double noise(double samples) const;        ///< MSE due to chance
    [[nodiscard]] double most_error(double samples) const;   ///< RMSE that 39 of 40 images stay below, at least
    [[nodiscard]] double least_error(double samples) const;  ///< RMSE that 39 of 40 stay above
    [[nodiscard]] double error(double samples) const;        ///< RMSE to be expected
    [[nodiscard]] double seconds_of(double samples) const;   ///< median
    [[nodiscard]] double bias_squared() const;               ///< what is charged
};

/// The samples with which a pilot's configuration meets the target, at least 1; nothing where it cannot.
std::optional<std::int64_t> samples_for(const Pilot& pilot, const Target& target);

}  // namespace raypool::accuracy
