// What the limit of depth does: which paths and how much light it cuts off, what it costs, and how deep engines can go.

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
#include "bench/studies/studies.h"
#include "bench/studies/truncation.h"
#include "bench/studies/verdict.h"
#include "core/base/error.h"
#include "core/scene/scene_reader.h"

namespace raypool::studies {

namespace {

constexpr std::int64_t kDepths[] = {1, 2, 3, 5, 8, 12, 20, 50, 125};  // 5, 50 and 125 are the paper's
constexpr std::int64_t kVeryDeep[] = {100, 1000, 10'000, 100'000, 1'000'000};
constexpr std::int64_t kReference = 1000;
constexpr std::int64_t kNoiseSpp = 100;
constexpr const char* kSurvival = "survival";
constexpr const char* kTime = "time";
constexpr const char* kDeep = "very deep";
constexpr const char* kFurnace = "furnace";
constexpr const char* kCorridor = "mirror_corridor";
constexpr const char* kRendered = "rendered";
constexpr const char* kRefused = "refused";

/// The corridor of mirrors seen almost along the mirrors' normal, away from what stands in it: 16 paths, a register of
/// single precision, of which none leaves before some 500 000 bounces.
std::shared_ptr<const StudyScene> endless_corridor() {
    constexpr double kSlope = 5e-5;  // the mirrors end after 100 units, at 2 slopes a bounce
    Scene scene = builtin_scene(kCorridor);
    scene.width = scene.height = 4;
    scene.camera.look_at = scene.camera.look_from + Vector3d(-kSlope, 0, -1);
    scene.camera.vertical_fov_degrees = 0.004;
    return std::make_shared<const StudyScene>(StudyScene{scene.name, compile<float>(scene)});
}

/// The grid up to the depth asked for, and that depth itself; all of it where none is asked for.
template <std::size_t n>
std::vector<std::int64_t> depths_up_to(std::int64_t most, const std::int64_t (&grid)[n]) {
    std::vector<std::int64_t> depths(std::begin(grid), std::end(grid));
    if (most == 0) return depths;
    std::erase_if(depths, [&](std::int64_t depth) { return depth >= most; });
    depths.push_back(most);
    return depths;
}

/// A scene at one limit of depth, in two halves of its samples.
struct HalvesRender {
    Halves halves;
    double scale = 0;
    std::int64_t paths = 0;
    std::int64_t segments = 0;
};
HalvesRender render_halves(const StudyScene& scene, RenderSettings settings, std::int64_t depth) {
    const CompiledScene<float>& compiled = scene.compiled;
    const std::int64_t half = settings.end_sample / 2;
    const FixedPoint fixed = FixedPoint::make(settings.end_sample, compiled.max_radiance);
    settings.depth = static_cast<std::int32_t>(depth);
    HalvesRender out;
    out.scale = fixed.scale();
    for (std::vector<std::int64_t>* sums : {&out.halves.first, &out.halves.second}) {
        settings.first_sample = sums == &out.halves.first ? 0 : half;
        settings.end_sample = settings.first_sample + half;
        Framebuffer framebuffer(compiled.width, compiled.height, fixed);
        const RenderReport report = fused_pool().engine->render(compiled, settings, framebuffer);
        sums->assign(framebuffer.sums().begin(), framebuffer.sums().end());
        out.paths += report.paths();
        out.segments += report.segments();
    }
    return out;
}

/// Behind kind, scene, engine, threads, width and depth.
Row start_of_row(const char* kind, const StudyScene& scene, const std::string& engine, const RenderSettings& settings) {
    return {kind, scene.name, engine, settings.threads, scene.compiled.width, settings.depth};
}
void extend(Row& row, const Row& more) {
    row.insert(row.end(), more.begin(), more.end());
}

/// One row for each limit: what is left of the paths, and what is missing of the light of the last. No times.
std::vector<Row> survival_rows(const StudyScene& scene, RenderSettings settings,
                               const std::vector<std::int64_t>& depths) {
    std::map<std::int64_t, HalvesRender> renders;
    const auto at = [&](std::int64_t depth) -> const HalvesRender& {
        const auto found = renders.find(depth);
        return found != renders.end() ? found->second
                                      : renders.emplace(depth, render_halves(scene, settings, depth)).first->second;
    };
    const std::int64_t half = settings.end_sample / 2;
    const HalvesRender& reference = at(depths.back());
    std::vector<Row> rows;
    for (const std::int64_t depth : depths) {
        const HalvesRender& cut = at(depth);
        const Loss loss = truncation_loss(reference.halves, cut.halves, cut.scale, half);
        settings.depth = static_cast<std::int32_t>(depth);
        Row row = start_of_row(kSurvival, scene, "pool", settings);
        extend(row, {cut.paths, cut.segments, nullptr, nullptr, nullptr,
                     alive_share(cut.segments, at(depth + 1).segments, cut.paths), loss.relative, loss.paired_rmse,
                     loss.rmse, noise_rmse(reference.halves, cut.scale, half, kNoiseSpp), kRendered, nullptr, nullptr});
        rows.push_back(std::move(row));
    }
    return rows;
}

Case timed_case(const char* kind, const NamedEngine& engine, const std::shared_ptr<const StudyScene>& scene,
                RenderSettings settings, std::int64_t depth, int repeats) {
    settings.depth = static_cast<std::int32_t>(depth);
    const auto run = [kind, engine, scene, settings]() -> std::vector<Row> {
        Row row = start_of_row(kind, *scene, engine.name, settings);
        const Row no_losses(5, nullptr);
        try {
            const Measured measured = measure(*engine.engine, *scene, settings);
            const RenderReport& report = measured.report;
            const auto segments = static_cast<double>(report.segments());
            extend(row, {report.paths(), report.segments(), report.seconds,
                         1e9 * report.seconds * settings.threads / segments,
                         report.pool_bytes == 0 ? Value(nullptr) : Value(report.pool_bytes)});
            extend(row, no_losses);
            extend(row, {kRendered, nullptr, measured.hash});
        } catch (const InputError& refusal) {
            extend(row, Row(5, nullptr));
            extend(row, no_losses);
            extend(row, {kRefused, refusal.what(), nullptr});
        }
        return {row};
    };
    return {fmt::format("{}: {} at depth {}, {}", kind, scene->name, depth, engine.name), image_of(*scene, settings),
            repeats, run};
}

std::string percent(double share) {
    return share == 0     ? "0"
           : share < 1e-4 ? fmt::format("{:.1e} %", 100 * share)
                          : fmt::format("{:.3g} %", 100 * share);
}

class Depth : public Study {
  public:
    [[nodiscard]] std::string name() const override { return "depth"; }
    [[nodiscard]] std::string question() const override {
        return "What does the limit of depth cut off, what does it cost, and how deep can each engine go?";
    }
    [[nodiscard]] std::vector<Column> columns() const override {
        return {{"kind", ColumnType::Text, "survival (no times), time, or very deep"},
                {"scene", ColumnType::Text, "what was rendered"},
                {"engine", ColumnType::Text, "who rendered"},
                {"threads", ColumnType::Count, "OpenMP threads"},
                {"width", ColumnType::Count, "image width, pixels"},
                {"depth", ColumnType::Count, "most segments of a path"},
                {"paths", ColumnType::Count, "samples of all pixels"},
                {"segments", ColumnType::Count, "rays traced"},
                {"seconds", ColumnType::Real, "wall clock of the render: setup, loops, last pass"},
                {"ns_per_segment", ColumnType::Real, "nanoseconds of a thread for a segment"},
                {"pool_bytes", ColumnType::Count, "of all pools, with their scratch memory"},
                {"alive", ColumnType::Real, "part of the paths that would go on after so many segments"},
                {"lost_light", ColumnType::Signed, "part of the light at the deepest limit that is cut off"},
                {"paired_rmse", ColumnType::Real, "linear radiance, this image against the deepest"},
                {"lost_rmse", ColumnType::Real, "the same of the expected images, free of noise"},
                {"noise_rmse", ColumnType::Real, "linear radiance, of the deepest image with 100 samples a pixel"},
                {"outcome", ColumnType::Text, "rendered, or refused for want of stack"},
                {"refusal", ColumnType::Text, "what the engine said"},
                {"hash", ColumnType::Text, "of the sums of the image"}};
    }

    [[nodiscard]] std::vector<Case> cases(const StudyOptions& options) const override {
        const bool is_quick = options.is_quick;
        RenderSettings settings;
        settings.seed = options.seed;
        std::vector<Case> cases;

        // What is cut off: counted, not timed, so by all cores.
        std::vector<std::int64_t> limits = depths_up_to(options.depth, kDepths);
        if (limits.back() < kReference) limits.push_back(kReference);
        std::vector<std::string> scenes{options.scene, "cornell", "glass_stack", kFurnace};
        scenes.erase(std::remove(scenes.begin() + 1, scenes.end(), options.scene), scenes.end());
        settings.threads = static_cast<int>(choose(options.threads, false, 0, core_count()));
        settings.end_sample = 2 * ((choose(options.spp, is_quick, 16, 128) + 1) / 2);
        for (const std::string& name : scenes) {
            const auto scene = study_scene(name, choose(options.width, is_quick, 120, 160));
            cases.push_back({"survival: " + scene->name, "", 1,
                             [scene, settings, limits] { return survival_rows(*scene, settings, limits); }});
        }

        // What it costs.
        const std::vector<NamedEngine> engines{recursive_engine(), iterative_engine(), canonical_pool(), fused_pool()};
        const int repeats = static_cast<int>(choose(options.repeats, is_quick, 5, 7));
        const auto scene = study_scene(options.scene, choose(options.width, is_quick, 160, 320));
        settings.threads = static_cast<int>(choose(options.threads, false, 0, 1));
        settings.end_sample = choose(options.spp, is_quick, 16, 24);
        for (const std::int64_t depth : depths_up_to(options.depth, kDepths))
            for (const NamedEngine& engine : engines)
                cases.push_back(timed_case(kTime, engine, scene, settings, depth, repeats));

        // How deep they can go.
        const auto corridor = endless_corridor();
        settings.end_sample = 1;
        for (const std::int64_t depth : depths_up_to(choose(options.depth, is_quick, 100'000, 0), kVeryDeep))
            for (const NamedEngine& engine : engines)
                cases.push_back(timed_case(kDeep, engine, corridor, settings, depth, std::min(repeats, 3)));
        return cases;
    }

    [[nodiscard]] Summary summarise(const Table& data, const StudyOptions& options) const override {
        Summary summary;
        for (const Value& scene : data.where("kind", kSurvival).distinct("scene"))
            add_survival(summary, data.where("kind", kSurvival).where("scene", scene), scene.get<std::string>(),
                         options.scene);
        add_times(summary, data.where("kind", kTime), "Nanoseconds of a thread for a segment");
        add_speed(summary, data.where("kind", kTime));
        add_times(summary, data.where("kind", kDeep), "The same of very deep paths between two mirrors");
        add_limits(summary, data.where("kind", kDeep));
        summary.pictures.push_back(
            {"depth_error", "What a limit of depth cuts off",
             "Left: the part of the paths that a limit cuts. Right: the part of the light that is missing for it, "
             "exact "
             "for the paths rendered, since both images are made of the same. Dotted: the paper's depths. What to see: "
             "how deep is enough is up to the scene. " +
                 missing_at_five(data.where("kind", kSurvival)) + "A white furnace loses exactly its paths."});
        summary.pictures.push_back(
            {"depth_time", "Cost of a segment by depth",
             "Thread time, median with the lowest and highest run. Left: the scene of the paper, from camera rays only "
             "to the end of all paths. Right: only 16 paths, between two mirrors, followed without end. What to see: "
             "on the left, how little the limit changes the cost of a segment, and which engine is the cheapest. On "
             "the right, what barriers cost a shared pool of 16 paths; a cross is a depth that recursion refuses, "
             "since its stack cannot hold it."});
        return summary;
    }

  private:
    /// "At depth 5 a fifth is missing": in figures, for the caption.
    static std::string missing_at_five(const Table& survival) {
        std::vector<std::string> parts;
        for (const Value& scene : survival.distinct("scene"))
            for (const double lost : survival.where("scene", scene).where("depth", 5).numbers("lost_light"))
                parts.push_back(fmt::format("{} {}", scene.get<std::string>(), percent(lost)));
        return parts.empty() ? "" : fmt::format("Light missing at depth 5: {}. ", fmt::join(parts, ", "));
    }

    static void add_survival(Summary& summary, const Table& rows, const std::string& scene, const std::string& main) {
        const std::vector<double> depth = rows.numbers("depth");
        const std::vector<double> alive = rows.numbers("alive");
        const std::vector<double> lost = rows.numbers("lost_light");
        const std::vector<double> rmse = rows.numbers("lost_rmse");
        const std::vector<double> paired = rows.numbers("paired_rmse");
        const double noise = rows.numbers("noise_rmse").at(0);
        TextTable table{fmt::format("{}: cut off by the depth (noise of {} spp: RMSE {:.2e})", scene, kNoiseSpp, noise),
                        {"depth", "paths that would go on", "light cut off", "RMSE of that", "RMSE, image to image"},
                        {}};
        for (std::size_t i = 0; i < depth.size(); ++i)
            table.rows.push_back({fmt::format("{}", depth[i]), percent(alive[i]), percent(lost[i]),
                                  fmt::format("{:.2e}", rmse[i]), fmt::format("{:.2e}", paired[i])});
        summary.tables.push_back(std::move(table));

        if (scene == kFurnace) {
            // Every path would bring exactly 1, and at the reference all have come home but those still alive there.
            double worst = 0;
            for (std::size_t i = 0; i < depth.size(); ++i)
                worst = std::max(worst, std::abs((alive[i] - alive.back()) / (1 - alive.back()) - lost[i]));
            summary.findings.push_back(
                {"", "a white furnace loses exactly the share of paths that the limit cuts", "",
                 fmt::format("at depth {}: {} of the paths, {} of the light; largest difference at any depth {:.1e}",
                             depth[0], percent(alive[0]), percent(lost[0]), worst),
                 worst < 1e-9 ? Verdict::Holds : Verdict::DoesNotHold, ""});
        }
        if (scene != main) return;
        std::size_t enough = depth.size();
        while (enough > 0 && rmse[enough - 1] < noise) --enough;
        const std::size_t last = depth.size() < 2 ? 0 : depth.size() - 2;  // the last is the reference itself
        summary.findings.push_back(
            {"",
             fmt::format("{}: the light cut off at a depth of {} is below the noise of {} samples", scene, depth[last],
                         kNoiseSpp),
             "",
             enough == depth.size()
                 ? fmt::format("above it at every depth; noise RMSE {:.2e}", noise)
                 : fmt::format("below it from depth {} on (RMSE {:.2e}, {} of the light; noise {:.2e})", depth[enough],
                               rmse[enough], percent(lost[enough]), noise),
             rmse[last] < noise ? Verdict::Holds : Verdict::DoesNotHold, ""});
    }

    static void add_times(Summary& summary, const Table& rows, const std::string& title) {
        const std::vector<Value> engines = rows.distinct("engine");
        TextTable table{title, {"depth", "segments a path"}, {}};
        for (const Value& engine : engines) table.header.push_back(engine.get<std::string>());
        for (const Value& depth : rows.distinct("depth")) {
            const Table at = rows.where("depth", depth);
            const std::vector<double> segments = at.numbers("segments");
            std::vector<std::string> row{
                fmt::format("{}", depth.get<std::int64_t>()),
                segments.empty() ? "" : fmt::format("{:.2f}", segments[0] / at.numbers("paths").at(0))};
            for (const Value& engine : engines) {
                const std::vector<double> ns = at.where("engine", engine).numbers("ns_per_segment");
                row.push_back(ns.empty() ? kRefused : to_text(spread(ns), 1));
            }
            table.rows.push_back(std::move(row));
        }
        summary.tables.push_back(std::move(table));
    }

    /// Is the pool ahead of recursion at every depth?
    static void add_speed(Summary& summary, const Table& rows) {
        std::vector<std::string> ours;
        bool is_ahead = true;
        bool is_behind = false;
        for (const Value& depth : rows.distinct("depth")) {
            const auto seconds = [&](const char* engine) {
                return rows.where("depth", depth).where("engine", engine).numbers("seconds");
            };
            const std::vector<double> ratio = ratios(seconds("recursive"), seconds("pool"));
            if (ratio.empty()) continue;
            is_ahead &= is_at_least(spread(ratio), 1) == Verdict::Holds;
            is_behind |= is_at_least(spread(ratio), 1) == Verdict::DoesNotHold;
            ours.push_back(fmt::format("{}: {}", depth.get<std::int64_t>(), to_text(spread(ratio))));
        }
        summary.findings.push_back({"", "the fused pool is faster than recursion at every depth", "",
                                    ours.empty() ? "" : fmt::format("depth {}", fmt::join(ours, "; ")),
                                    ours.empty() ? Verdict::CannotTell
                                    : is_ahead   ? Verdict::Holds
                                    : is_behind  ? Verdict::DoesNotHold
                                                 : Verdict::CannotTell,
                                    ours.empty()            ? "recursion was refused"
                                    : is_ahead || is_behind ? ""
                                                            : "too few runs, or their spread includes 1"});
    }

    static void add_limits(Summary& summary, const Table& rows) {
        const std::vector<double> depths = rows.numbers("depth");
        const double deepest = *std::max_element(depths.begin(), depths.end());

        // Memory: what pools asked for, which follows from their capacity.
        std::vector<std::string> bytes;
        for (const char* engine : {"shared pool", "pool"}) {
            const Spread pool = spread(rows.where("engine", engine).numbers("pool_bytes"));
            bytes.push_back(fmt::format("{}: {:.2f} to {:.2f} MB", engine, pool.low * 1e-6, pool.high * 1e-6));
        }
        summary.notes.push_back(
            fmt::format("Memory that pools asked for, up to depth {}: {}.", deepest, fmt::join(bytes, "; ")));

        // Stack.
        const Table refused = rows.where("outcome", kRefused);
        const bool is_recursion_only = refused.where("engine", "recursive").rows().size() == refused.rows().size();
        const std::vector<double> recursed =
            rows.where("engine", "recursive").where("outcome", kRendered).numbers("depth");
        std::string ours =
            recursed.empty() ? "it rendered none of the depths"
                             : fmt::format("it rendered depth {}", *std::max_element(recursed.begin(), recursed.end()));
        if (!refused.is_empty()) {
            const std::vector<double> depths = refused.numbers("depth");
            ours += fmt::format(" and refused depth {}", *std::min_element(depths.begin(), depths.end()));
            summary.notes.push_back(fmt::format("What recursion says: \"{}\"",
                                                refused.rows()[0][refused.index("refusal")].get<std::string>()));
        }
        summary.findings.push_back({"", "recursion refuses what its stack cannot hold; the others go on", "", ours,
                                    refused.is_empty()  ? Verdict::CannotTell
                                    : is_recursion_only ? Verdict::Holds
                                                        : Verdict::DoesNotHold,
                                    refused.is_empty() ? "the stack here holds every depth that was tried" : ""});

        // Time.
        const auto ns = [&](const char* engine) {
            return rows.where("depth", deepest).where("engine", engine).numbers("ns_per_segment");
        };
        const Spread cost = spread(ratios(ns("pool"), ns("iterative")));
        summary.findings.push_back({"", "a segment of a few endless paths costs the fused pool less than the loop", "",
                                    fmt::format("{} times the loop's at depth {}; the shared pool's {}", to_text(cost),
                                                deepest, to_text(spread(ratios(ns("shared pool"), ns("iterative"))))),
                                    cost.high < 1  ? Verdict::Holds
                                    : cost.low > 1 ? Verdict::DoesNotHold
                                                   : Verdict::CannotTell,
                                    cost.low <= 1 && cost.high >= 1 ? "the spread of the runs includes 1" : ""});
    }
};

}  // namespace

std::unique_ptr<Study> depth_study() {
    return std::make_unique<Depth>();
}

}  // namespace raypool::studies
