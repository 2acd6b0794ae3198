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
    return {"pool", std::make_shared<wavefront::WavefrontEngine>(wavefront::PoolSettings{})};
}
NamedEngine canonical_pool() {
    return {"shared pool", std::make_shared<wavefront::WavefrontEngine>(rung_settings("shared-stream", 1))};
}
wavefront::PoolSettings rung_settings(const std::string& rung, int threads) {
    const std::vector<wavefront::Rung> rungs = wavefront::ladder(threads);
    const auto found = std::find_if(rungs.begin(), rungs.end(), [&](const auto& r) { return r.name == rung; });
    RAYPOOL_CHECK(found != rungs.end(), "the ladder has the rung");
    return found->pool;
}
std::vector<NamedEngine> ladder_engines(int threads) {
    std::vector<NamedEngine> engines;
    for (const wavefront::Rung& rung : wavefront::ladder(threads))
        engines.push_back({rung.name, std::make_shared<wavefront::WavefrontEngine>(rung.pool)});
    return engines;
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
    Framebuffer framebuffer(compiled.width, compiled.height,
                            FixedPoint::make(settings.end_sample, compiled.max_radiance));
    RenderReport report = engine.render(compiled, settings, framebuffer);
    check_threads(static_cast<int>(report.threads.size()), settings.threads);
    return {std::move(report), framebuffer.hash()};
}

std::string image_of(const StudyScene& scene, const RenderSettings& settings) {
    return fmt::format("{} {} x {}, samples {} to {}, depth {}, split {}, seed {}{}{}", scene.name,
                       scene.compiled.width, scene.compiled.height, settings.first_sample, settings.end_sample,
                       settings.depth, settings.split_depth, settings.seed,
                       settings.sampler == Sampler::Sobol ? ", sobol" : "", settings.roulette ? ", roulette" : "");
}

std::vector<Column> render_columns() {
    return {{"engine", ColumnType::Text, "who rendered"},
            {"threads", ColumnType::Count, "OpenMP threads"},
            {"schedule", ColumnType::Text, "of the loop over the image; empty for a shared pool"},
            {"grain", ColumnType::Text, "what one iteration of that loop renders"},
            {"width", ColumnType::Count, "image width, pixels"},
            {"seconds", ColumnType::Real, "wall clock of the render: setup, loops, last pass"},
            {"mpaths_per_s", ColumnType::Real, "million paths a second"},
            {"load_max_over_mean", ColumnType::Real, "segments of the busiest thread over the mean"},
            {"waiting", ColumnType::Real, "part of the threads' time spent waiting for others"},
            {"hash", ColumnType::Text, "of the sums of the image"}};
}

Row render_row(const std::string& name, const Engine& engine, const StudyScene& scene, const RenderSettings& settings,
               const Measured& measured) {
    const RenderReport& report = measured.report;
    const auto of_loop = [&](const std::string& text) { return engine.loops_over_image() ? Value(text) : Value(); };
    return {name,
            settings.threads,
            of_loop(to_string(settings.schedule)),
            has_grain(settings.schedule) ? of_loop(to_string(settings.grain)) : Value(),
            scene.compiled.width,
            report.seconds,
            static_cast<double>(report.paths()) / report.seconds * 1e-6,
            max_over_mean(by_thread(report, &ThreadReport::segments)),
            waiting(report),
            measured.hash};
}

Case render_case(std::string id, const NamedEngine& engine, const std::shared_ptr<const StudyScene>& scene,
                 const RenderSettings& settings, int repeats, const Row& extra) {
    const auto run = [engine, scene, settings, extra]() -> std::vector<Row> {
        Row row = render_row(engine.name, *engine.engine, *scene, settings, measure(*engine.engine, *scene, settings));
        row.insert(row.end(), extra.begin(), extra.end());
        return {row};
    };
    return {std::move(id), image_of(*scene, settings), repeats, run};
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
