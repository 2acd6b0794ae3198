// The time of every schedule: the paper's Figures 9 and 10, and the pools beside them.

#include <omp.h>

#include <algorithm>

#include <fmt/format.h>

#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
#include "bench/studies/studies.h"
#include "bench/studies/verdict.h"
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
constexpr const char* kBasic = kWays[0].name;
constexpr const char* kStatic1 = kWays[3].name;
constexpr const char* kCollapse = kWays[7].name;

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

    [[nodiscard]] Summary summarise(const Table& data, const StudyOptions&) const override {
        Summary summary;
        const std::vector<double> thread_column = data.numbers("threads");
        const int most = static_cast<int>(*std::max_element(thread_column.begin(), thread_column.end()));
        const auto seconds = [&](const Value& engine, const Value& way, int threads) {
            return data.where("engine", engine).where("way", way).where("threads", threads).numbers("seconds");
        };
        for (const Value& engine : data.distinct("engine")) {
            TextTable table{fmt::format("{}, {} threads", engine.get<std::string>(), most),
                            {"way", "seconds", "ratio to basic", "speedup over one thread"},
                            {}};
            for (const Value& way : data.distinct("way")) {
                const std::vector<double> time = seconds(engine, way, most);
                table.rows.push_back({way.get<std::string>(), to_text(spread(time), 3),
                                      to_text(spread(ratios(seconds(engine, kBasic, most), time))),
                                      to_text(spread(ratios(seconds(engine, way, 1), time)))});
            }
            summary.tables.push_back(std::move(table));
        }

        const Value recursive = "recursive";
        const Spread static1 = spread(ratios(seconds(recursive, kBasic, most), seconds(recursive, kStatic1, most)));
        const Spread pixels = spread(ratios(seconds(recursive, kBasic, most), seconds(recursive, kCollapse, most)));
        const auto add = [&](const char* source, const char* claim, const char* paper, const Spread& gain) {
            const bool is_shared = most > 1;
            summary.findings.push_back({source, claim, paper,
                                        fmt::format("{} times as fast, {} threads, width {}", to_text(gain), most,
                                                    data.distinct("width").front().dump()),
                                        is_shared ? is_at_least(gain, 1) : Verdict::CannotTell,
                                        is_shared ? why_open(gain, 1) : "one thread has nothing to share out"});
        };
        add("Figure 9", "static,1 is faster than the default schedule of lines",
            "15 % faster (width 800, 40 spp, depth 125, 8 threads)", static1);
        add("Figure 10", "single pixels (collapse) are faster than the default schedule of lines", "faster", pixels);
        summary.pictures.push_back(
            {"schedules", "Time by schedule",
             "Each bar is the median time of a way to hand out the image, each whisker its lowest and highest "
             "run. Within an engine the bars differ by balance only: the work is the same. What to see: how much "
             "longer the default schedule of lines takes than the others once there is more than one thread."});
        return summary;
    }
};

}  // namespace

std::unique_ptr<Study> schedules_study() {
    return std::make_unique<Schedules>();
}

}  // namespace raypool::studies
