// The time of every schedule: the paper's Figures 9 and 10, and the pools beside them.

#include <fmt/format.h>

#include "bench/studies/renders.h"
#include "bench/studies/studies.h"
#include "core/runtime/settings_text.h"

namespace raypool::studies {

namespace {

/// A way of handing out the image.
struct Way {
    const char* name;
    const char* grain;
    const char* schedule;
};
constexpr Way kWays[] = {
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

class Schedules : public Study {
  public:
    [[nodiscard]] std::string name() const override { return "schedules"; }
    [[nodiscard]] std::string question() const override {
        return "How much time does each way of handing out the image take, by recursion and by pools?";
    }
    [[nodiscard]] std::vector<Column> columns() const override {
        std::vector<Column> columns = render_columns();
        columns.push_back({"way", ColumnType::Text, "grain and schedule, as the pictures name them"});
        return columns;
    }

    [[nodiscard]] std::vector<Case> cases(const StudyOptions& options) const override {
        const auto scene = study_scene(options.scene, choose(options.width, options.is_quick, 160, 400));
        RenderSettings settings;
        settings.end_sample = choose(options.spp, options.is_quick, 8, 40);
        settings.depth = static_cast<std::int32_t>(choose(options.depth, options.is_quick, 50, 50));
        settings.seed = options.seed;
        const int repeats = static_cast<int>(choose(options.repeats, options.is_quick, 5, 7));
        const int most = static_cast<int>(choose(options.threads, false, 0, core_count()));

        std::vector<Case> cases;
        for (const NamedEngine& engine : {recursive_engine(), fused_pool()}) {
            for (const int threads : thread_counts(most)) {
                for (const Way& way : kWays) {
                    settings.threads = threads;
                    settings.grain = parse_grain(way.grain);
                    settings.schedule = parse_schedule(way.schedule);
                    cases.push_back(render_case(fmt::format("{}, {} threads, {}", engine.name, threads, way.name),
                                                engine, scene, settings, repeats, {way.name}));
                }
            }
        }
        return cases;
    }
};

}  // namespace

std::unique_ptr<Study> schedules_study() {
    return std::make_unique<Schedules>();
}

}  // namespace raypool::studies
