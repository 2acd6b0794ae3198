// What the limit of depth does: which paths and how much light it cuts off, what it costs, and how deep engines can go.

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "bench/studies/statistics.h"
#include "bench/studies/truncation.h"
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
std::vector<std::int64_t> depths_up_to(std::int64_t most, std::span<const std::int64_t> grid) {
    std::vector<std::int64_t> depths(grid.begin(), grid.end());
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
HalvesRender render_halves(const Render& render, std::int64_t depth) {
    const CompiledScene<float>& compiled = render.scene->compiled;
    RenderSettings settings = render.settings;
    const std::int64_t half = settings.end_sample / 2;
    const FixedPoint fixed = FixedPoint::make(settings.end_sample, compiled.max_radiance);
    settings.depth = static_cast<std::int32_t>(depth);
    HalvesRender out;
    out.scale = fixed.scale();
    for (std::vector<std::int64_t>* sums : {&out.halves.first, &out.halves.second}) {
        settings.first_sample = sums == &out.halves.first ? 0 : half;
        settings.end_sample = settings.first_sample + half;
        Framebuffer framebuffer(compiled.width, compiled.height, fixed);
        const RenderReport report = render.engine.engine->render(compiled, settings, framebuffer);
        sums->assign(framebuffer.sums().begin(), framebuffer.sums().end());
        out.paths += report.paths();
        out.segments += report.segments();
    }
    return out;
}

Cells start_of_row(const char* kind, const Render& render) {
    return {{"kind", kind},
            {"scene", render.scene->name},
            {"engine", render.engine.name},
            {"threads", render.settings.threads},
            {"width", render.scene->compiled.width},
            {"depth", render.settings.depth}};
}

/// One row for each limit: what is left of the paths, and what is missing of the light of the last. No times.
std::vector<Cells> survival_rows(Render render, const std::vector<std::int64_t>& depths) {
    std::map<std::int64_t, HalvesRender> renders;
    const auto at = [&](std::int64_t depth) -> const HalvesRender& {
        HalvesRender& made = renders[depth];
        if (made.paths == 0) made = render_halves(render, depth);
        return made;
    };
    const std::int64_t half = render.settings.end_sample / 2;
    const HalvesRender& reference = at(depths.back());
    std::vector<Cells> rows;
    for (const std::int64_t depth : depths) {
        const HalvesRender& cut = at(depth);
        const Loss loss = truncation_loss(reference.halves, cut.halves, cut.scale, half);
        render.settings.depth = static_cast<std::int32_t>(depth);
        rows.push_back(start_of_row(kSurvival, render) +
                       Cells{{"paths", cut.paths},
                             {"segments", cut.segments},
                             {"alive", alive_share(cut.segments, at(depth + 1).segments, cut.paths)},
                             {"lost_light", loss.relative},
                             {"paired_rmse", loss.paired_rmse},
                             {"lost_rmse", loss.rmse},
                             {"noise_rmse", noise_rmse(reference.halves, cut.scale, half, kNoiseSpp)},
                             {"outcome", kRendered}});
    }
    return rows;
}

Case timed_case(const char* kind, Render render, std::int64_t depth, int repeats) {
    render.settings.depth = static_cast<std::int32_t>(depth);
    const auto rows = [kind](const Render& of) -> std::vector<Cells> {
        Cells row = start_of_row(kind, of);
        try {
            const Measured measured = measure(of);
            const RenderReport& report = measured.report;
            row = row +
                  Cells{{"paths", report.paths()},   {"segments", report.segments()},
                        {"seconds", report.seconds}, {"ns_per_segment", ns_per_segment(report, of.settings.threads)},
                        {"outcome", kRendered},      {"hash", measured.hash}};
            if (report.memory_bytes != 0) row.emplace_back("pool_bytes", report.memory_bytes);
        } catch (const InputError& refusal) {
            row = row + Cells{{"outcome", kRefused}, {"refusal", refusal.what()}};
        }
        return {row};
    };
    return case_of(fmt::format("{}: {} at depth {}, {}", kind, render.scene->name, depth, render.engine.name), render,
                   repeats, rows);
}

std::vector<Case> depth_cases(const StudyOptions& options) {
    const Plan plan = plan_of(options, {16, 24}, {5, 7}, 1);
    RenderSettings settings = plan.settings;
    std::vector<Case> cases;

    // What is cut off: counted, not timed, so by all cores.
    std::vector<std::int64_t> limits = depths_up_to(options.depth, kDepths);
    if (limits.back() < kReference) limits.push_back(kReference);
    std::vector<std::string> scenes{options.scene, "cornell", "glass_stack", kFurnace};
    scenes.erase(std::remove(scenes.begin() + 1, scenes.end(), options.scene), scenes.end());
    settings.threads = options.threads != 0 ? options.threads : core_count();
    settings.end_sample = 2 * ((choose(options, options.spp, {16, 128}) + 1) / 2);
    for (const std::string& name : scenes) {
        const auto scene = study_scene(name, choose(options, options.width, {120, 160}));
        cases.push_back({"survival: " + scene->name, "", 1, [render = Render{fused_pool(), scene, settings}, limits] {
                             return survival_rows(render, limits);
                         }});
    }

    // What it costs.
    const std::vector<NamedEngine> engines{recursive_engine(), iterative_engine(), canonical_pool(), fused_pool()};
    const auto scene = study_scene(options.scene, choose(options, options.width, {160, 320}));
    settings.threads = plan.most_threads;
    settings.end_sample = plan.settings.end_sample;
    for (const std::int64_t depth : depths_up_to(options.depth, kDepths))
        for (const NamedEngine& engine : engines)
            cases.push_back(timed_case(kTime, {engine, scene, settings}, depth, plan.repeats));

    // How deep they can go.
    const auto corridor = endless_corridor();
    settings.end_sample = 1;
    for (const std::int64_t depth : depths_up_to(choose(options, options.depth, {100'000, 0}), kVeryDeep))
        for (const NamedEngine& engine : engines)
            cases.push_back(timed_case(kDeep, {engine, corridor, settings}, depth, std::min(plan.repeats, 3)));
    return cases;
}

}  // namespace

Study depth_study() {
    return {
        .name = "depth",
        .question = "What does the limit of depth cut off, what does it cost, and how deep can each engine go?",
        .columns = {{"kind", ColumnType::Text, "survival (no times), time, or very deep"},
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
                    {"hash", ColumnType::Text, "of the sums of the image"}},
        .cases = depth_cases};
}

}  // namespace raypool::studies
