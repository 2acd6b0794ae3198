// The time of every schedule: the paper's Figures 9 and 10, and the pools beside them.

#include <fmt/format.h>

#include "bench/studies/registry.h"
#include "bench/studies/renders.h"

namespace raypool::studies {

namespace {

constexpr LoopWay kWays[] = {
    {"lines, static (the paper's basic)", "line", "static"},
    {"balanced (default)", "pixel", "balanced"},
    {"lines, tasks,1", "line", "tasks,1"},
    {"lines, static,1", "line", "static,1"},
    {"lines, dynamic", "line", "dynamic"},
    {"lines, guided", "line", "guided"},
    {"pixels, static", "pixel", "static"},
    {"pixels, static,1 (the paper's collapse)", "pixel", "static,1"},
    {"pixels, dynamic,64", "pixel", "dynamic,64"},
    {"tiles of 16, dynamic", "tile:16", "dynamic"},
};

std::vector<Case> cases(const StudyOptions& options) {
    const auto scene = study_scene(options.scene, choose(options, options.width, {160, 400}));
    Plan plan = plan_of(options, {8, 40}, {5, 7}, core_count());
    std::vector<Case> cases;
    for (const NamedEngine& engine : {recursive_engine(), fused_pool()}) {
        for (const int threads : thread_counts(plan.most_threads)) {
            plan.settings.threads = threads;
            for (const LoopWay& way : kWays)
                cases.push_back(render_case(fmt::format("{}, {} threads, {}", engine.name, threads, way.name),
                                            {engine, scene, with_way(plan.settings, way)}, plan.repeats,
                                            Cells{{"way", way.name}}));
        }
    }
    return cases;
}

}  // namespace

Study schedules_study() {
    return {.name = "schedules",
            .question = "How much time does each way of handing out the image take, by recursion and by pools?",
            .columns = render_columns({{"way", ColumnType::Text, "grain and schedule, as the pictures name them"}}),
            .cases = cases};
}

}  // namespace raypool::studies
