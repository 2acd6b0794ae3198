// Speedup and efficiency by image width, threads and engine: the paper's Tables 1 and 2, Figures 7 and 12.

#include <algorithm>

#include <fmt/format.h>

#include "bench/studies/openmp_costs.h"
#include "bench/studies/renders.h"
#include "bench/studies/replay_ways.h"
#include "bench/studies/studies.h"
#include "wavefront/settings.h"

namespace raypool::studies {

namespace {

constexpr int kMostThreads = 64;

struct Way {
    const char* name;
    enum class Engine : std::uint8_t { Recursive, SharedPool, FusedPool } engine;
    const char* grain;
    const char* schedule;
};
constexpr Way kWays[] = {
    {"recursion, lines, static (the paper's basic)", Way::Engine::Recursive, "line", "static"},
    {"recursion, lines, static,1", Way::Engine::Recursive, "line", "static,1"},
    {"recursion, lines, dynamic", Way::Engine::Recursive, "line", "dynamic"},
    {"a pool for all threads, batches of 4096", Way::Engine::SharedPool, "line", "dynamic"},
    {"a pool for each thread, balanced (default)", Way::Engine::FusedPool, "pixel", "balanced"},
};

NamedEngine engine_of(const Way& way) {
    return way.engine == Way::Engine::Recursive    ? recursive_engine()
           : way.engine == Way::Engine::SharedPool ? canonical_pool()
                                                   : fused_pool();
}

ReplayWay replay_of(const Way& way) {
    if (way.engine == Way::Engine::Recursive) return loop_way(way.name, way.grain, way.schedule);
    const wavefront::PoolSettings pool;
    if (way.engine == Way::Engine::FusedPool)
        return thread_pool_way(way.name, way.grain, way.schedule, pool.kThreadCapacity);
    return {way.name,
            ReplayWay::Kind::Drained,
            {},
            {ReplaySchedule::Kind::Dynamic, 1},
            static_cast<std::size_t>(wavefront::PoolSettings::kSharedCapacity),
            static_cast<std::size_t>(pool.batch)};
}

class Scaling : public Study {
  public:
    [[nodiscard]] std::string name() const override { return "scaling"; }
    [[nodiscard]] std::string question() const override {
        return "How does each engine scale with threads and with the size of the image?";
    }
    [[nodiscard]] std::vector<Column> columns() const override {
        return {{"source", ColumnType::Text, "measured, or replayed (balance, barriers and chunk fetches only)"},
                {"way", ColumnType::Text, "engine, grain and schedule"},
                {"width", ColumnType::Count, "of the image, pixels"},
                {"threads", ColumnType::Count, "real or replayed"},
                {"seconds", ColumnType::Real, "measured: wall clock of the parallel region"},
                {"loop_seconds", ColumnType::Real, "measured: of a compute loop with equal shares, beside the render"},
                {"efficiency", ColumnType::Real, "replayed: speedup over threads"},
                {"hash", ColumnType::Text, "measured: of the sums of the image"}};
    }

    [[nodiscard]] std::vector<Case> cases(const StudyOptions& options) const override {
        std::vector<std::int64_t> widths{400, 560, 800, 1200, 1600};  // the paper's
        if (options.is_quick) widths = {400, 800};
        if (options.width != 0) widths = {std::max<std::int64_t>(options.width / 2, 1), options.width};
        if (widths.front() == widths.back()) widths.pop_back();
        RenderSettings settings;
        settings.end_sample = choose(options.spp, options.is_quick, 2, 2);
        settings.depth = static_cast<std::int32_t>(choose(options.depth, false, 0, 50));
        settings.seed = options.seed;
        const int repeats = static_cast<int>(choose(options.repeats, options.is_quick, 3, 5));
        const int most = static_cast<int>(choose(options.threads, false, 0, kMostThreads));

        std::vector<Case> cases;
        for (const std::int64_t width : widths) {
            const auto scene = study_scene(options.scene, width);
            for (const Way& way : kWays) {
                settings.grain = parse_grain(way.grain);
                settings.schedule = parse_schedule(way.schedule);
                for (const int threads : thread_counts(std::min(core_count(), most))) {
                    settings.threads = threads;
                    cases.push_back({fmt::format("width {}, {} threads, {}", width, threads, way.name),
                                     image_of(*scene, settings), repeats,
                                     [=, this] { return run_real(*scene, settings, way); }});
                }
            }
            cases.push_back({fmt::format("width {}, replayed", width), "", 1,
                             [=, this] { return replay_all(*scene, settings, most); }});
        }
        return cases;
    }

    [[nodiscard]] nlohmann::json facts() const override { return {{"cores", core_count()}}; }

  private:
    std::vector<Row> run_real(const StudyScene& scene, const RenderSettings& settings, const Way& way) const {
        const double loop = compute_loop_seconds(settings.threads, 0.02);
        const Measured measured = measure(*engine_of(way).engine, scene, settings);
        return {sparse_row(columns(), {{"source", "measured"},
                                       {"way", way.name},
                                       {"width", scene.compiled.width},
                                       {"threads", settings.threads},
                                       {"seconds", measured.report.seconds},
                                       {"loop_seconds", loop},
                                       {"hash", measured.hash}})};
    }

    std::vector<Row> replay_all(const StudyScene& scene, const RenderSettings& settings, int most) const {
        const PathCosts costs = record_costs(scene, settings);
        const CostModel model = fit_costs(scene, settings, costs, 2).model;
        const OpenMpCosts openmp = measure_openmp_costs(most);
        std::vector<Row> rows;
        for (const Way& way : kWays) {
            const bool is_pool = way.engine != Way::Engine::Recursive;
            const PreparedWay prepared =
                prepare(replay_of(way), costs,
                        is_pool ? scaled_to(*engine_of(way).engine, scene, settings, costs, model, 2) : model);
            const double one = prepared.replay(1, openmp.at(1)).makespan;
            for (const int threads : thread_counts(most))
                rows.push_back(sparse_row(
                    columns(),
                    {{"source", "replayed"},
                     {"way", way.name},
                     {"width", scene.compiled.width},
                     {"threads", threads},
                     {"efficiency", one / (threads * prepared.replay(threads, openmp.at(threads)).makespan)}}));
        }
        return rows;
    }
};

}  // namespace

std::unique_ptr<Study> scaling_study() {
    return std::make_unique<Scaling>();
}

}  // namespace raypool::studies
