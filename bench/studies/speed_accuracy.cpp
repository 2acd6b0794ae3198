// Error against time: every configuration on the same scenes with the same seeds, held against a trusted reference.

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "bench/accuracy/configuration.h"
#include "bench/accuracy/reference.h"
#include "bench/studies/generated_scene.h"
#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "bench/studies/runner.h"
#include "core/runtime/settings_text.h"
#include "core/scene/scene_reader.h"

namespace raypool::studies {

namespace {

using accuracy::Configuration;
using accuracy::EngineKind;
using accuracy::Precision;

// Kinds of rows.
constexpr const char* kReference = "reference";
constexpr const char* kBias = "bias";
constexpr const char* kRun = "run";

/// The fast pool in float: what the others are held against. depth 0: the usual one.
Configuration base_configuration(std::int64_t depth) {
    Configuration base;
    if (depth != 0) base.depth = static_cast<std::int32_t>(depth);
    return base;
}

/// The base, what differs from it in one thing, and the combinations that are worth a look.
std::vector<Configuration> configurations(std::int64_t depth, const Features& scene) {
    const Configuration base = base_configuration(depth);
    std::vector<Configuration> all{base};
    const auto add = [&](auto... changes) {
        Configuration changed = base;
        (changes(changed), ...);
        all.push_back(changed);
    };
    const auto recursion = [](Configuration& c) { c.engine = EngineKind::Recursive; };
    const auto in_double = [](Configuration& c) { c.precision = Precision::Double; };
    const auto shallow = [](Configuration& c) { c.depth = 5; };
    const auto sobol = [](Configuration& c) { c.sampler = Sampler::Sobol; };
    const auto roulette = [](Configuration& c) { c.roulette = true; };
    const auto deep = [](Configuration& c) { c.depth = accuracy::kDeep; };
    const auto split = [](Configuration& c) { c.split_depth = 1; };
    const auto light = [](Configuration& c) { c.light_sampling = LightSampling::Light; };
    const auto mis = [](Configuration& c) { c.light_sampling = LightSampling::Mis; };
    add(recursion);
    add(in_double);
    add(recursion, in_double);
    add(sobol);
    add(roulette);
    add(shallow);
    add(sobol, roulette);
    add(sobol, roulette, deep);
    add(sobol, roulette, recursion);
    if (scene.dielectric) {
        add(split);
        add(sobol, roulette, split);
    }
    if (scene.lights) {
        add(light);
        add(mis);
        add(mis, recursion);
        add(sobol, roulette, mis);
    }
    return all;
}

using SharedScene = std::shared_ptr<const accuracy::SceneInBoth>;

/// Samples for each pixel in a pair of images of which the bias is taken, and the number of pairs.
constexpr int kBiasPairs = 8;

/// What every row says.
Cells start_of_row(const char* kind, const accuracy::SceneInBoth& scene, const Configuration& c, int threads,
                   std::int64_t spp) {
    return {{"kind", kind},
            {"scene", scene.description.name},
            {"configuration", to_string(c)},
            {"engine", c.engine == EngineKind::Pool ? "pool" : "recursion"},
            {"precision", c.precision == Precision::Float ? "float" : "double"},
            {"sampler", c.sampler == Sampler::Sobol ? "Sobol" : "independent"},
            {"roulette", c.roulette ? "on" : "off"},
            {"depth", c.depth},
            {"split", c.split_depth},
            {"light_sampling", raypool::to_string(c.light_sampling)},
            {"threads", threads},
            {"width", scene.in_float.width},
            {"spp", spp}};
}

struct AccuracyPlan {
    std::vector<std::int64_t> spps;
    int seeds = 0;
    std::uint64_t first_seed = 0;
    int threads = 1;      ///< of what is timed
    int all_threads = 1;  ///< of what is not

    [[nodiscard]] std::int64_t half_spp() const { return 32 * spps.back(); }
};

AccuracyPlan accuracy_plan(const StudyOptions& options) {
    AccuracyPlan plan;
    const std::int64_t most = choose(options, options.spp, {64, 256});
    for (std::int64_t spp = 1; spp < most; spp *= 4) plan.spps.push_back(spp);
    plan.spps.push_back(most);
    plan.seeds = static_cast<int>(choose(options, options.repeats, {5, 10}));
    plan.first_seed = options.seed;
    plan.threads = options.threads != 0 ? options.threads : 1;
    plan.all_threads = options.threads != 0 ? options.threads : core_count();
    return plan;
}

/// The one that is given; or some that are built in, and two with meshes: many small things, and a room.
std::vector<SharedScene> scenes_of(const StudyOptions& options) {
    std::vector<Scene> described;
    if (options.is_scene_given) {
        described.push_back(load_scene(options.scene));
    } else {
        for (const char* name : {"paper", "cornell", "glass_stack", "half_sky"}) described.push_back(load_scene(name));
        for (const char* kind : {"field", "room"})
            described.push_back(generated_description(kind, options.is_quick ? 1000 : 10'000));
    }
    std::vector<SharedScene> scenes;
    for (Scene& scene : described) {
        set_width(scene, choose(options, options.width, {64, 112}));
        scenes.push_back(std::make_shared<const accuracy::SceneInBoth>(scene));
    }
    return scenes;
}

/// One row for each configuration that makes another image: its expectation against the trusted one, by pairs of images
/// made from the same random numbers, whose common noise goes away in their difference. Lights are sampled in both in
/// the same way, or most of the noise would stay.
Case bias_case(const SharedScene& scene, const std::vector<Configuration>& all, const AccuracyPlan& plan) {
    const auto run = [=]() -> std::vector<Cells> {
        const std::int64_t spp = plan.spps.back();
        const auto image = [&](const Configuration& c, int pair) {
            const std::uint64_t seed = plan.first_seed + static_cast<std::uint64_t>(pair);
            return render_image(c, *scene, {0, spp, seed, plan.all_threads}).values;
        };
        std::map<LightSampling, std::vector<accuracy::Values>> trusted_images;
        std::vector<Cells> rows;
        for (const Configuration& c : all) {
            if (c.engine != EngineKind::Pool) continue;  // the engine does not show in the image
            std::vector<accuracy::Values>& trusted = trusted_images[c.light_sampling];
            Configuration trusted_way = accuracy::kTrusted;
            trusted_way.light_sampling = c.light_sampling;
            for (int pair = static_cast<int>(trusted.size()); pair < kBiasPairs; ++pair)
                trusted.push_back(image(trusted_way, pair));
            std::vector<accuracy::Values> differences;
            for (int pair = 0; pair < kBiasPairs; ++pair) {
                differences.push_back(image(c, pair));
                for (std::size_t i = 0; i < trusted[0].size(); ++i)
                    differences.back()[i] -= trusted[static_cast<std::size_t>(pair)][i];
            }
            const accuracy::Estimate bias = accuracy::mean_squared_expectation(differences);
            rows.push_back(start_of_row(kBias, *scene, c, plan.all_threads, spp) +
                           Cells{{"bias_squared", bias.value}, {"bias_error", bias.error}});
        }
        return rows;
    };
    return {"bias: " + scene->description.name, "", 1, run};
}

Case timed_case(const SharedScene& scene, const std::shared_ptr<accuracy::Reference>& reference, const Configuration& c,
                const AccuracyPlan& plan, std::int64_t spp, std::uint64_t seed) {
    const auto run = [=]() -> std::vector<Cells> {
        const accuracy::TimedImage made = render_image(c, *scene, {0, spp, seed, plan.threads});
        const accuracy::Halves& halves = reference->halves();
        return {start_of_row(kRun, *scene, c, plan.threads, spp) + Cells{{"seed", seed},
                                                                         {"seconds", made.report.seconds},
                                                                         {"segments", made.report.segments()},
                                                                         {"mse", corrected_mse(made.values, halves)},
                                                                         {"reference_noise", noise_of(halves)},
                                                                         {"hash", made.hash}}};
    };
    Configuration any_engine = c;
    any_engine.engine = EngineKind::Pool;
    return {fmt::format("{}: {}, {} spp, seed {}", scene->description.name, to_string(c), spp, seed),
            fmt::format("{} {} x {}, {} with {} spp, seed {}", scene->description.name, scene->in_float.width,
                        scene->in_float.height, to_string(any_engine), spp, seed),
            1, run};
}

std::vector<Case> accuracy_cases(const StudyOptions& options) {
    const AccuracyPlan plan = accuracy_plan(options);
    const std::filesystem::path folder = options.folder.empty() ? "" : options.folder / "references";
    std::vector<Case> cases;
    std::vector<std::function<Case(std::uint64_t)>> by_seed;
    for (const SharedScene& scene : scenes_of(options)) {
        const auto reference = std::make_shared<accuracy::Reference>(scene, plan.half_spp(), folder, plan.all_threads,
                                                                     reference_configuration(*scene));
        // In parts, so that an interruption loses little.
        const std::int64_t range = std::max<std::int64_t>(1, plan.half_spp() / 16);
        for (std::int64_t part = 0; part < 2 * ((plan.half_spp() + range - 1) / range); ++part)
            cases.push_back({fmt::format("reference: {}, part {}", scene->description.name, part), "", 1, [=] {
                                 reference->extend(range);
                                 return std::vector<Cells>{start_of_row(
                                     kReference, *scene, reference_configuration(*scene), plan.all_threads, range)};
                             }});

        const std::vector<Configuration> all = configurations(options.depth, scene->in_float.features);
        cases.push_back(bias_case(scene, all, plan));
        for (const Configuration& c : all)
            for (const std::int64_t spp : plan.spps)
                by_seed.emplace_back(
                    [=](std::uint64_t seed) { return timed_case(scene, reference, c, plan, spp, seed); });
    }
    // A seed after the other; what has the same seed stands side by side.
    for (int turn = 0; turn < plan.seeds; ++turn)
        for (const std::size_t i : turn_order(by_seed.size(), static_cast<std::size_t>(turn)))
            cases.push_back(by_seed[i](plan.first_seed + static_cast<std::uint64_t>(turn)));
    return cases;
}

}  // namespace

Study speed_accuracy_study() {
    return {
        .name = "speed-accuracy",
        .question =
            "Which configuration reaches which error in the least time, and where does each stop getting "
            "better?",
        .columns = {{"kind", ColumnType::Text, "reference (being made), bias (no times), or run"},
                    {"scene", ColumnType::Text, "what was rendered"},
                    {"configuration", ColumnType::Text, "the next columns in words"},
                    {"engine", ColumnType::Text, "who rendered"},
                    {"precision", ColumnType::Text, "numbers of the kernels"},
                    {"sampler", ColumnType::Text, "how random numbers are made"},
                    {"roulette", ColumnType::Text, "on: paths that carry little end by chance"},
                    {"depth", ColumnType::Count, "most segments of a path"},
                    {"split", ColumnType::Count, "hits on glass that follow both branches"},
                    {"light_sampling", ColumnType::Text, "how lights are found: none (by chance), light or mis"},
                    {"threads", ColumnType::Count, "OpenMP threads"},
                    {"width", ColumnType::Count, "image width, pixels"},
                    {"spp", ColumnType::Count, "samples for each pixel"},
                    {"seed", ColumnType::Count, "of all random numbers of the image"},
                    {"seconds", ColumnType::Real, "wall clock of the render: setup, loops, last pass"},
                    {"segments", ColumnType::Count, "rays traced"},
                    {"mse", ColumnType::Signed, "squared error of linear radiance, less the noise of the reference"},
                    {"reference_noise", ColumnType::Real, "what was taken off"},
                    {"bias_squared", ColumnType::Signed,
                     "squared error that more samples do not mend, from pairs of images that share random numbers"},
                    {"bias_error", ColumnType::Real, "standard error of that"},
                    {"hash", ColumnType::Text, "of the sums of the image"}},
        .cases = accuracy_cases};
}

}  // namespace raypool::studies
