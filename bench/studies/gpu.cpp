// The paper's Table 3: threads of a CPU against a GPU, by the width of the image; and how full each form keeps the GPU,
// round by round.

#include <set>

#include <fmt/format.h>

#include "bench/studies/gpu_occupancy.h"
#include "bench/studies/path_costs.h"
#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "gpu/engine.h"

#ifdef RAYPOOL_HAS_CUDA
#include "gpu/cuda_device.h"
#endif

namespace raypool::studies {

namespace {

/// None where there is no GPU.
std::vector<NamedEngine> gpu_engines() {
    std::vector<NamedEngine> engines;
#ifdef RAYPOOL_HAS_CUDA
    if (!gpu::has_cuda_device()) return engines;
    for (const gpu::Form form : {gpu::Form::Mega, gpu::Form::MegaRegenerate, gpu::Form::Wave}) {
        gpu::GpuSettings settings;
        settings.form = form;
        engines.push_back({fmt::format("gpu {}", gpu::kFormNames[static_cast<std::size_t>(form)]),
                           std::make_shared<gpu::GpuEngine>(settings, [](int) { return gpu::cuda_device(); })});
    }
#endif
    return engines;
}

/// Threads that a GPU of today holds at once: 132 multiprocessors of 2048.
constexpr std::int64_t kDeviceThreads = 132 * 2048;

/// Rows of every form: which part of its warps' lanes trace a segment, round by round. Counted, on no GPU.
void add_occupancy(std::vector<Case>& cases, const StudyOptions& options) {
    const auto scene = study_scene(options.scene, choose(options, options.width, {48, 800}));
    const Plan plan = plan_of(options, {2, 16}, {1, 1}, core_count());
    const auto lengths = std::make_shared<Lazy<std::vector<std::uint32_t>>>(
        [scene, settings = plan.settings] { return record_costs(*scene, settings).lengths_by_sample(); });
    const std::int64_t paths = scene->compiled.pixel_count() * (plan.settings.end_sample - plan.settings.first_sample);
    // A small image has its paths for no fewer rounds than a large one. Warps are whole.
    const std::int64_t threads = std::min(kDeviceThreads, std::max<std::int64_t>(1, paths / 512) * 32);
    const std::int64_t capacity = std::min(gpu::GpuSettings{}.capacity, threads);
    for (const auto& [form, room] : {std::pair{gpu::Form::Mega, std::int64_t{0}},
                                     {gpu::Form::MegaRegenerate, threads},
                                     {gpu::Form::Wave, capacity}}) {
        const std::string name = fmt::format("gpu {}", gpu::kFormNames[static_cast<std::size_t>(form)]);
        cases.push_back({fmt::format("occupancy of {}", name), "", 1, [=, form = form, room = room] {
                             std::vector<Cells> rows;
                             for (const GpuRound& round : gpu_rounds(form, (*lengths)(), room))
                                 rows.push_back({{"kind", "occupancy"},
                                                 {"engine", name},
                                                 {"width", scene->compiled.width},
                                                 {"room", room == 0 ? Value() : Value(room)},
                                                 {"round", rows.size() + 1},
                                                 {"live", round.live},
                                                 {"lanes", round.lanes}});
                             return rows;
                         }});
    }
}

std::vector<Case> gpu_cases(const StudyOptions& options) {
    constexpr int kPapersThreads = 16;
    const Plan plan = plan_of(options, {2, 16}, {3, 5}, core_count());
    std::vector<std::int64_t> widths{400, 560, 800, 1200, 1600};
    if (options.is_quick) widths = {48, 96};
    if (options.width != 0) widths = {options.width};

    std::vector<Case> cases;
    for (const std::int64_t width : widths) {
        const auto scene = study_scene(options.scene, width);
        const auto add = [&](const NamedEngine& engine, int threads) {
            RenderSettings settings = with_way(plan.settings, {"", "tile:8", "dynamic"});
            settings.threads = threads;
            if (scene->compiled.features.lights) settings.light_sampling = LightSampling::Mis;
            const auto more = [](const RenderReport& report) {
                const gpu::GpuReport& found = gpu::gpu_report(report);
                const bool is_gpu = !found.device.empty();
                return Cells{{"kind", "render"},
                             {"device", is_gpu ? Value(found.device) : Value()},
                             {"kernel_seconds", is_gpu ? Value(found.kernel_s) : Value()},
                             {"segments", report.segments()}};
            };
            cases.push_back(render_case(fmt::format("{} wide: {}, {} threads", width, engine.name, threads),
                                        {engine, scene, settings}, plan.repeats, more));
        };
        for (const int threads : std::set<int>{1, std::min(kPapersThreads, plan.most_threads), plan.most_threads})
            for (const NamedEngine& engine : {recursive_engine(), fused_pool()}) add(engine, threads);
        for (const NamedEngine& engine : gpu_engines()) add(engine, 1);
    }
    add_occupancy(cases, options);
    return cases;
}

}  // namespace

Study gpu_study() {
    return {.name = "gpu",
            .question = "How much faster is a GPU than the threads of a CPU, by the width of the image?",
            .columns = render_columns(
                {{"kind", ColumnType::Text, "render, or occupancy: a round of a form, counted on no GPU"},
                 {"device", ColumnType::Text, "the GPU; empty of a CPU"},
                 {"kernel_seconds", ColumnType::Real, "of `seconds`, while kernels ran"},
                 {"segments", ColumnType::Count, "rays traced"},
                 {"room", ColumnType::Count, "of a round: threads of the device, records of the pool"},
                 {"round", ColumnType::Count, "from 1 on; of all warps in step"},
                 {"live", ColumnType::Count, "paths that trace a segment in it"},
                 {"lanes", ColumnType::Count, "of the warps that have such a path"}}),
            .cases = gpu_cases};
}

}  // namespace raypool::studies
