/// What round loops and sessions know of the stages of a thread: which records they work on, and no more. So loops are
/// compiled once for each kind of record, while the stages are compiled for each set of features and each width.
///
/// Stages<...> (stages.h) is behind it. A call is for a batch of records, so that its cost is spread over many.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "core/base/clock.h"
#include "core/runtime/engine.h"
#include "core/runtime/loop.h"
#include "core/shading/interaction.h"
#include "wavefront/camera_paths.h"
#include "wavefront/ray_columns.h"
#include "wavefront/round_log.h"
#include "wavefront/settings.h"
#include "wavefront/wide_ids.h"

namespace raypool::wavefront {

template <class Scalar>
class AccumulatorBase;

/// Has the record's ray start where a surface was met.
template <class Real>
RAYPOOL_INLINE void set_start(RayRecord<Real>& record, const RayStart<Real>& start) {
    record.ray.origin = start.origin;
    record.leaving_id = id_bits<Real>(start.leaving_id);
}

/// What all threads of a render share.
template <class Scalar>
struct RenderContext {
    const SceneView<Scalar>& scene;
    const RenderSettings& settings;
    const PoolSettings& pool;
    RandomSeed seed;
    FixedPoint fixed;
    bool has_halves;  ///< of the framebuffer
    AccumulatorBase<Scalar>* accumulator;
};

/// The stages of one thread, and the records that splitting added, which wait until there is room for them.
template <Features features, class Scalar>
class RecordStages {
  public:
    using Records = RayColumns<features, Scalar>;

    RecordStages(const RenderContext<Scalar>& context, std::size_t most_overflow, int thread)
        : overflow_(most_overflow), log_(context.settings, thread) {}
    RecordStages(const RecordStages&) = delete;
    RecordStages& operator=(const RecordStages&) = delete;
    virtual ~RecordStages() = default;

    /// A unit of the render begins: what report() says is of this unit.
    virtual void begin() = 0;
    /// Brings `paths` into the pool from record `first` on, where there is room for all of them. Returns how many
    /// records that made: one each, or, with the fused camera stage, one for each that survives its first bounce.
    /// Records that splitting added wait in the overflow, here and in advance().
    virtual std::size_t generate(Records& records, std::size_t first, CameraPaths paths) = 0;
    /// Takes records [first, first + count) through one bounce. Returns how many survive, now at the front.
    virtual std::size_t advance(Records& records, std::size_t first, std::size_t count) = 0;
    /// The unit ends: no record is left. What waits is done.
    virtual void finish() = 0;
    virtual void report(ThreadReport& work, SampleStatistics& statistics) const = 0;
    /// By level of the trees; none where they are not counted.
    [[nodiscard]] virtual std::span<const ListLevel> lists() const = 0;

    [[nodiscard]] std::size_t overflow_count() const { return overflow_count_; }
    /// Moves the overflow to record `target`. Returns how many records that were.
    std::size_t take_overflow(Records& records, std::size_t target) {
        if (overflow_count_ == 0) return 0;
        log_.start();
        overflow_.copy_to(records, target, 0, overflow_count_);
        log_.stop(Stage::Append, overflow_count_);
        return std::exchange(overflow_count_, 0);
    }

    /// Enqueues records [first, first + count) of batch b and the overflow in a shared pool. Returns where in the
    /// batch's range the next records may be put.
    template <class Pool>
    std::size_t enqueue(Pool& pool, std::int64_t b, std::size_t first, std::size_t count) {
        log_.start();
        const std::size_t split = std::exchange(overflow_count_, 0);
        const std::size_t end = pool.enqueue(b, first, count, overflow_, split);
        log_.stop(Stage::Append, count + split);
        return end;
    }
    /// This thread's part in what a shared pool does between two rounds.
    template <class Pool>
    void end_round(Pool& pool) {
        log_.start();
        pool.end_round([this] {
            log_.stop(Stage::Append, 0);
            wait();
            log_.start();
        });
        log_.stop(Stage::Append, 0);
    }

    /// Waits for the other threads.
    void wait() {
        const double begin = wall_seconds();
#pragma omp barrier
        const double end = wall_seconds();
        waited_s_ += end - begin;
        log_.waited(begin, end);
    }

    RoundLog& log() {
        return log_;
    }

  protected:
    Records overflow_;
    std::size_t overflow_count_ = 0;
    RoundLog log_;
    double waited_s_ = 0;
};

/// Makes the stages of a render: those that stages_maker() was asked for.
template <Features features, class Scalar>
struct StagesMaker {
    /// For batches of at most `most_records`.
    std::unique_ptr<RecordStages<features, Scalar>> (*make)(const RenderContext<Scalar>&, std::size_t most_records,
                                                            int thread);
    /// The memory of one of these.
    std::size_t (*bytes)(const RenderContext<Scalar>&, std::size_t most_records);
};

}  // namespace raypool::wavefront
