// Each stage of a round by itself, on frozen rays. Before a stage is timed, a whole round in registers must leave the
// same records and the same sums as one that treats a ray at a time.

#include <algorithm>
#include <vector>

#include "bench/bench_support.h"
#include "bench/frozen_rays.h"
#include "wavefront/setting_names.h"

namespace raypool {
namespace {

using namespace wavefront;

constexpr std::size_t kHitBytes = sizeof(float) + sizeof(std::int32_t);
constexpr std::size_t kContributionBytes = 3 * sizeof(float) + sizeof(std::uint32_t);
constexpr PoolSettings kSorted{.sort = Sort::Material};

/// A copy of a frozen batch, which stages may change.
Records thawed(const RayKind& kind, std::size_t count) {
    Records records(count);
    frozen_rays(kind, count).copy_to(records, 0, 0, count);
    return records;
}

/// What a round left behind.
struct Outcome {
    Records survivors;
    std::size_t count;
    std::string hash;

    bool operator==(const Outcome& other) const {
        return count == other.count && hash == other.hash && same_records(survivors, other.survivors, count);
    }
};

template <class Real>
Outcome round(const RayKind& kind, std::size_t count, const PoolSettings& pool = {}) {
    StageRig<Real> rig(pool, count);
    Records records = thawed(kind, count);
    const std::size_t survivors = rig.stages().advance(records, 0, count);
    return {std::move(records), survivors, rig.hash()};
}

/// Brings in camera paths as a pool does, a chunk at a time, from all over the image.
template <class Real>
std::size_t generate(StageRig<Real>& rig, Records& records, std::size_t count) {
    const CameraPaths image = camera_paths();
    const std::int64_t chunk = 64;
    const std::int64_t chunks = static_cast<std::int64_t>(count) / chunk;
    std::size_t alive = 0;
    for (std::int64_t i = 0; i < chunks; ++i)
        alive += rig.stages().generate(records, alive, image.part(image.left() * i / chunks, chunk));
    return alive;
}

/// Camera paths, and the bounce after them if the camera stage leaves it to the round.
template <class Real>
Outcome camera_round(CameraStage camera, std::size_t count) {
    StageRig<Real> rig({.camera = camera}, count);
    Records records(count);
    std::size_t alive = generate(rig, records, count);
    if (camera == CameraStage::Staged) alive = rig.stages().advance(records, 0, alive);
    return {std::move(records), alive, rig.hash()};
}

void time_generate(benchmark::State& state, CameraStage camera, std::size_t count) {
    const Outcome expected = camera_round<float>(CameraStage::Staged, count);
    if (!agree(state, camera_round<Lanes>(camera, count) == expected, "the paths differ from those made one by one"))
        return;
    StageRig<Lanes> rig({.camera = camera}, count);
    Records records(count);
    for (auto _ : state) benchmark::DoNotOptimize(generate(rig, records, count));
    count_rays(state, static_cast<std::int64_t>(count), record_bytes<kPaper, float>());
}

/// Each of the other stages prepares what it works on by the stages before it.
void time_stage(benchmark::State& state, Stage stage, const RayKind& kind, std::size_t count) {
    const Outcome one_by_one = round<float>(kind, count);
    if (!agree(state, round<Lanes>(kind, count) == one_by_one, "the round differs from that of single rays")) return;

    StageRig<Lanes> rig(stage == Stage::Sort ? kSorted : PoolSettings{}, count);
    auto& stages = rig.stages();
    Records records = thawed(kind, count);
    const auto thaw = [&] { frozen_rays(kind, count).copy_to(records, 0, 0, count); };
    stages.intersect(records, 0, count);
    const std::vector<float> distance(stages.stream().distance(), stages.stream().distance() + count);
    const std::vector<std::int32_t> ids(stages.stream().primitive_id(), stages.stream().primitive_id() + count);
    const auto records_bytes = static_cast<double>(record_bytes<kPaper, float>());
    auto rays = static_cast<std::int64_t>(count);

    if (stage == Stage::Intersect) {
        for (auto _ : state) {
            stages.intersect(records, 0, count);
            benchmark::ClobberMemory();
        }
        count_rays(state, rays, records_bytes + kHitBytes + sizeof(RayRow<float>));
    } else if (stage == Stage::Sort) {
        const Outcome sorted = round<Lanes>(kind, count, kSorted);
        if (!agree(state, sorted.count == one_by_one.count && sorted.hash == one_by_one.hash, "sorting changed sums"))
            return;
        const auto restore = [&] {
            thaw();
            std::copy(distance.begin(), distance.end(), stages.stream().distance());
            std::copy(ids.begin(), ids.end(), stages.stream().primitive_id());
        };
        time_prepared(state, restore, [&] { stages.sort_by_material(records, 0, count); });
        count_rays(state, rays, records_bytes + kHitBytes);
    } else if (stage == Stage::Shade) {
        const auto restore = [&] {
            thaw();
            stages.accumulate();
        };
        time_prepared(state, restore, [&] { stages.shade(records, 0, count); });
        count_rays(state, rays, records_bytes + kHitBytes + kContributionBytes);
    } else {
        const auto shade = [&] {
            thaw();
            stages.shade(records, 0, count);
            rays = static_cast<std::int64_t>(stages.contribution_count());
        };
        time_prepared(state, shade, [&] { stages.accumulate(); });
        count_rays(state, rays, kContributionBytes + 3 * sizeof(std::int64_t));
    }
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
    using namespace raypool;
    if (!begin_benchmarks(argc, argv)) return 2;
    for (const int count : kFrozenBatches) {
        for (const CameraStage camera : {CameraStage::Staged, CameraStage::Fused, CameraStage::Beam}) {
            const std::string name = to_string(camera);
            add_row("stage/generate/" + name + "/" + std::to_string(count),
                    [=](benchmark::State& state) { time_generate(state, camera, static_cast<std::size_t>(count)); });
        }
    }
    for (const Stage stage : {Stage::Intersect, Stage::Sort, Stage::Shade, Stage::Accumulate}) {
        for_each_frozen_batch([&](const RayKind& kind, std::size_t count, const std::string& batch) {
            const std::string name = std::string("stage/") + kStageNames[static_cast<std::size_t>(stage)] + "/" + batch;
            const auto row = [=](benchmark::State& state) { time_stage(state, stage, kind, count); };
            if (stage == Stage::Intersect) {
                add_row(name, row);
            } else {
                add_prepared_row(name, row);
            }
        });
    }
    benchmark::RunSpecifiedBenchmarks();
}
