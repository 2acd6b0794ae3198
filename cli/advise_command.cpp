#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/accuracy/advise.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print.h"
#include "cli/progress_bar.h"
#include "core/base/error.h"
#include "core/base/json_file.h"
#include "core/base/output_file.h"
#include "core/base/text.h"
#include "core/runtime/environment.h"
#include "core/scene/scene_reader.h"

namespace raypool::cli {

namespace {

using accuracy::Advice;
using accuracy::Estimate;
using accuracy::Offer;
using accuracy::Simplification;

struct AdviseCommand {
    std::string scene = "paper";
    std::optional<double> target_error;
    std::optional<double> target_time;
    std::int64_t width = 0;
    int threads = 0;
    std::string seed = "0";
    std::string json;
    bool is_quiet = false;
};

std::string render_line(const AdviseCommand& command, const Features& scene, const Offer& offer, int threads) {
    return fmt::format("raypool render {}{} --spp {} {} --threads {}", shell_word(command.scene),
                       command.width == 0 ? "" : fmt::format(" --width {}", command.width), offer.spp,
                       render_flags(offer.pilot.configuration, scene), threads);
}

/// A bias that was found, or else what it is below, light that was not seen included.
std::string bias_text(const Estimate& bias, double unseen) {
    const double most = std::sqrt(std::max(bias.value + 2 * bias.error, 0.0)) + unseen;
    if (most == 0) return "0";
    return bias.value > 2 * bias.error && unseen < std::sqrt(bias.value) ? fmt::format("{:.1e}", std::sqrt(bias.value))
                                                                         : fmt::format("< {:.1e}", most);
}

void print_offer(const Offer& offer) {
    print("RMSE {:.3g} ({:.3g} to {:.3g}), of which bias {}; {:.3g} s ({:.3g} to {:.3g})\n", offer.error,
          offer.error_interval.low, offer.error_interval.high, bias_text(offer.pilot.bias, offer.pilot.unseen_bias),
          offer.seconds, offer.seconds_interval.low, offer.seconds_interval.high);
}

void print_advice(const Advice& advice, const AdviseCommand& command, int threads) {
    const std::vector<std::string> features = feature_names(advice.features);
    print("{}: features: {}\n", command.scene,
          features.empty() ? "nothing" : fmt::format("{}", fmt::join(features, ", ")));
    print("tried at {} x {} with {} seeds, {} thread{}, and the best {} at {} x {}\n\n", advice.pilot_width,
          advice.pilot_height, advice.pilot_seeds, threads, threads == 1 ? "" : "s", advice.offers.size(), advice.width,
          advice.height);
    print("{:<44} {:>12} {:>11} {:>11} {:>13}\n", "what one change does", "bias (RMSE)", "time of", "MSE of",
          "time to");
    print("{:<44} {:>12} {:>11} {:>11} {:>13}\n", "", "", "a sample", "a sample", "equal noise");
    for (const Simplification& s : advice.simplifications)
        print("{:<44} {:>12} {:>11.2f} {:>11.2f} {:>13.2f}\n", s.text, bias_text(s.bias, s.unseen_bias), s.time,
              s.noise, s.time * s.noise);
    print("\n");
    for (std::size_t i = 1; i < advice.offers.size(); ++i) {
        print("next best: {}, {} spp: ", to_string(advice.offers[i].pilot.configuration), advice.offers[i].spp);
        print_offer(advice.offers[i]);
    }
    print("predicted: ");
    print_offer(advice.offers.front());
    print("{}\n", render_line(command, advice.features, advice.offers.front(), threads));
}

nlohmann::json bias_json(const Estimate& bias, double unseen) {
    return {{"squared", bias.value}, {"standard_error", bias.error}, {"unseen", unseen}};
}

nlohmann::json advice_json(const Advice& advice, const AdviseCommand& command, int threads) {
    nlohmann::json offers = nlohmann::json::array();
    for (const Offer& o : advice.offers)
        offers.push_back({{"configuration", to_string(o.pilot.configuration)},
                          {"command", render_line(command, advice.features, o, threads)},
                          {"spp", o.spp},
                          {"seconds", o.seconds},
                          {"seconds_interval", {o.seconds_interval.low, o.seconds_interval.high}},
                          {"rmse", o.error},
                          {"rmse_interval", {o.error_interval.low, o.error_interval.high}},
                          {"bias", bias_json(o.pilot.bias, o.pilot.unseen_bias)},
                          {"slope_of_mse", o.pilot.slope},
                          {"pilot_spp", o.pilot.spp}});
    nlohmann::json changes = nlohmann::json::array();
    for (const Simplification& s : advice.simplifications)
        changes.push_back(
            {{"what", s.text}, {"bias", bias_json(s.bias, s.unseen_bias)}, {"time", s.time}, {"mse", s.noise}});
    nlohmann::json target = nlohmann::json::object();
    if (command.target_error) target["error"] = *command.target_error;
    if (command.target_time) target["seconds"] = *command.target_time;
    return {{"scene", command.scene},
            {"target", target},
            {"features", feature_names(advice.features)},
            {"size", {advice.width, advice.height}},
            {"pilot_size", {advice.pilot_width, advice.pilot_height}},
            {"pilot_seeds", advice.pilot_seeds},
            {"threads", threads},
            {"changes", changes},
            {"offers", offers},
            {"environment", environment_json()}};
}

void advise(const AdviseCommand& command) {
    if (command.target_error.has_value() == command.target_time.has_value())
        throw InputError("advise: needs one of --target-error and --target-time");
    check_distinct({{"--json", command.json}}, {{"the scene", command.scene}});
    if (!command.json.empty()) check_writable(command.json);
    Scene scene = load_scene(command.scene);
    if (command.width != 0) set_width(scene, command.width);
    Progress progress;
    accuracy::AdviseOptions options;
    options.threads = thread_count(command.threads);
    options.seed = parse_seed(command.seed);
    options.progress = &progress;
    Advice advice;
    {
        const ProgressBar bar(progress, accuracy::most_pilots(), {"pilots/s", 1}, command.is_quiet);
        advice = accuracy::advise(scene, {command.target_error, command.target_time}, options);
    }
    if (!command.json.empty()) write_json(command.json, advice_json(advice, command, options.threads));
    if (command.is_quiet) return;
    print_advice(advice, command, options.threads);
    if (!command.json.empty()) print("{}\n", command.json);
}

}  // namespace

void add_advise_command(CLI::App& app, int&) {
    auto command = std::make_shared<AdviseCommand>();
    CLI::App* sub =
        app.add_subcommand("advise", "Find the cheapest settings for an error, by trying them on the scene");
    sub->add_option("scene", command->scene, "Scene file, or the name of a built-in scene (default: paper)");
    sub->add_option("--target-error", command->target_error,
                    "Root mean square error, in linear radiance, that the image may have")
        ->check(check_within(1e-9, 1e6));
    sub->add_option("--target-time", command->target_time, "Seconds that the render may take")
        ->check(check_within(1e-6, 1e9));
    sub->add_option("--width", command->width, "Image width; the height follows (default: the scene's)")
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{65536}));
    sub->add_option("--threads", command->threads, "OpenMP threads (default: OMP_NUM_THREADS)")
        ->check(CLI::Range(1, 4096));
    sub->add_option("--seed", command->seed, "Seed of the trials (default: 0)");
    sub->add_option("--json", command->json, "Write all that was found to this file")->check(check_file_name);
    sub->add_flag("--quiet", command->is_quiet, "Print nothing");
    sub->callback([command] { advise(*command); });
}

}  // namespace raypool::cli
