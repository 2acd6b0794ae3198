// A render on up to 10,000 ranks, simulated from recorded costs: where efficiency falls, and why.

#include <algorithm>
#include <bit>
#include <limits>
#include <memory>
#include <numeric>

#include <fmt/format.h>

#include "bench/studies/path_costs.h"
#include "bench/studies/registry.h"
#include "bench/studies/renders.h"
#include "cluster/work_units.h"

namespace raypool::studies {

namespace {

/// A cluster's network of the kind that costs little: 100 Gbit/s, of which a reduction sees the most part.
constexpr double kBytesPerSecond = 10e9;
constexpr double kLatency = 5e-6;      ///< of a message, s
constexpr double kLook = 50e-6;        ///< until rank 0 sees a question, s (cluster/ranks_mpi.cpp sleeps between looks)
constexpr double kServe = 2e-6;        ///< of a question, to the thread that answers, s
constexpr double kPixelBytes = 3 * 8;  ///< of a reduction
constexpr double kSlowSpeed = 0.25;    ///< of one rank, where one is slow
constexpr int kMostRanks = 10000;

/// Seconds of any unit: the recorded samples again and again.
class UnitCosts {
  public:
    UnitCosts(const PathCosts& costs, const CostModel& model) : pixels_(costs.width * costs.height) {
        const cluster::SpreadLines lines(costs.height);
        for (std::int64_t sample = 0; sample < costs.samples; ++sample) {
            std::vector<double>& sums = until_.emplace_back(1);
            for (std::int64_t place = 0; place < pixels_; ++place) {
                const std::int64_t pixel = lines.line(place / costs.width) * costs.width + place % costs.width;
                const std::int64_t path = pixel * costs.samples + sample;
                sums.push_back(sums.back() + model.seconds(costs.tally(path, path + 1)));
            }
        }
    }
    [[nodiscard]] std::int64_t pixels() const { return pixels_; }
    [[nodiscard]] double seconds(const cluster::WorkUnit& unit) const {
        const auto recorded = static_cast<std::int64_t>(until_.size());
        const std::int64_t count = unit.samples.end - unit.samples.first;
        double all = 0;
        double odd = 0;
        for (std::int64_t i = 0; i < recorded; ++i) {
            const std::vector<double>& sums = until_[static_cast<std::size_t>((unit.samples.first + i) % recorded)];
            const double once =
                sums[static_cast<std::size_t>(unit.end_place)] - sums[static_cast<std::size_t>(unit.first_place)];
            all += once;
            if (i < count % recorded) odd += once;
        }
        return static_cast<double>(count / recorded) * all + odd;
    }

  private:
    std::int64_t pixels_;
    std::vector<std::vector<double>> until_;  ///< by recorded sample and place: of the places before
};

/// Seconds of a unit without work, measured: one pixel, in the session of all units. What a rank sets up once and
/// merges once is not in it.
double measure_unit_start(const CompiledScene<float>& scene, RenderSettings settings) {
    constexpr std::int64_t kUnits = 9;
    settings.threads = 1;
    Framebuffer framebuffer(scene.width, scene.height, FixedPoint::make(kUnits, scene.max_radiance));
    const auto session = recursive_engine().engine->begin(scene, settings, framebuffer);
    const std::vector<std::uint32_t> one_pixel{0};
    double least = std::numeric_limits<double>::infinity();
    for (std::int64_t i = 0; i < kUnits; ++i) least = std::min(least, session->add({i, i + 1, &one_pixel}).seconds);
    return least;
}

/// What all cases share.
struct Recording {
    Lazy<UnitCosts> costs;
    Lazy<double> unit_start;
};
std::shared_ptr<Recording> recording_of(const std::shared_ptr<const StudyScene>& scene, const Plan& plan) {
    const auto costs = [=] {
        const PathCosts paths = record_costs(*scene, plan.settings);
        return UnitCosts(paths, fit_costs(*scene, plan.settings, paths, plan.repeats).model);
    };
    const auto unit_start = [=] { return measure_unit_start(scene->compiled, plan.settings); };
    return std::make_shared<Recording>(Recording{Lazy<UnitCosts>(costs), Lazy<double>(unit_start)});
}

Cells simulate(Recording& recording, std::int64_t spp, int ranks) {
    const UnitCosts& costs = recording.costs();
    std::vector<double> items;
    for (const cluster::WorkUnit& unit : cluster::work_units({0, spp}, costs.pixels(), ranks))
        items.push_back(costs.seconds(unit));
    const double work = std::accumulate(items.begin(), items.end(), 0.0);

    const ReplaySchedule in_order{ReplaySchedule::Kind::Dynamic, 1};
    const ReplayCosts all{.fetch = 2 * kLatency + kLook + recording.unit_start(), .serve = kServe};
    const double balanced = replay(items, in_order, ranks).makespan;
    const double shared = replay(items, in_order, ranks, ranks == 1 ? ReplayCosts{} : all).makespan;
    const int levels = static_cast<int>(std::bit_width(static_cast<unsigned>(ranks - 1)));  // ceil(log2(ranks))
    const double reduced = levels * (kLatency + static_cast<double>(costs.pixels()) * kPixelBytes / kBytesPerSecond);
    std::vector<double> speeds{kSlowSpeed};
    speeds.resize(static_cast<std::size_t>(ranks), 1.0);
    const double slow = replay(items, in_order, ranks, ranks == 1 ? ReplayCosts{} : all, speeds).makespan + reduced;
    const double ideal = work / ranks;
    return {{"spp", spp},
            {"ranks", ranks},
            {"units", items.size()},
            {"ideal_s", ideal},
            {"last_units_s", balanced - ideal},
            {"questions_s", shared - balanced},
            {"reduction_s", reduced},
            {"efficiency", ideal / (shared + reduced)},
            {"slow_efficiency", work / (ranks - 1 + kSlowSpeed) / slow}};
}

std::vector<Case> rank_cases(const StudyOptions& options) {
    const auto scene = study_scene(options.scene, choose(options, options.width, {160, 800}));
    const Plan plan = plan_of(options, {2, 4}, {1, 5}, 1);
    const auto recording = recording_of(scene, plan);
    std::vector<Case> cases;
    for (const std::int64_t spp : {100, 1000, 10000, 100000})
        for (int power = 1; power <= kMostRanks; power *= 10)
            for (const int ranks : {power, 2 * power, 5 * power})
                if (ranks <= kMostRanks)
                    cases.push_back({fmt::format("{} spp, {} ranks", spp, ranks), "", 1,
                                     [=] { return std::vector<Cells>{simulate(*recording, spp, ranks)}; }});
    return cases;
}

nlohmann::json rank_facts() {
    return {{"bytes_per_second", kBytesPerSecond},
            {"latency_s", kLatency},
            {"look_s", kLook},
            {"serve_s", kServe},
            {"pixel_bytes", kPixelBytes}};
}

}  // namespace

Study ranks_study() {
    return {.name = "ranks",
            .question = "How far do MPI ranks scale, simulated to 10,000 from recorded costs, and what stops them?",
            .columns = {{"spp", ColumnType::Count, "samples per pixel of the render that is simulated"},
                        {"ranks", ColumnType::Count, "ranks of one thread, of one speed"},
                        {"units", ColumnType::Count, "of work that are handed out"},
                        {"ideal_s", ColumnType::Real, "an equal share of the work, s"},
                        {"last_units_s", ColumnType::Signed,
                         "lost because some have nothing while others end their last unit, s"},
                        {"questions_s", ColumnType::Signed, "lost to asking for units and starting them, s"},
                        {"reduction_s", ColumnType::Real, "of the sums, s"},
                        {"efficiency", ColumnType::Real, "ideal over all of it"},
                        {"slow_efficiency", ColumnType::Real, "the same, with one rank at a quarter of the speed"}},
            .cases = rank_cases,
            .facts = rank_facts};
}

}  // namespace raypool::studies
