/// How a render is made: three kinds of settings, kept apart.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "core/math/random.h"
#include "core/shading/lights.h"

namespace raypool {

struct CostImage;
class Trace;

/// What the image depends on, beside the scene, the samples and the precision. The key of an image lists all
/// of them by a structured binding, so that none can be forgotten.
struct ImageSettings {
    std::int32_t depth = 50;  ///< most segments of a path, up to path_step::kMostBounces; 0 makes a black image
    std::uint64_t seed = 0;
    Sampler sampler = Sampler::Independent;
    int split_depth = 0;    ///< the first so many hits on glass follow both branches; at most path_step::kMostSplits
    bool roulette = false;  ///< end paths that carry little by chance, without bias (core/shading/roulette.h)
    LightSampling light_sampling = LightSampling::None;
};

/// How a render is handed out to threads: OpenMP's schedule clause; its taskloop, whose grainsize is the chunk; or
/// balanced items (core/runtime/balanced_items.h), whichever thread is free. chunk 0 is OpenMP's default for the kind.
struct LoopSchedule {
    enum class Kind : std::uint8_t { Static, Dynamic, Guided, Tasks, Balanced };
    Kind kind = Kind::Balanced;
    int chunk = 0;  ///< none for balanced items
};

/// Whether the image is cut by the grain; balanced items have a cut of their own.
constexpr bool has_grain(const LoopSchedule& schedule) {
    return schedule.kind != LoopSchedule::Kind::Balanced;
}

/// What one iteration of the parallel loop renders.
struct Grain {
    enum class Kind : std::uint8_t { Pixel, Line, Tile };
    Kind kind = Kind::Line;
    int tile = 16;  ///< edge of a tile in pixels
};

/// The order of the work: no image depends on it.
struct OrderSettings {
    int threads = 1;
    LoopSchedule schedule;  ///< of an engine that loops over the image; so is the grain
    Grain grain;
};

/// Paths finished so far, to be shown. Engines add, in batches; another thread may read at any time.
struct Progress {
    std::atomic<std::int64_t> paths = 0;
    std::atomic<std::int64_t> before = 0;  ///< of these, from a run that is gone on with: they took no time now
};

/// What is watched meanwhile.
struct Instruments {
    bool count_work = false;  ///< count box and primitive tests (slower: with code compiled for every feature)
    bool log_rounds = false;  ///< report the rounds of a wavefront engine; two looks at the clock a stage and batch
    Progress* progress = nullptr;
    Trace* trace = nullptr;           ///< where to put what each thread did when
    CostImage* cost_image = nullptr;  ///< of the image's size: what to add each pixel's cost to
};

struct RenderSettings : ImageSettings, OrderSettings, Instruments {
    std::int64_t first_sample = 0;  ///< samples [first_sample, end_sample) of every pixel
    std::int64_t end_sample = 1;    ///< at most 2^31 - 1
    /// Only these pixels, in rising order (row * width + column); all where null.
    const std::vector<std::uint32_t>* pixels = nullptr;
};

}  // namespace raypool
