/// Batches of ray records taken from real paths of the paper's scene: camera rays, rays after the first bounce, and
/// deep ones. Frozen once, before anything is timed, and the same in every run.
///
/// StageRig is what it takes to drive the stages of wavefront/stages.h by hand.
#pragma once

#include <cstring>
#include <map>
#include <string>
#include <utility>

#include "bench/paper_scene.h"
#include "wavefront/stages.h"

namespace raypool {

inline constexpr std::int64_t kFrozenSpp = 16;
inline constexpr int kFrozenBatches[] = {4096, 65536};  ///< as a thread works on, and as a whole shared pool

/// The stages of one thread with all that they need; radiance goes to `recorder`, where there is one. Denormals are
/// flushed while it lives, as when an engine renders; rigs of a thread must go in the reverse order of their coming.
template <class Real>
class StageRig {
  public:
    using Stages = wavefront::Stages<kPaper, Real, NoTestCount, Splitting::Off>;

    StageRig(const wavefront::PoolSettings& pool, std::size_t most_records,
             wavefront::AccumulatorBase<float>* recorder = nullptr)
        : pool_(pool),
          framebuffer_(paper_scene().width, paper_scene().height, roomy()),
          accumulator_(wavefront::make_accumulator<float>(pool.accumulator, framebuffer_, 1)),
          context_{paper_scene(),
                   settings_,
                   pool_,
                   random_seed(settings_.seed, settings_.sampler),
                   framebuffer_.fixed_point(),
                   false,
                   recorder != nullptr ? recorder : accumulator_.get()},
          stages_(context_, most_records, 0) {}
    StageRig(const StageRig&) = delete;
    StageRig& operator=(const StageRig&) = delete;

    Stages& stages() { return stages_; }
    /// Of all that was accumulated.
    [[nodiscard]] std::string hash() const { return framebuffer_.hash(); }

    /// Sums for any number of iterations.
    static FixedPoint roomy() { return FixedPoint::make(std::int64_t{1} << 36, paper_scene().max_radiance); }

  private:
    FlushDenormals flush_;
    RenderSettings settings_;
    wavefront::PoolSettings pool_;
    Framebuffer framebuffer_;
    std::unique_ptr<wavefront::AccumulatorBase<float>> accumulator_;
    wavefront::RenderContext<float> context_;
    Stages stages_;
};

/// All camera paths of the image.
inline wavefront::CameraPaths camera_paths() {
    return {{0, paper_scene().width, 0, paper_scene().height}, paper_scene().width, 0, kFrozenSpp};
}

/// Rays by how far their paths have come: least_step to most_step hits.
struct RayKind {
    const char* name;
    int least_step;
    int most_step;
};
inline constexpr RayKind kRayKinds[] = {{"camera", 0, 0}, {"first_bounce", 1, 1}, {"deep", 3, 50}};

namespace detail {

/// Follows pieces of the image, evenly spread over it, each as a pool does that starts there: a chunk of camera paths,
/// and after it the bounces of those that live on, in the order in which the pool has them.
inline Records freeze(const RayKind& kind, std::size_t count) {
    constexpr std::size_t kPieces = 16;
    constexpr std::size_t kChunk = 4096;
    StageRig<Lanes> rig({.camera = wavefront::CameraStage::Staged}, kChunk);
    Records frozen(count);
    Records pool(kChunk);
    const wavefront::CameraPaths image = camera_paths();
    const std::int64_t total = image.left();

    std::size_t filled = 0;
    std::int64_t path = 0;
    for (std::size_t piece = 0; piece < kPieces; ++piece) {
        const std::size_t end = count * (piece + 1) / kPieces;
        path = std::max(path, total * static_cast<std::int64_t>(piece) / std::int64_t{kPieces});
        while (filled < end) {
            const std::int64_t taken = std::min<std::int64_t>(kChunk, total - path);
            RAYPOOL_CHECK(taken > 0, "the scene has too few paths of this kind");
            std::size_t alive = rig.stages().generate(pool, 0, image.part(path, taken));
            path += taken;
            for (int step = 0; alive > 0 && step <= kind.most_step && filled < end; ++step) {
                if (step >= kind.least_step) {
                    const std::size_t wanted = std::min(alive, end - filled);
                    pool.copy_to(frozen, filled, 0, wanted);
                    filled += wanted;
                }
                alive = rig.stages().advance(pool, 0, alive);
            }
        }
    }
    return frozen;
}

}  // namespace detail

inline const Records& frozen_rays(const RayKind& kind, std::size_t count) {
    static std::map<std::pair<std::string, std::size_t>, Records> batches;
    const auto key = std::pair(std::string(kind.name), count);
    auto found = batches.find(key);
    if (found == batches.end()) found = batches.emplace(key, detail::freeze(kind, count)).first;
    return found->second;
}

/// Calls visit(kind, count, name) for every frozen batch; the name is like `deep/65536`.
template <class Visit>
void for_each_frozen_batch(Visit visit) {
    for (const RayKind& kind : kRayKinds)
        for (const int count : kFrozenBatches)
            visit(kind, static_cast<std::size_t>(count), std::string(kind.name) + "/" + std::to_string(count));
}

/// Whether two columns have the same bits.
template <class T>
bool same_bits(const T* a, const T* b, std::size_t count) {
    return std::memcmp(a, b, count * sizeof(T)) == 0;
}

/// Whether the first `count` records have the same bits.
inline bool same_records(const Records& a, const Records& b, std::size_t count) {
    using Record = RayRecord<float>;
    static_assert(sizeof(Record) == sizeof(Ray<float>) + sizeof(Vec3<float>) + 5 * sizeof(float), "no gaps between");
    for (std::size_t i = 0; i < count; ++i) {
        const Record records[] = {a.load<float>(i), b.load<float>(i)};
        if (!same_bits(&records[0], &records[1], 1)) return false;
    }
    return true;
}

}  // namespace raypool
