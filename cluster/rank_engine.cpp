#include "cluster/rank_engine.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "cluster/exchange.h"
#include "cluster/work_units.h"
#include "core/base/clock.h"
#include "core/base/error.h"

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

/// One session of the engine renders all units that this rank takes.
template <class Scalar>
class RankSession : public RenderSession {
  public:
    RankSession(const Engine& engine, Ranks& ranks, double slowness, const CompiledScene<Scalar>& scene,
                const RenderSettings& settings, Framebuffer& framebuffer)
        : ranks_(ranks),
          slowness_(slowness),
          scene_(scene),
          progress_(settings.progress),
          framebuffer_(framebuffer),
          session_(engine.begin(scene, without_rounds(settings), framebuffer)),
          is_pending_(framebuffer.has_halves() ? static_cast<std::size_t>(scene.pixel_count()) : 0) {
        report_ = session_->report();
    }

  private:
    /// They would say nothing of the other ranks' rounds.
    static RenderSettings without_rounds(RenderSettings settings) {
        settings.log_rounds = false;
        return settings;
    }

    RenderReport render(const RenderUnit& all) override {
        const double start = wall_seconds();
        const std::int64_t places =
            all.pixels == nullptr ? scene_.pixel_count() : static_cast<std::int64_t>(all.pixels->size());
        const std::vector<WorkUnit> units = work_units({all.first_sample, all.end_sample}, places, ranks_.count());
        if (framebuffer_.has_halves()) await(all.pixels);

        RenderReport report;
        const auto work = [&](std::int64_t i) {
            const WorkUnit& unit = units[static_cast<std::size_t>(i)];
            std::vector<std::uint32_t> pixels;
            const bool is_part = unit.end_place - unit.first_place < places;
            if (is_part) pixels = pixels_of(scene_, all.pixels, unit.first_place, unit.end_place);
            const RenderReport part =
                session_->add({unit.samples.first, unit.samples.end, is_part ? &pixels : all.pixels});
            report.add(part);
            const double idle_until = wall_seconds() + (slowness_ - 1) * part.seconds;
            while (wall_seconds() < idle_until) continue;  // a slow processor is busy, and leaves its time to no other
        };
        ranks_.hand_out(static_cast<std::int64_t>(units.size()), work, [&](std::int64_t i) {
            if (progress_ != nullptr) progress_->paths += units[static_cast<std::size_t>(i)].paths();
        });
        return timed(std::move(report), start);
    }

    RenderReport collect() override {
        const double start = wall_seconds();
        RenderReport report = session_->merge();
        if (framebuffer_.has_halves()) {
            sum_everywhere(ranks_, framebuffer_, pending_);
            for (const std::uint32_t pixel : pending_) is_pending_[pixel] = false;
            pending_.clear();
        }
        return timed(std::move(report), start);
    }

    /// What all ranks waited for is what rank 0 did.
    RenderReport timed(RenderReport report, double start) {
        report.seconds = wall_seconds() - start;
        ranks_.broadcast(std::as_writable_bytes(std::span(&report.seconds, 1)));
        return report;
    }

    /// Pixels whose sums are apart from now on until the next merge(): what they were is kept by rank 0 alone.
    void await(const std::vector<std::uint32_t>* pixels) {
        std::vector<std::uint32_t> more;
        const auto add = [&](std::uint32_t pixel) {
            if (is_pending_[pixel]) return;
            is_pending_[pixel] = true;
            more.push_back(pixel);
        };
        if (pixels == nullptr) {
            for (std::int64_t i = 0; i < scene_.pixel_count(); ++i) add(static_cast<std::uint32_t>(i));
        } else {
            std::for_each(pixels->begin(), pixels->end(), add);
        }
        if (!ranks_.is_first()) clear(framebuffer_, more);
        pending_.insert(pending_.end(), more.begin(), more.end());
    }

    Ranks& ranks_;
    double slowness_;
    const CompiledScene<Scalar>& scene_;
    Progress* progress_;
    Framebuffer& framebuffer_;
    std::unique_ptr<RenderSession> session_;
    std::vector<bool> is_pending_;  ///< by pixel, with second moments
    std::vector<std::uint32_t> pending_;
};

}  // namespace

RankEngine::RankEngine(std::unique_ptr<Engine> engine, Ranks& ranks)
    : engine_(std::move(engine)), ranks_(ranks), slowness_(asked_slowness(ranks.rank())) {}

std::unique_ptr<RenderSession> RankEngine::begin(const CompiledScene<float>& scene, const RenderSettings& settings,
                                                 Framebuffer& framebuffer) const {
    return std::make_unique<RankSession<float>>(*engine_, ranks_, slowness_, scene, settings, framebuffer);
}
std::unique_ptr<RenderSession> RankEngine::begin(const CompiledScene<double>& scene, const RenderSettings& settings,
                                                 Framebuffer& framebuffer) const {
    return std::make_unique<RankSession<double>>(*engine_, ranks_, slowness_, scene, settings, framebuffer);
}

}  // namespace raypool::cluster
