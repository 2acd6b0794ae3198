#include "bench/accuracy/advise.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/film/rare_events.h"
#include "core/runtime/settings_text.h"
#include "core/scene/features.h"

namespace raypool::accuracy {

namespace {

constexpr int kSeeds = 8;
constexpr std::int64_t kPilotSpp = 16;  ///< more where light is rare, fewer where paths are long
/// What all pilots of single changes may take, in the seconds of AdviseOptions::cost, and the number of images that
/// they render, in units of the first.
constexpr double kSecondsOfPilots = 30;
constexpr double kPilotsInUnits = 6;
constexpr std::int64_t kPilotPixels = 6000;
constexpr std::size_t kOffers = 3;
/// What the closer look at an offer may take, in the seconds of AdviseOptions::cost.
constexpr double kSecondsPerOffer = 1.5;
/// And where light is rare.
constexpr double kMostSecondsPerOffer = 8;
constexpr double kTimeMargin = 0.9;  ///< part of a budget of time that is planned
constexpr std::int64_t kMostSpp = std::numeric_limits<std::int32_t>::max();
constexpr int kDepths[] = {3, 5, 8, 12, 20, 50, 200};

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

/// How far the squared error of one more image may lie from the mean of the pilot's: relative, 39 of 40.
double spread(const std::vector<double>& mse) {
    const double centre = mean(mse);
    if (centre == 0) return 0;
    double squares = 0;
    for (const double m : mse) squares += (m - centre) * (m - centre);
    const auto n = static_cast<double>(mse.size());
    return student_t(mse.size() - 1) * std::sqrt(squares / (n - 1) * (1 + 1 / n)) / centre;
}

/// A configuration without one thing: the trusted one and its float twin, and what is changed in that.
struct Change {
    std::string text;
    Configuration before, after;
    bool has_bias;
};

Configuration with(Configuration c, const std::function<void(Configuration&)>& change) {
    change(c);
    return c;
}

/// The trusted configuration for a scene: as deep as it takes until nothing is left of a path's throughput, and not so
/// deep as to follow paths in a closed room on and on.
Configuration trusted_for(const CompiledScene<double>& scene) {
    constexpr double kNothing = 1e-12;
    Configuration trusted = kTrusted;
    const double deepest = std::ceil(std::log(kNothing) / std::log(std::min(scene.max_albedo, 1 - 1e-9)));
    trusted.depth = static_cast<std::int32_t>(std::clamp<double>(deepest, kDepths[0], kDeep));
    return trusted;
}

std::vector<Change> changes(bool has_glass, const Configuration& trusted) {
    const Configuration in_float = with(trusted, [](auto& c) { c.precision = Precision::Float; });
    std::vector<Change> all{{"float instead of double", trusted, in_float, true},
                            {"recursion instead of the pool", in_float,
                             with(in_float, [](auto& c) { c.engine = EngineKind::Recursive; }), false}};
    for (const int depth : kDepths)
        if (depth < trusted.depth)
            all.push_back({fmt::format("depth {} instead of {}", depth, trusted.depth), in_float,
                           with(in_float, [=](auto& c) { c.depth = depth; }), true});
    all.push_back({"Sobol points instead of independent ones", in_float,
                   with(in_float, [](auto& c) { c.sampler = Sampler::Sobol; }), false});
    all.push_back({"roulette", in_float, with(in_float, [](auto& c) { c.roulette = true; }), false});
    for (int split = 1; has_glass && split <= 2; ++split)
        all.push_back({fmt::format("both branches of the first {} hit{} on glass", split, split == 1 ? "" : "s"),
                       in_float, with(in_float, [=](auto& c) { c.split_depth = split; }), false});
    return all;
}

/// Renders for a pilot.
class Piloting {
  public:
    Piloting(const SceneInBoth& scene, const AdviseOptions& options) : scene_(scene), options_(options) {}

    /// `images` receives the images, where it is wanted.
    Pilot run(const Configuration& configuration, std::int64_t spp, std::vector<Values>* images = nullptr) const {
        Pilot pilot{configuration, spp, {}, {}, slope(configuration, spp), {}, 0, greatest_share()};
        std::vector<Values> made = render(configuration, spp, pilot.seconds);
        pilot.mse = variances(made);
        if (images != nullptr) *images = std::move(made);
        if (options_.progress != nullptr) ++options_.progress->paths;
        return pilot;
    }

    /// Of the samples of all seeds together.
    [[nodiscard]] double sample_count(std::int64_t spp) const {
        return static_cast<double>(kSeeds * spp * scene_.pixel_count());
    }

  private:
    [[nodiscard]] double greatest_share() const {
        const double brightest = scene_.in_double.max_radiance;
        return brightest * brightest / static_cast<double>(scene_.pixel_count());
    }

    std::vector<Values> render(const Configuration& configuration, std::int64_t spp,
                               std::vector<double>& seconds) const {
        std::vector<Values> images;
        for (int i = 0; i < kSeeds; ++i) {
            const std::uint64_t seed = 0xad51ce0000000000U + 1000 * options_.seed + static_cast<std::uint64_t>(i);
            TimedImage made = render_image(configuration, scene_, {0, spp, seed, options_.threads});
            seconds.push_back(options_.cost(made.report));
            images.push_back(std::move(made.values));
        }
        return images;
    }

    /// Of the squared error of Sobol points between a quarter of the samples and all: what a pilot of few samples
    /// promises beyond them is not believed past a slope of -1.25.
    [[nodiscard]] double slope(const Configuration& configuration, std::int64_t spp) const {
        if (configuration.sampler == Sampler::Independent || spp < 4) return -1;
        std::vector<double> unused;
        const double x[] = {static_cast<double>(spp / 4), static_cast<double>(spp)};
        const double y[] = {mean(variances(render(configuration, spp / 4, unused))),
                            mean(variances(render(configuration, spp, unused)))};
        return y[0] > 0 && y[1] > 0 ? std::clamp(log_log_slope(x, y), -1.25, -1.0) : -1;
    }

    const SceneInBoth& scene_;
    const AdviseOptions& options_;
};

/// The trusted configuration, with as many samples as make its noise known, and no more than time allows for all
/// pilots. Its images and nothing else of it are in the given vector.
Pilot first_pilot(const Piloting& piloting, const Configuration& trusted, std::vector<Values>* images) {
    std::int64_t spp = 1;
    Pilot pilot = piloting.run(trusted, spp, images);
    const auto is_affordable = [&](std::int64_t more) {
        return kPilotsInUnits * kSeeds * pilot.seconds_of(static_cast<double>(more)) <= kSecondsOfPilots;
    };
    while ((spp < kPilotSpp || !pilot.is_noise_known()) && is_affordable(2 * spp))
        pilot = piloting.run(trusted, spp *= 2, images);
    return pilot;
}

/// How much farther than what the differences of images tell their mean may be from zero, where a sample can differ by
/// `max_radiance`. No more than the bound that is known without looking.
double unseen_bias(const std::vector<Values>& differences, double sample_count, double max_radiance, double bound) {
    double seen = 0;
    for (const Values& image : differences) seen += std::abs(mean(image)) / static_cast<double>(differences.size());
    if (max_radiance == 0) return 0;
    const double unit = max_radiance / sample_count;
    return std::max(0.0, std::min(bound, unit * greatest_expectation(seen / unit)) - seen);
}

Scene pilot_scene(Scene scene) {
    const auto pixels = static_cast<double>(scene.width * scene.height);
    if (pixels > kPilotPixels)
        set_width(scene, std::max<std::int64_t>(
                             1, std::llround(static_cast<double>(scene.width) * std::sqrt(kPilotPixels / pixels))));
    return scene;
}

/// What the pilots of single changes foretell of a combination: their factors multiplied.
struct Foretold {
    Configuration configuration;
    Pilot pilot;
};

bool is_better(const Target& target, const Offer& a, const Offer& b) {
    return target.error ? a.seconds < b.seconds : a.error_interval.high < b.error_interval.high;
}

std::optional<Offer> offer(const Pilot& pilot, const Target& target) {
    const auto spp = samples_for(pilot, target);
    if (!spp) return {};
    const auto samples = static_cast<double>(*spp);
    const auto [low, high] = std::minmax_element(pilot.seconds.begin(), pilot.seconds.end());
    const double scale = samples / static_cast<double>(pilot.spp);
    return Offer{pilot,
                 *spp,
                 pilot.seconds_of(samples),
                 pilot.error(samples),
                 {pilot.least_error(samples), pilot.most_error(samples)},
                 {*low * scale, *high * scale}};
}

void sort_offers(std::vector<Offer>& offers, const Target& target) {
    std::stable_sort(offers.begin(), offers.end(),
                     [&](const Offer& a, const Offer& b) { return is_better(target, a, b); });
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

/// The slope of Sobol samples is a measured one, and what is foretold by it less sure than by the -1 of independent
/// ones.
constexpr double kSobolMargin = 1.25;

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

std::int64_t most_pilots() {
    return 10 + static_cast<std::int64_t>(changes(true, kTrusted).size() + 8 * kOffers);
}

Advice advise(const Scene& scene, const Target& target, const AdviseOptions& options) {
    const Scene small = pilot_scene(scene);
    const SceneInBoth pilot_tables(small);
    const Piloting piloting(pilot_tables, options);
    const Configuration deep = trusted_for(pilot_tables.in_double);
    const Features& features = pilot_tables.in_float.features;
    Advice advice{feature_names(features), scene.width, scene.height, small.width, small.height, kSeeds, {}, {}};

    // One change at a time.
    std::vector<Values> trusted_images;
    const Pilot trusted = first_pilot(piloting, deep, &trusted_images);
    const std::int64_t pilot_spp = trusted.spp;
    if (!trusted.is_noise_known())
        throw NothingPromised(
            fmt::format("advise: cannot promise anything: {:.3g} trial samples found too little of the light, of which "
                        "the brightest "
                        "has a radiance of {:g}",
                        piloting.sample_count(pilot_spp), pilot_tables.in_double.max_radiance));
    const std::vector<Change> all = changes(features.dielectric, deep);
    std::vector<Pilot> pilots;
    for (const Change& change : all) {
        std::vector<Values> images;
        Pilot pilot = piloting.run(change.after, pilot_spp, &images);
        for (std::size_t i = 0; i < images.size(); ++i)
            // cppcheck-suppress containerOutOfBounds ; run() has filled it
            for (std::size_t k = 0; k < images[i].size(); ++k) images[i][k] -= trusted_images[i][k];
        pilot.bias = mean_squared_expectation(images);
        if (change.after.depth != deep.depth)
            pilot.unseen_bias =
                unseen_bias(images, piloting.sample_count(pilot_spp), pilot_tables.in_double.max_radiance,
                            pilot_tables.in_double.truncation_bound(change.after.depth));
        const Pilot& before = change.before == deep ? trusted : pilots.front();
        advice.simplifications.push_back({change.text, pilot.bias, pilot.unseen_bias,
                                          pilot.seconds_of(1) / before.seconds_of(1),
                                          mean(before.mse) == 0 ? 1 : pilot.noise(1) / before.noise(1)});
        pilots.push_back(std::move(pilot));
    }
    const Pilot& in_float = pilots.front();

    // All combinations, as the single changes foretell them.
    const auto factor = [&](const Pilot& pilot, const auto& figure) {
        const double before = figure(in_float);
        return before == 0 ? 1 : figure(pilot) / before;
    };
    std::vector<Pilot> combinations{trusted, in_float};
    const auto combine_all = [&](const auto& is_of_group) {
        const std::size_t count = combinations.size();
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (!is_of_group(all[i].after)) continue;
            for (std::size_t k = 0; k < count; ++k) {
                Pilot combined = combinations[k];
                const Configuration& after = all[i].after;
                Configuration& c = combined.configuration;
                if (after.engine != EngineKind::Pool) c.engine = after.engine;
                if (after.sampler != Sampler::Independent) c.sampler = after.sampler;
                if (after.roulette) c.roulette = true;
                if (after.split_depth != 0) c.split_depth = after.split_depth;
                if (after.depth != deep.depth) c.depth = after.depth;
                if (all[i].has_bias) {
                    combined.bias = pilots[i].bias;
                    combined.unseen_bias = pilots[i].unseen_bias;
                }
                if (after.sampler != Sampler::Independent) combined.slope = pilots[i].slope;
                const double noise = factor(pilots[i], [](const Pilot& p) { return mean(p.mse); });
                const double time = factor(pilots[i], [](const Pilot& p) { return median(p.seconds); });
                for (double& m : combined.mse) m *= noise;
                for (double& s : combined.seconds) s *= time;
                combinations.push_back(std::move(combined));
            }
        }
    };
    combine_all([](const Configuration& c) { return c.engine != EngineKind::Pool; });
    combine_all([](const Configuration& c) { return c.sampler != Sampler::Independent; });
    combine_all([](const Configuration& c) { return c.roulette; });
    combine_all([](const Configuration& c) { return c.split_depth != 0; });
    combine_all([&](const Configuration& c) { return c.depth != deep.depth; });

    // A closer look at the best, at the size that is asked for.
    std::vector<Offer> foretold;
    for (const Pilot& pilot : combinations)
        if (const auto found = offer(pilot, target)) foretold.push_back(*found);
    if (foretold.empty())
        throw InputError(
            target.error
                ? fmt::format("--target-error: {:g} would take more than {} samples a pixel", *target.error, kMostSpp)
                : fmt::format("--target-time: {:g} s is too short for one sample a pixel", *target.seconds));
    sort_offers(foretold, target);
    foretold.resize(std::min(foretold.size(), kOffers));
    const SceneInBoth tables(scene);
    const Piloting closer(tables, options);
    const double growth = static_cast<double>(tables.pixel_count()) / static_cast<double>(pilot_tables.pixel_count());
    bool is_any_known = false;
    for (const Offer& promising : foretold) {
        const double per_sample = promising.pilot.seconds_of(1) * growth * kSeeds;
        // Powers of two, at which Sobol points are what they are.
        std::int64_t spp = 1;
        while (2 * spp <= promising.spp && 2 * static_cast<double>(spp) * per_sample <= kSecondsPerOffer) spp *= 2;
        Pilot pilot = closer.run(promising.pilot.configuration, spp);
        while (!pilot.is_noise_known() && 2 * static_cast<double>(spp) * per_sample <= kMostSecondsPerOffer)
            pilot = closer.run(promising.pilot.configuration, spp *= 2);
        is_any_known = is_any_known || pilot.is_noise_known();
        if (!pilot.is_noise_known()) continue;
        pilot.bias = promising.pilot.bias;
        pilot.unseen_bias = promising.pilot.unseen_bias;
        if (const auto found = offer(pilot, target)) advice.offers.push_back(*found);
    }
    if (!is_any_known)
        throw NothingPromised(
            fmt::format("advise: cannot promise anything: trials of {} x {} found too little of the light, of which "
                        "the brightest has "
                        "a radiance of {:g}",
                        scene.width, scene.height, tables.in_double.max_radiance));
    if (advice.offers.empty()) throw InputError("--target-time: too short for one sample a pixel at this size");
    sort_offers(advice.offers, target);
    return advice;
}

}  // namespace raypool::accuracy
