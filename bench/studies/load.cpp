// Work of each thread under every way of sharing it out: the paper's Figure 5, from counted work, and the same of
// pools.

#include <fmt/format.h>

#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "bench/studies/replay_ways.h"
#include "bench/studies/runner.h"
#include "core/runtime/balanced_items.h"
#include "core/runtime/settings_text.h"
#include "wavefront/ladder.h"

namespace raypool::studies {

namespace {

/// Of the recursive engine.
constexpr LoopWay kLoadWays[] = {
    {"lines, static (default)", "line", "static"},
    {"lines, static,1", "line", "static,1"},
    {"lines, dynamic", "line", "dynamic"},
    {"lines, guided", "line", "guided"},
    {"tiles of 16, dynamic", "tile:16", "dynamic"},
    {"pixels, static", "pixel", "static"},
    {"pixels, static,1 (collapse)", "pixel", "static,1"},
    {"pixels, dynamic", "pixel", "dynamic"},
    {"balanced (raypool's default)", "pixel", "balanced"},
};
constexpr const char* kShares = "one of all paths, equal shares";

/// What every row says.
Cells start_of_row(const StudyScene& scene, const RenderSettings& settings, const std::string& group,
                   const std::string& way, const char* source) {
    return {{"scene", scene.name},
            {"light_sampling", to_string(settings.light_sampling)},
            {"group", group},
            {"way", way},
            {"source", source},
            {"width", scene.compiled.width},
            {"height", scene.compiled.height},
            {"samples", settings.end_sample},
            {"threads", settings.threads}};
}

std::vector<Cells> count_rows(const std::string& group, const std::string& way, Render render) {
    const int threads = render.settings.threads;
    const bool is_timed = threads <= core_count();
    render.settings.count_work = true;
    const Measured counted = measure(render);
    render.settings.count_work = false;
    const Measured timed = is_timed ? measure(render) : counted;
    if (timed.hash != counted.hash) throw WrongImage(way + ": the image differs when tests are counted");
    std::vector<Cells> rows;
    for (std::size_t i = 0; i < counted.report.threads.size(); ++i) {
        const ThreadReport& work = counted.report.threads[i];
        rows.push_back(start_of_row(*render.scene, render.settings, group, way, "counted") +
                       Cells{{"thread", i},
                             {"segments", work.segments},
                             {"shadow_rays", work.shadow_rays},
                             {"box_tests", work.box_tests},
                             {"primitive_tests", work.primitive_tests},
                             {"tests", work.box_tests + work.primitive_tests},
                             {"busy_s", is_timed ? Value(timed.report.threads[i].busy_s) : Value()},
                             {"wait_s", is_timed ? Value(timed.report.threads[i].wait_s) : Value()},
                             {"hash", counted.hash}});
    }
    return rows;
}

/// Of the items of a loop by so many threads.
std::vector<Tally> item_tallies(const PathCosts& costs, const ReplayWay& loop, int threads) {
    if (loop.schedule.kind != ReplaySchedule::Kind::Balanced) return costs.items(loop.grain);
    const BalancedItems items(costs.width * costs.height, costs.samples, threads);
    std::vector<Tally> tallies;
    for (std::int64_t i = 0; i < items.count(); ++i)
        tallies.push_back(costs.tally(items.range(i).begin, items.range(i).end));
    return tallies;
}

/// Loops over items that real threads would take as they please, and the pool of the paper's description: all paths of
/// the image, each round in equal shares.
std::vector<Cells> replay_load(const StudyScene& scene, const RenderSettings& settings,
                               const std::vector<LoopWay>& loops) {
    const PathCosts costs = record_costs(scene, settings);
    const int threads = settings.threads;
    std::vector<Cells> rows;
    const auto row = [&](const char* group, const char* way, std::size_t thread, const Tally& tally) {
        return start_of_row(scene, settings, group, way, "replayed") + Cells{{"thread", thread},
                                                                             {"segments", tally.segments},
                                                                             {"shadow_rays", tally.shadow_rays},
                                                                             {"tests", tally.tests()}};
    };
    for (const LoopWay& way : loops) {
        const ReplayWay loop = loop_way(way);
        const Replayed result = prepare(loop, costs, kTests).replay(threads, {}, {});
        std::vector<Tally> work(static_cast<std::size_t>(threads));
        const std::vector<Tally> items = item_tallies(costs, loop, threads);
        for (std::size_t i = 0; i < items.size(); ++i) work[static_cast<std::size_t>(result.owner[i])].add(items[i]);
        for (std::size_t i = 0; i < work.size(); ++i)
            rows.push_back(row("recursion", way.name, i, work[i]) +
                           Cells{{"box_tests", work[i].box_tests}, {"primitive_tests", work[i].primitive_tests}});
    }
    const ReplayWay shares{kShares, ReplayWay::Kind::Drained, {}, {}, 0, 1};
    const std::vector<double> segments = prepare(shares, costs, kSegments).replay(threads, {}, {}).work;
    const std::vector<double> shadow_rays = prepare(shares, costs, kShadowRays).replay(threads, {}, {}).work;
    const std::vector<double> tests = prepare(shares, costs, kTests).replay(threads, {}, {}).work;
    for (std::size_t i = 0; i < segments.size(); ++i)
        rows.push_back(row("pool", kShares, i,
                           {static_cast<std::int64_t>(segments[i]), static_cast<std::int64_t>(tests[i]), 0,
                            static_cast<std::int64_t>(shadow_rays[i])}));
    return rows;
}

void add_cases(std::vector<Case>& cases, const StudyOptions& options, const std::string& scene_name) {
    const auto scene = study_scene(scene_name, choose(options, options.width, {240, 800}));
    Plan plan = plan_of(options, {4, 8}, {3, 5}, 8);
    RenderSettings settings = plan.settings;
    settings.threads = plan.most_threads;
    settings.light_sampling = scene->compiled.features.lights ? LightSampling::Mis : LightSampling::None;
    // Counts do not change from run to run; times do.
    const bool is_timed = settings.threads <= core_count();
    const int repeats = is_timed ? plan.repeats : 1;

    std::vector<LoopWay> replayed;
    const auto add = [&](const std::string& group, const NamedEngine& engine, const LoopWay& way) {
        settings = with_way(settings, way);
        const auto rows = [=, name = std::string(way.name)](const Render& of) { return count_rows(group, name, of); };
        cases.push_back(
            case_of(fmt::format("{}: {}, {}", scene->name, group, way.name), {engine, scene, settings}, repeats, rows));
    };
    for (const LoopWay& way : kLoadWays) {
        if (is_timed || parse_schedule(way.schedule).kind == LoopSchedule::Kind::Static) {
            add("recursion", recursive_engine(), way);
        } else {
            replayed.push_back(way);
        }
    }
    for (wavefront::Rung& rung : wavefront::ladder(settings.threads)) {
        rung.pool.batch_schedule = parse_schedule("static,1");  // so that counts are the same in every run
        add("pool", pool_engine(rung.name, rung.pool), {rung.name, "line", "static,1"});
    }
    add("pool", fused_pool(), {"fused, lines, static", "line", "static"});
    add("pool", fused_pool(), {"fused, pixels, static,1", "pixel", "static,1"});
    cases.push_back({scene->name + ": replayed", "", 1, [=] { return replay_load(*scene, settings, replayed); }});
}

/// Where a scene has lights they are sampled (mis): a shadow ray more at each hit on what is diffuse.
std::vector<Case> load_cases(const StudyOptions& options) {
    std::vector<Case> cases;
    add_cases(cases, options, options.scene);
    if (!options.is_scene_given) add_cases(cases, options, "small_lamp");
    return cases;
}

}  // namespace

Study load_study() {
    return {.name = "load",
            .question =
                "How evenly does each way of sharing out the image load the threads, counted in rays and in "
                "work?",
            .columns =
                {{"scene", ColumnType::Text, "what was rendered"},
                 {"light_sampling", ColumnType::Text, "none, or mis where the scene has lights"},
                 {"group", ColumnType::Text, "recursion or pool"},
                 {"way", ColumnType::Text, "grain and schedule, or rung of the ladder"},
                 {"source", ColumnType::Text,
                  "counted: by a real run of so many threads; replayed: from the counted costs of paths, where a real "
                  "run with more threads than cores would show the operating system's time slices"},
                 {"width", ColumnType::Count,
                  "of the image, pixels: the study's own choice unless --width asks for another"},
                 {"height", ColumnType::Count, "of the image, pixels"},
                 {"samples", ColumnType::Count, "a pixel"},
                 {"threads", ColumnType::Count, "of the loop"},
                 {"thread", ColumnType::Count, "which, from 0"},
                 {"segments", ColumnType::Count, "rays that it traced"},
                 {"shadow_rays", ColumnType::Count, "rays toward lights that it traced beside these"},
                 {"box_tests", ColumnType::Count, "ray against box"},
                 {"primitive_tests", ColumnType::Count, "ray against primitive"},
                 {"tests", ColumnType::Count, "both: the unit of work"},
                 {"busy_s", ColumnType::Real, "working; no more threads than cores only"},
                 {"wait_s", ColumnType::Real, "waiting for others; no more threads than cores only"},
                 {"hash", ColumnType::Text, "counted: of the sums of the image"}},
            .cases = load_cases,
            .facts = rung_facts};
}

}  // namespace raypool::studies
