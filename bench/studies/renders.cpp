#include "bench/studies/renders.h"

#include <omp.h>

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "bench/studies/statistics.h"
#include "core/base/error.h"
#include "core/runtime/settings_text.h"
#include "core/scene/scene_reader.h"
#include "recursive/engine.h"
#include "wavefront/engine.h"
#include "wavefront/ladder.h"

namespace raypool::studies {

namespace {

/// What fixes the image: cases with the same text must have the same hash.
std::string image_of(const Render& render) {
    const StudyScene& scene = *render.scene;
    const RenderSettings& settings = render.settings;
    return fmt::format("{} {} x {}, samples {} to {}, depth {}, split {}, seed {}{}{}{}", scene.name,
                       scene.compiled.width, scene.compiled.height, settings.first_sample, settings.end_sample,
                       settings.depth, settings.split_depth, settings.seed,
                       settings.sampler == Sampler::Sobol ? ", sobol" : "", settings.roulette ? ", roulette" : "",
                       settings.light_sampling == LightSampling::None ? "" : ", " + to_string(settings.light_sampling));
}

}  // namespace

std::shared_ptr<const StudyScene> study_scene(const std::string& name, std::int64_t width) {
    Scene scene = load_scene(name);
    set_width(scene, width);
    return std::make_shared<const StudyScene>(StudyScene{scene.name, compile<float>(scene)});
}

NamedEngine recursive_engine() {
    return {"recursive", std::make_shared<recursive::RecursiveEngine>()};
}
NamedEngine iterative_engine() {
    return {"iterative", std::make_shared<recursive::IterativeEngine>()};
}
NamedEngine fused_pool() {
    return pool_engine("pool", {});
}
NamedEngine canonical_pool() {
    return pool_engine("shared pool", rung_settings("shared-stream", 1));
}
NamedEngine pool_engine(std::string name, const wavefront::PoolSettings& pool) {
    return {std::move(name), std::make_shared<wavefront::WavefrontEngine>(pool)};
}

nlohmann::json rung_facts() {
    nlohmann::json rungs = nlohmann::json::array();
    for (const wavefront::Rung& rung : wavefront::ladder(1))
        rungs.push_back({{"name", rung.name}, {"step", rung.step}});
    return {{"rungs", rungs}};
}

wavefront::PoolSettings rung_settings(const std::string& rung, int threads) {
    const std::vector<wavefront::Rung> rungs = wavefront::ladder(threads);
    const auto found = std::find_if(rungs.begin(), rungs.end(), [&](const auto& r) { return r.name == rung; });
    RAYPOOL_CHECK(found != rungs.end(), "the ladder has the rung");
    return found->pool;
}

RenderSettings with_way(RenderSettings settings, const LoopWay& way) {
    settings.grain = parse_grain(way.grain);
    settings.schedule = parse_schedule(way.schedule);
    return settings;
}

Plan plan_of(const StudyOptions& options, Usual spp, Usual repeats, int most_threads) {
    constexpr std::int32_t kDepth = 50;
    Plan plan;
    plan.settings.end_sample = choose(options, options.spp, spp);
    plan.settings.depth = options.depth != 0 ? static_cast<std::int32_t>(options.depth) : kDepth;
    plan.settings.seed = options.seed;
    plan.repeats = static_cast<int>(choose(options, options.repeats, repeats));
    plan.most_threads = options.threads != 0 ? options.threads : most_threads;
    return plan;
}

void check_threads(int given, int asked) {
    if (given != asked)
        throw InputError(
            fmt::format("--threads: OpenMP gave {} of {} threads (OMP_THREAD_LIMIT, or a parallel region "
                        "around this one)",
                        given, asked));
}

Measured measure(const Engine& engine, const StudyScene& scene, const RenderSettings& settings) {
    const CompiledScene<float>& compiled = scene.compiled;
    const auto image = std::make_shared<Framebuffer>(compiled.width, compiled.height,
                                                     fixed_point(compiled, settings, settings.end_sample));
    RenderReport report = engine.render(compiled, settings, *image);
    check_threads(static_cast<int>(report.threads.size()), settings.threads);
    return {std::move(report), image->hash(), image};
}

std::vector<Column> render_columns(const std::vector<Column>& more) {
    std::vector<Column> columns{
        {"engine", ColumnType::Text, "who rendered"},
        {"threads", ColumnType::Count, "OpenMP threads"},
        {"schedule", ColumnType::Text, "of the loop over the image; empty for a shared pool"},
        {"grain", ColumnType::Text, "what one iteration of that loop renders"},
        {"width", ColumnType::Count, "image width, pixels"},
        {"seconds", ColumnType::Real, "wall clock of the render: setup, loops, last pass"},
        {"mpaths_per_s", ColumnType::Real, "million paths a second"},
        {"load_max_over_mean", ColumnType::Real, "segments of the busiest thread over the mean"},
        {"waiting", ColumnType::Real, "part of the threads' time spent waiting for others"},
        {"hash", ColumnType::Text, "of the sums of the image"}};
    columns.insert(columns.end(), more.begin(), more.end());
    return columns;
}

Cells render_cells(const Render& render, const Measured& measured) {
    const RenderReport& report = measured.report;
    Cells cells{{"engine", render.engine.name},
                {"threads", render.settings.threads},
                {"width", render.scene->compiled.width},
                {"seconds", report.seconds},
                {"mpaths_per_s", static_cast<double>(report.paths()) / report.seconds * 1e-6},
                {"load_max_over_mean", max_over_mean(by_thread(report, &ThreadReport::segments))},
                {"waiting", waiting(report)},
                {"hash", measured.hash}};
    return cells + loop_cells(render.engine.engine->loops_over_image(), render.settings);
}

Cells loop_cells(bool loops_over_image, const RenderSettings& settings) {
    if (!loops_over_image) return {};
    Cells cells{{"schedule", to_string(settings.schedule)}};
    if (has_grain(settings.schedule)) cells.emplace_back("grain", to_string(settings.grain));
    return cells;
}

Case case_of(std::string id, const Render& render, int repeats,
             const std::function<std::vector<Cells>(const Render& render)>& rows) {
    return {std::move(id), image_of(render), repeats, [=] { return rows(render); }};
}
Case render_case(std::string id, const Render& render, int repeats, const MoreCells& more) {
    return case_of(std::move(id), render, repeats, [more](const Render& of) -> std::vector<Cells> {
        const Measured measured = measure(of);
        return {render_cells(of, measured) + more(measured.report)};
    });
}
Case render_case(std::string id, const Render& render, int repeats, const Cells& more) {
    return render_case(std::move(id), render, repeats, [more](const RenderReport&) { return more; });
}

std::vector<int> thread_counts(int most) {
    std::vector<int> counts;
    for (int n = 1; n < most; n *= 2) counts.push_back(n);
    counts.push_back(most);
    return counts;
}

std::vector<int> one_and_all(int most) {
    return most == 1 ? std::vector{1} : std::vector{1, most};
}

int core_count() {
    return std::min(omp_get_num_procs(), omp_get_thread_limit());
}

}  // namespace raypool::studies
