#include "bench/accuracy/advise.h"

#include <algorithm>
#include <cmath>
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

/// Renders for a pilot.
class Piloting {
  public:
    Piloting(const SceneInBoth& scene, const AdviseOptions& options) : scene_(scene), options_(options) {}

    /// `images` receives the images, where it is wanted.
    Pilot run(const Configuration& configuration, std::int64_t spp, std::vector<Values>* images = nullptr) const {
        const double brightest = greatest_sample(scene_.in_double, image_settings(configuration, 0));
        const double greatest_share = brightest * brightest / static_cast<double>(scene_.pixel_count());
        Pilot pilot{configuration, spp, {}, {}, slope(configuration, spp), {}, 0, greatest_share};
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

/// The best first.
void sort_offers(std::vector<Offer>& offers, const Target& target) {
    std::stable_sort(offers.begin(), offers.end(), [&](const Offer& a, const Offer& b) {
        return target.error ? a.seconds < b.seconds : a.error_interval.high < b.error_interval.high;
    });
}

/// What the pilot of a change foretells of a combination with it: its factors, against float without it, multiplied.
Pilot combined(Pilot combination, const Change& change, const Pilot& alone, const Pilot& in_float) {
    const auto factor = [&](double with, double without) { return without == 0 ? 1 : with / without; };
    change.apply(combination.configuration);
    if (change.group == Group::Depth) {
        combination.bias = alone.bias;
        combination.unseen_bias = alone.unseen_bias;
    }
    if (change.group == Group::Sampler) combination.slope = alone.slope;
    if (change.group == Group::Lights) combination.greatest_share = alone.greatest_share;
    const double noise = factor(mean(alone.mse), mean(in_float.mse));
    const double time = factor(median(alone.seconds), median(in_float.seconds));
    for (double& m : combination.mse) m *= noise;
    for (double& s : combination.seconds) s *= time;
    return combination;
}

/// All combinations, as the single changes foretell them; `pilots` are those of the changes.
std::vector<Pilot> combinations(const Pilot& trusted, const std::vector<Change>& all,
                                const std::vector<Pilot>& pilots) {
    std::vector<Pilot> combinations{trusted, pilots.front()};
    for (const Group group :
         {Group::Engine, Group::Sampler, Group::Roulette, Group::Split, Group::Lights, Group::Depth}) {
        const std::size_t count = combinations.size();
        for (std::size_t i = 0; i < all.size(); ++i)
            for (std::size_t k = 0; all[i].group == group && k < count; ++k)
                combinations.push_back(combined(combinations[k], all[i], pilots[i], pilots.front()));
    }
    return combinations;
}

/// Whether lights are sampled so well that the time of a closer look finds too little of what is left to chance.
bool is_hopeless(const Pilot& pilot) {
    return pilot.configuration.light_sampling != LightSampling::None &&
           pilot.seconds_of(kSeeds * pilot.known_spp()) > kMostSecondsPerOffer;
}

/// The few most promising, which may meet the target, and of those that sample no lights at least one: where lights
/// are sampled little is left to chance, and what may be left is known late. Throws InputError where none may.
std::vector<Offer> promising(const std::vector<Pilot>& pilots, const Target& target) {
    std::vector<Offer> foretold;
    for (const Pilot& pilot : pilots)
        if (const auto found = offer(pilot, target)) foretold.push_back(*found);
    if (foretold.empty())
        throw InputError(
            target.error
                ? fmt::format("--target-error: {:g} would take more than {} samples a pixel", *target.error, kMostSpp)
                : fmt::format("--target-time: {:g} s is too short for one sample a pixel", *target.seconds));
    sort_offers(foretold, target);
    if (!std::all_of(foretold.begin(), foretold.end(), [](const Offer& o) { return is_hopeless(o.pilot); }))
        std::erase_if(foretold, [](const Offer& offer) { return is_hopeless(offer.pilot); });
    const auto end_of_best = foretold.begin() + static_cast<std::ptrdiff_t>(std::min(foretold.size(), kOffers));
    const auto by_chance = std::find_if(foretold.begin(), foretold.end(), [](const Offer& offer) {
        return offer.pilot.configuration.light_sampling == LightSampling::None;
    });
    std::vector<Offer> best(foretold.begin(), end_of_best);
    if (by_chance != foretold.end() && by_chance >= end_of_best) best.push_back(*by_chance);
    return best;
}

/// A pilot at the size that is asked for, of a configuration that takes so many seconds a sample there.
Pilot closer_pilot(const Piloting& piloting, const Offer& promised, double seconds_per_sample) {
    const auto is_affordable = [&](std::int64_t spp, double most) {
        return static_cast<double>(spp) * seconds_per_sample <= most;
    };
    // Powers of two, at which Sobol points are what they are.
    std::int64_t spp = 1;
    while (2 * spp <= promised.spp && is_affordable(2 * spp, kSecondsPerOffer)) spp *= 2;
    Pilot pilot = piloting.run(promised.pilot.configuration, spp);
    while (!pilot.is_noise_known() && is_affordable(2 * spp, kMostSecondsPerOffer))
        pilot = piloting.run(promised.pilot.configuration, spp *= 2);
    pilot.bias = promised.pilot.bias;
    pilot.unseen_bias = promised.pilot.unseen_bias;
    return pilot;
}

NothingPromised nothing_promised(const std::string& trials, double max_radiance) {
    return NothingPromised(
        fmt::format("advise: cannot promise anything: {} found too little of the light, of which "
                    "the brightest has a radiance of {:g}",
                    trials, max_radiance));
}

}  // namespace

std::int64_t most_pilots() {
    return 10 + static_cast<std::int64_t>(changes(kEverything, kTrusted).size() + 8 * (kOffers + 1));
}

Advice advise(const Scene& scene, const Target& target, const AdviseOptions& options) {
    const Scene small = pilot_scene(scene);
    const SceneInBoth pilot_tables(small);
    const Piloting piloting(pilot_tables, options);
    const CompiledScene<double>& compiled = pilot_tables.in_double;
    const Configuration deep = trusted_for(compiled);
    const Features& features = pilot_tables.in_float.features;
    Advice advice{features, scene.width, scene.height, small.width, small.height, kSeeds, {}, {}};

    // One change at a time.
    std::vector<Values> trusted_images;
    const Pilot trusted = first_pilot(piloting, deep, &trusted_images);
    const double sample_count = piloting.sample_count(trusted.spp);
    if (!trusted.is_noise_known())
        throw nothing_promised(fmt::format("{:.3g} trial samples", sample_count), compiled.max_radiance);
    const std::vector<Change> all = changes(features, deep);
    std::vector<Pilot> pilots;
    for (const Change& change : all) {
        const Pilot& before = change.group == Group::Precision ? trusted : pilots.front();
        std::vector<Values> images;
        Pilot pilot = piloting.run(change.applied(before.configuration), trusted.spp, &images);
        for (std::size_t i = 0; i < images.size(); ++i)
            // cppcheck-suppress containerOutOfBounds ; run() has filled it
            for (std::size_t k = 0; k < images[i].size(); ++k) images[i][k] -= trusted_images[i][k];
        pilot.bias = mean_squared_expectation(images);
        if (change.group == Group::Depth)
            pilot.unseen_bias = unseen_bias(images, sample_count, compiled.max_radiance,
                                            compiled.truncation_bound(pilot.configuration.depth));
        advice.simplifications.push_back({change.text, pilot.bias, pilot.unseen_bias,
                                          pilot.seconds_of(1) / before.seconds_of(1),
                                          mean(before.mse) == 0 ? 1 : pilot.noise(1) / before.noise(1)});
        pilots.push_back(std::move(pilot));
    }

    // A closer look at the best, at the size that is asked for.
    const std::vector<Offer> foretold = promising(combinations(trusted, all, pilots), target);
    const SceneInBoth tables(scene);
    const Piloting closer(tables, options);
    const double growth = static_cast<double>(tables.pixel_count()) / static_cast<double>(pilot_tables.pixel_count());
    bool is_any_known = false;
    for (const Offer& promised : foretold) {
        const Pilot pilot = closer_pilot(closer, promised, promised.pilot.seconds_of(1) * growth * kSeeds);
        if (!pilot.is_noise_known()) continue;
        is_any_known = true;
        if (const auto found = offer(pilot, target)) advice.offers.push_back(*found);
    }
    if (!is_any_known)
        throw nothing_promised(fmt::format("trials of {} x {}", scene.width, scene.height),
                               tables.in_double.max_radiance);
    if (advice.offers.empty()) throw InputError("--target-time: too short for one sample a pixel at this size");
    sort_offers(advice.offers, target);
    return advice;
}

}  // namespace raypool::accuracy
