#include "cluster/rank_engine.h"

#include <omp.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>

#include "cluster/exchange.h"
#include "cluster/work_units.h"
#include "core/error.h"

namespace raypool::cluster {

namespace {

/// How much slower than it is this rank shall be.
double asked_slowness(int rank) {
    const char* text = std::getenv("RAYPOOL_SLOW_RANK");
    if (text == nullptr) return 1;
    int slow_rank = 0;
    double slowness = 0;
    if (std::sscanf(text, "%d:%lf", &slow_rank, &slowness) != 2 || !(slowness >= 1 && slowness <= 1000))
        throw InputError(fmt::format("RAYPOOL_SLOW_RANK: must be RANK:TIMES, 1 to 1000 times as slow, got {}", text));
    return rank == slow_rank ? slowness : 1;
}

/// The pixels of places [begin, end), rising: of the list or, where there is none, of the image, in spread lines.
template <class Scalar>
std::vector<std::uint32_t> pixels_of(const CompiledScene<Scalar>& scene, const std::vector<std::uint32_t>* list,
                                     std::int64_t begin, std::int64_t end) {
    if (list != nullptr) return {list->begin() + begin, list->begin() + end};
    const SpreadLines lines(scene.height);
    std::vector<std::pair<std::int64_t, std::int64_t>> runs;  // of pixels: first, end
    for (std::int64_t place = begin; place < end;) {
        const std::int64_t x = place % scene.width;
        const std::int64_t size = std::min(scene.width - x, end - place);
        const std::int64_t first = lines.line(place / scene.width) * scene.width + x;
        runs.emplace_back(first, first + size);
        place += size;
    }
    std::sort(runs.begin(), runs.end());
    std::vector<std::uint32_t> pixels;
    pixels.reserve(static_cast<std::size_t>(end - begin));
    for (const auto& [first, last] : runs)
        for (std::int64_t pixel = first; pixel < last; ++pixel) pixels.push_back(static_cast<std::uint32_t>(pixel));
    return pixels;
}

}  // namespace

RankEngine::RankEngine(std::unique_ptr<Engine> engine, Ranks& ranks)
    : engine_(std::move(engine)), ranks_(ranks), slowness_(asked_slowness(ranks.rank())) {}

template <class Scalar>
RenderReport RankEngine::share(const CompiledScene<Scalar>& scene, const RenderSettings& settings,
                               Framebuffer& framebuffer) const {
    const double start = omp_get_wtime();
    const std::int64_t places =
        settings.pixels == nullptr ? scene.pixel_count() : static_cast<std::int64_t>(settings.pixels->size());
    const std::vector<WorkUnit> units =
        work_units({settings.first_sample, settings.end_sample}, places, ranks_.count());
    if (framebuffer.has_squares() && !ranks_.is_first()) clear(framebuffer, settings.pixels);

    RenderReport report;
    const auto work = [&](std::int64_t i) {
        const WorkUnit& unit = units[static_cast<std::size_t>(i)];
        RenderSettings own = settings;
        own.first_sample = unit.samples.first;
        own.end_sample = unit.samples.end;
        own.log_rounds = false;  // they would say nothing of the others' rounds
        std::vector<std::uint32_t> pixels;
        if (unit.end_place - unit.first_place < places) {
            pixels = pixels_of(scene, settings.pixels, unit.first_place, unit.end_place);
            own.pixels = &pixels;
        }
        const RenderReport part = engine_->render(scene, own, framebuffer);
        report.add(part);
        const double idle_until = omp_get_wtime() + (slowness_ - 1) * part.seconds;
        while (omp_get_wtime() < idle_until) continue;  // a slow processor is busy, and leaves its time to nobody
    };
    ranks_.hand_out(static_cast<std::int64_t>(units.size()), work, [&](std::int64_t i) {
        if (settings.progress != nullptr) settings.progress->paths += units[static_cast<std::size_t>(i)].paths();
    });
    if (framebuffer.has_squares()) sum_everywhere(ranks_, framebuffer, settings.pixels);
    report.seconds = omp_get_wtime() - start;
    ranks_.broadcast(std::as_writable_bytes(std::span(&report.seconds, 1)));
    return report;
}

RenderReport RankEngine::render(const CompiledScene<float>& scene, const RenderSettings& settings,
                                Framebuffer& framebuffer) const {
    return share(scene, settings, framebuffer);
}
RenderReport RankEngine::render(const CompiledScene<double>& scene, const RenderSettings& settings,
                                Framebuffer& framebuffer) const {
    return share(scene, settings, framebuffer);
}

}  // namespace raypool::cluster
