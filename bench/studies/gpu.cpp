// The paper's Table 3: threads of a CPU against a GPU, by the width of the image.

#include <set>

#include <fmt/format.h>

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
                return Cells{{"device", is_gpu ? Value(found.device) : Value()},
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
    return cases;
}

}  // namespace

Study gpu_study() {
    return {.name = "gpu",
            .question = "How much faster is a GPU than the threads of a CPU, by the width of the image?",
            .columns = render_columns({{"device", ColumnType::Text, "the GPU; empty of a CPU"},
                                       {"kernel_seconds", ColumnType::Real, "of `seconds`, while kernels ran"},
                                       {"segments", ColumnType::Count, "rays traced"}}),
            .cases = gpu_cases};
}

}  // namespace raypool::studies
