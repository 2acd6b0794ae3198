// Every engine and every rung of the ladder, end to end. A row whose image is not that of the recursive engine is
// skipped with an error, not timed.

#include <memory>
#include <string>

#include "bench/bench_support.h"
#include "bench/paper_scene.h"
#include "recursive/engine.h"
#include "wavefront/engine.h"
#include "wavefront/ladder.h"

namespace raypool {
namespace {

constexpr int kSpp = 16;

/// Room for the samples of all iterations.
Framebuffer empty_framebuffer() {
    return {paper_scene().width, paper_scene().height,
            FixedPoint::make(std::int64_t{kSpp} << 20U, paper_scene().max_radiance)};
}

const std::string& expected_hash() {
    static const std::string hash = [] {
        RenderSettings settings;
        settings.end_sample = kSpp;
        Framebuffer framebuffer = empty_framebuffer();
        recursive::RecursiveEngine().render(paper_scene(), settings, framebuffer);
        return framebuffer.hash();
    }();
    return hash;
}

void render_paper(benchmark::State& state, const Engine& engine, int threads) {
    RenderSettings settings;
    settings.end_sample = kSpp;
    settings.threads = threads;
    settings.schedule = {LoopSchedule::Kind::Dynamic, 0};
    Framebuffer framebuffer = empty_framebuffer();
    RenderReport report = engine.render(paper_scene(), settings, framebuffer);
    if (!agree(state, framebuffer.hash() == expected_hash(), "the image differs from the recursive engine's")) return;
    for (auto _ : state) report = engine.render(paper_scene(), settings, framebuffer);

    count_rays(state, report.segments(), static_cast<double>(wavefront::pool_report(report).record_bytes));
    state.counters["paths/s"] =
        benchmark::Counter(static_cast<double>(report.paths()), benchmark::Counter::kIsIterationInvariantRate);
}

void add(const std::string& name, int threads, const std::shared_ptr<Engine>& engine) {
    add_row("engine/paper/" + name + "/threads:" + std::to_string(threads), [=](benchmark::State& state) {
        render_paper(state, *engine, threads);
    })->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
    using namespace raypool;
    if (!begin_benchmarks(argc, argv)) return 2;
    for (const int threads : {1, 2}) {
        add("recursive", threads, std::make_shared<recursive::RecursiveEngine>());
        add("iterative", threads, std::make_shared<recursive::IterativeEngine>());
        for (const wavefront::Rung& rung : wavefront::ladder(threads))
            add(rung.name, threads, std::make_shared<wavefront::WavefrontEngine>(rung.pool));
    }
    benchmark::RunSpecifiedBenchmarks();
}
