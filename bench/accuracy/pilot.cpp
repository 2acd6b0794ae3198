#include "bench/accuracy/pilot.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/film/rare_events.h"

namespace raypool::accuracy {

namespace {

constexpr double kTimeMargin = 0.9;  ///< part of a budget of time that is planned
/// The slope of Sobol samples is a measured one, and what is foretold by it less sure than by the -1 of independent
/// ones.
constexpr double kSobolMargin = 1.25;

/// How far the squared error of one more image may lie from the mean of the pilot's: relative, 39 of 40.
double spread(const std::vector<double>& mse) {
    const double centre = mean(mse);
    if (centre == 0) return 0;
    double squares = 0;
    for (const double m : mse) squares += (m - centre) * (m - centre);
    const auto n = static_cast<double>(mse.size());
    return student_t(mse.size() - 1) * std::sqrt(squares / (n - 1) * (1 + 1 / n)) / centre;
}

}  // namespace

double Pilot::noise(double samples) const {
    return mean(mse) * std::pow(samples / static_cast<double>(spp), slope);
}
/// The greatest expectation of the variance of a sample, over that of the pilot.
double Pilot::most_noise(double samples) const {
    const double found = mean(mse) * static_cast<double>(spp);
    const double share = greatest_share / static_cast<double>(spp * static_cast<std::int64_t>(mse.size()));
    if (share == 0) return noise(samples);
    const double most = share * greatest_expectation(found / share);
    return found > 0 ? noise(samples) * (most / found) : most / samples;
}
bool Pilot::is_noise_known() const {
    const auto samples = static_cast<double>(spp);
    return most_noise(samples) <= 2 * noise(samples);
}
double Pilot::known_spp() const {
    // x + sqrt(2 c x) + c <= 2 x from x = c (2 + sqrt(3)) on.
    const double least_found = kLogOdds * (2 + std::sqrt(3.0));
    const double found_by_one = mean(mse) * static_cast<double>(spp) * static_cast<double>(mse.size()) / greatest_share;
    return least_found / found_by_one;
}
double Pilot::bias_squared() const {
    const double charged = std::sqrt(std::max(0.0, bias.value + 2 * bias.error)) + unseen_bias;
    return charged * charged;
}
double Pilot::error(double samples) const {
    return std::sqrt(std::max(0.0, bias.value) + noise(samples));
}
double Pilot::most_error(double samples) const {
    // Two limits: by how much images of the pilot differed, and by how much a single sample can make an image differ.
    const double share = greatest_share / (samples * samples);
    const double expected = most_noise(samples);
    const double with_rare_light = share > 0 ? share * greatest_outcome(expected / share) : expected;
    return std::sqrt(bias_squared() + std::max(noise(samples) * (1 + spread(mse)), with_rare_light));
}
double Pilot::least_error(double samples) const {
    return std::sqrt(std::max(0.0, bias.value - 2 * bias.error) + noise(samples) * std::max(0.0, 1 - spread(mse)));
}
double Pilot::seconds_of(double samples) const {
    return median(seconds) * samples / static_cast<double>(spp);
}

std::optional<std::int64_t> samples_for(const Pilot& pilot, const Target& target) {
    double samples = 0;
    if (target.error) {
        const double left = *target.error * *target.error - pilot.bias_squared();
        if (left <= 0) return {};
        double most = mean(pilot.mse) * (1 + spread(pilot.mse));
        if (pilot.configuration.sampler == Sampler::Sobol) most *= kSobolMargin;
        samples = std::ceil(static_cast<double>(pilot.spp) * std::pow(left / most, 1 / pilot.slope));
    } else {
        samples = std::floor(kTimeMargin * *target.seconds / pilot.seconds_of(1));
        if (samples < 1) return {};
        samples = std::min(samples, static_cast<double>(kMostSpp));
    }
    // Where light is rare the limit of the error falls in another way than noise does.
    while (target.error && samples <= static_cast<double>(kMostSpp) &&
           pilot.most_error(samples) > *target.error * (1 + 1e-12))
        samples = std::ceil(samples * 1.02);
    if (!(samples <= static_cast<double>(kMostSpp))) return {};
    const auto spp = std::max<std::int64_t>(1, static_cast<std::int64_t>(samples));
    if (pilot.configuration.sampler == Sampler::Independent) return spp;
    // Between powers of two Sobol points are worse than a line through those foretells.
    const auto power = static_cast<std::uint64_t>(spp);
    const auto rounded = static_cast<std::int64_t>(target.error ? std::bit_ceil(power) : std::bit_floor(power));
    return rounded <= kMostSpp ? std::optional(rounded) : std::nullopt;
}

}  // namespace raypool::accuracy
