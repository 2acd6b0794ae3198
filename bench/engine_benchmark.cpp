// Every engine and every rung of the ladder, end to end. A row whose image is not that of the recursive engine is
// skipped with an error, not timed.

#include <memory>
#include <string>

#include "bench/bench_support.h"
#include "core/scene_reader.h"
#include "recursive/engine.h"
#include "wavefront/engine.h"
#include "wavefront/ladder.h"

namespace raypool {
namespace {

constexpr int kSpp = 16;

const CompiledScene<float>& paper() {
    static const CompiledScene<float> scene = compile<float>(builtin_scene("paper"));
    return scene;
}

Framebuffer empty_framebuffer() {
    return {paper().width, paper().height, FixedPoint::make(kSpp, paper().max_radiance)};
}

const std::string& expected_hash() {
    static const std::string hash = [] {
        RenderSettings settings;
        settings.end_sample = kSpp;
        Framebuffer framebuffer = empty_framebuffer();
        recursive::RecursiveEngine().render(paper(), settings, framebuffer);
        return framebuffer.hash();
    }();
    return hash;
}

void render_paper(benchmark::State& state, const std::shared_ptr<Engine>& engine) {
    RenderSettings settings;
    settings.end_sample = kSpp;
    settings.threads = static_cast<int>(state.range(0));
    settings.schedule = {LoopSchedule::Kind::Dynamic, 0};
    Framebuffer framebuffer = empty_framebuffer();
    RenderReport report = engine->render(paper(), settings, framebuffer);
    if (framebuffer.hash() != expected_hash()) {
        state.SkipWithError("the image differs from the recursive engine's");
        return;
    }
    for (auto _ : state) report = engine->render(paper(), settings, framebuffer);

    const auto per_iteration = benchmark::Counter::kIsIterationInvariantRate;
    state.counters["paths/s"] = benchmark::Counter(static_cast<double>(report.paths()), per_iteration);
    state.counters["rays/s"] = benchmark::Counter(static_cast<double>(report.segments()), per_iteration);
    state.counters["bytes/ray"] = static_cast<double>(report.record_bytes);
}

void add(const std::string& name, const std::shared_ptr<Engine>& engine) {
    benchmark::RegisterBenchmark(("engine/paper/" + name).c_str(),
                                 [engine](benchmark::State& state) { render_paper(state, engine); })
        ->ArgName("threads")
        ->Arg(1)
        ->Arg(2)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
    using namespace raypool;
    if (!begin_benchmarks(argc, argv)) return 2;
    add("recursive", std::make_shared<recursive::RecursiveEngine>());
    add("iterative", std::make_shared<recursive::IterativeEngine>());
    for (const wavefront::Rung& rung : wavefront::ladder(1))
        add(rung.name, std::make_shared<wavefront::WavefrontEngine>(rung.pool));
    benchmark::RunSpecifiedBenchmarks();
}
