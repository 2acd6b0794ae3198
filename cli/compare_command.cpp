#include <algorithm>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/studies/statistics.h"
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/engines.h"
#include "cli/options.h"
#include "cli/pool_options.h"
#include "cli/print.h"
#include "core/base/error.h"
#include "core/base/json_file.h"
#include "core/base/output_file.h"
#include "core/runtime/environment.h"
#include "wavefront/engine.h"
#include "wavefront/ladder.h"

#ifdef RAYPOOL_HAS_EMBREE
#include "bench/peers/embree_engine.h"
#include "bench/peers/mean_difference.h"
#endif

namespace raypool::cli {

namespace {

#ifdef NDEBUG
constexpr bool kIsDebugBuild = false;
#else
constexpr bool kIsDebugBuild = true;
#endif

constexpr const char* kChanges = "changes";  // in place of a hash: from run to run

struct CompareOptions : CommonOptions {
    std::int64_t spp = 32;
    int repeats = 5;
    bool only_check = false;
    std::string json;
};

/// How the image of an engine is held to that of the first.
enum class Check : std::uint8_t {
    SameImage,
    SameButForEdges,  ///< of a peer, whose traversal may lose a hit at the edge of a shape
    SameMean,         ///< of a peer that has tests of shapes of its own
};

/// One row of the table.
struct Contender {
    std::string name;
    std::string step;
    std::shared_ptr<const Engine> engine;
    Check check;
    nlohmann::json pool;                 ///< null where there is none
    std::unique_ptr<Framebuffer> image;  ///< of the last run, where more than the hash is looked at
    std::string hash;                    ///< or what there is to say in its place
    std::vector<double> rate;            ///< M paths/s, one a repeat
    std::vector<double> ratio;           ///< to the recursive engine in the same repeat
    RenderReport last;
};

/// The engines, and the peers that this build knows of where they can carry out the settings.
std::vector<Contender> contenders([[maybe_unused]] const CompiledScene<float>& scene, const RenderSettings& settings) {
    std::vector<Contender> list;
    const auto add = [&](std::string name, std::string step, const std::shared_ptr<const Engine>& engine,
                         nlohmann::json pool, Check check = Check::SameImage) {
        list.push_back({std::move(name), std::move(step), engine, check, std::move(pool), {}, {}, {}, {}, {}});
    };
    for (const EngineEntry& entry : engines().entries())  // pools come below, a rung each
        if (!entry.has_pool && entry.can_render(settings)) add(entry.name, entry.description, entry.make({}), nullptr);
    for (const wavefront::Rung& rung : wavefront::ladder(settings.threads))
        add(rung.name, rung.step, std::make_shared<wavefront::WavefrontEngine>(rung.pool), to_json(rung.pool));
#ifdef RAYPOOL_HAS_EMBREE
    if (settings.split_depth == 0 && scene.instance_tree.blocks.empty()) {
        for (const auto& engine : peers::embree_engines(!scene.triangles.empty())) {
            if (engine->is_independent(scene)) {
                add(engine->name(), "the triangles and the traversal of Embree 3", engine, nullptr, Check::SameMean);
            } else {
                add(engine->name(), "the traversal of Embree 3 with our physics", engine, nullptr,
                    Check::SameButForEdges);
            }
        }
    }
#endif
    return list;
}

/// Balance of the segments that threads traced.
double load_imbalance(const RenderReport& report) {
    return studies::max_over_mean(studies::by_thread(report, &ThreadReport::segments));
}

std::string run_once(Contender& contender, const CompiledScene<float>& scene, const RenderSettings& settings) {
    contender.image =
        std::make_unique<Framebuffer>(scene.width, scene.height, fixed_point(scene, settings, settings.end_sample));
    contender.last = contender.engine->render(scene, settings, *contender.image);
    return contender.image->hash();
}

/// Runs all once, by another stride each turn, so that no contender always follows the same other.
void run_all(std::vector<Contender>& list, std::size_t turn, const CompiledScene<float>& scene,
             const RenderSettings& settings) {
    std::size_t stride = turn + 1;
    while (std::gcd(stride, list.size()) != 1) ++stride;
    for (std::size_t i = 0; i < list.size(); ++i) {
        Contender& contender = list[(turn + i * stride) % list.size()];
        const std::string hash = run_once(contender, scene, settings);
        if (contender.check != Check::SameMean && &contender != &list.front()) contender.image.reset();
        if (contender.hash.empty()) contender.hash = hash;
        if (contender.hash != hash) contender.hash = kChanges;
        contender.rate.push_back(static_cast<double>(contender.last.paths()) / contender.last.seconds * 1e-6);
    }
    for (Contender& contender : list) contender.ratio.push_back(contender.rate.back() / list.front().rate.back());
}

void print_table(const std::vector<Contender>& list) {
    print("{:<18} {:>9} {:>22} {:>9} {:>8} {:>7} {:>9}  {}\n", "engine", "M paths/s", "ratio (low to high)", "load",
          "waiting", "bytes", "pools", "hash");
    for (const Contender& contender : list) {
        const studies::Spread rate = studies::spread(contender.rate);
        const studies::Spread ratio = studies::spread(contender.ratio);
        print("{:<18} {:>9.2f} {:>6.2f} ({:>5.2f} to {:>5.2f}) {:>9.3f} {:>6.1f} % {:>7} {:>6.2f} MB  {}\n",
              contender.name, rate.median, ratio.median, ratio.low, ratio.high, load_imbalance(contender.last),
              100 * studies::waiting(contender.last), wavefront::pool_report(contender.last).record_bytes,
              static_cast<double>(contender.last.memory_bytes) / (1024 * 1024), contender.hash);
    }
    print("not timed, of any engine: the scene's reading and its tables, the framebuffer's making and its hash\n");
}

nlohmann::json table_json(const std::vector<Contender>& list) {
    nlohmann::json rows = nlohmann::json::array();
    for (const Contender& contender : list) {
        const studies::Spread ratio = studies::spread(contender.ratio);
        rows.push_back({{"name", contender.name},
                        {"step", contender.step},
                        {"hash", contender.hash},
                        {"mpaths_per_s", contender.rate},
                        {"ratio", contender.ratio},
                        {"ratio_median", ratio.median},
                        {"segments", contender.last.segments()},
                        {"load_max_over_mean", load_imbalance(contender.last)},
                        {"waiting", studies::waiting(contender.last)},
                        {"setup_s", contender.last.setup_s},
                        {"record_bytes", wavefront::pool_report(contender.last).record_bytes},
                        {"pool_bytes", contender.last.memory_bytes},
                        {"pool", contender.pool}});
    }
    return rows;
}

/// Whether all images are what they must be, and whether all of one hash.
struct Checked {
    bool is_good = true;
    bool loses_hits = false;  ///< a peer does, at edges
    bool has_other = false;   ///< a peer has an image of its own
};

/// Puts what there is to say of an image in place of a hash that is not that of the first.
Checked check(std::vector<Contender>& list) {
    Checked checked;
    const Contender& first = list.front();
    for (Contender& contender : list) {
        const bool is_equal = contender.hash == first.hash && contender.last.segments() == first.last.segments();
#ifdef RAYPOOL_HAS_EMBREE
        if (contender.check == Check::SameMean && !is_equal && contender.hash != kChanges) {
            const peers::MeanDifference off = peers::mean_difference(*contender.image, *first.image);
            contender.hash = fmt::format("mean {:+.1e} ({:+.1f} standard errors), {:.2g} % of pixels differ",
                                         off.relative, off.standard_errors, 100 * off.differing_pixels);
            checked.has_other = true;
            checked.is_good = checked.is_good && off.is_noise();
            continue;
        }
#endif
        if (contender.check == Check::SameButForEdges && !is_equal && contender.hash != kChanges) {
            contender.hash = "differs";
            checked.loses_hits = true;
        } else {
            checked.is_good = checked.is_good && is_equal;
        }
    }
    return checked;
}

std::string verdict(const Checked& checked) {
    if (!checked.is_good) return "THE IMAGES DIFFER";
    std::string text = "all images are the same";
    if (checked.loses_hits) text += " but Embree's, which loses hits at edges (docs/pool.md)";
    if (checked.has_other) text += "; those of Embree's own triangles have the same mean, to four standard errors";
    return text;
}

int compare(const CompareOptions& options) {
    if (kIsDebugBuild && !options.only_check)
        throw InputError("compare: a debug build does not time; build in Release, or add --check");
    check_distinct({{"--json", options.json}}, {{"the scene", options.scene}});
    if (!options.json.empty()) check_writable(options.json);
    RenderSettings settings = common_settings(options);
    settings.end_sample = options.spp;
    settings.schedule = chosen_schedule(options.schedule, options.grain);
    const Scene scene = scene_of(options);
    const CompiledScene<float> compiled = compile<float>(scene);
    settings.light_sampling = needed_light_sampling(compiled.features, settings);

    std::vector<Contender> list = contenders(compiled, settings);
    const int repeats = options.only_check ? 1 : options.repeats;
    for (int i = 0; i < repeats; ++i) run_all(list, static_cast<std::size_t>(i), compiled, settings);

    const Checked checked = check(list);
    print("{}: {} x {}, {} spp, depth {}, {} thread{}, {} interleaved run{}\n", scene.name, scene.width, scene.height,
          options.spp, settings.depth, settings.threads, settings.threads == 1 ? "" : "s", repeats,
          repeats == 1 ? "" : "s");
    if (options.only_check) {
        for (const Contender& contender : list)
            print("{:<18} {} {} segments\n", contender.name, contender.hash, contender.last.segments());
    } else if (checked.is_good) {
        print_table(list);
    } else {  // a figure of a wrong image is not worth printing
        for (const Contender& contender : list) print("{:<18} {}\n", contender.name, contender.hash);
    }
    print("{}\n", verdict(checked));
    if (!options.json.empty() && checked.is_good) {
        nlohmann::json table{{"scene", scene.name},
                             {"width", scene.width},
                             {"height", scene.height},
                             {"spp", options.spp},
                             {"depth", settings.depth},
                             {"sampler", to_string(settings.sampler)},
                             {"roulette", settings.roulette},
                             {"light_sampling", to_string(settings.light_sampling)},
                             {"threads", settings.threads},
                             {"schedule", to_string(settings.schedule)},
                             {"repeats", repeats},
                             {"rows", table_json(list)},
                             {"environment", environment_json()}};
        if (has_grain(settings.schedule)) table["grain"] = to_string(settings.grain);
        write_json(options.json, table);
    }
    return checked.is_good ? 0 : 1;
}

}  // namespace

void add_compare_command(CLI::App& app, int& status) {
    auto options = std::make_shared<CompareOptions>();
    CLI::App* command =
        app.add_subcommand("compare", "Run every engine in turn: same hash? how fast? which threads waited?");
    add_common_options(*command, *options);
    command->add_option("--spp", options->spp, "Samples per pixel (default: 32)")
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000}));
    command->add_option("--repeats", options->repeats, "Interleaved runs of each engine (default: 5)")
        ->check(CLI::Range(1, 1000));
    command->add_flag("--check", options->only_check, "Compare images and segments only, do not time");
    command->add_option("--json", options->json, "Write all figures to this file")->check(check_file_name);
    command->callback([options, &status] { status = compare(*options); });
}

}  // namespace raypool::cli
