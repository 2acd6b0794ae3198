/// The round loops: the recursive tracer turned inside out.
///
/// Recursion takes one path through all of its bounces before the next path starts. Here a round takes every path of a
/// pool through one bounce, and rounds follow until the pool is empty. SharedPool is the paper's operation pool (He,
/// Song and Zong, "Parallel Ray Tracing with OpenMP"): one pool for all threads, each round an `omp for` over it.
/// ThreadPool is the same loop for one thread by itself, without barriers.
#pragma once

#include <omp.h>

#include "core/base/clock.h"
#include "core/runtime/balanced_items.h"
#include "core/runtime/team_loop.h"
#include "wavefront/append.h"
#include "wavefront/record_stages.h"
#include "wavefront/session.h"

namespace raypool::wavefront {

/// Camera paths are brought in this many at a time, a few registers, so that a pool is always nearly full.
inline constexpr std::size_t kCameraChunk = 64;

/// Records that splitting lets grow to at most `capacity`: a path can become 2^split_depth records.
inline std::size_t camera_capacity(std::size_t capacity, int split_depth) {
    return std::max<std::size_t>(capacity >> static_cast<unsigned>(split_depth), 1);
}

/// A pool of one thread. Camera paths are pushed into it; it does rounds whenever it is full.
template <Features features, class Scalar>
class ThreadPool {
  public:
    ThreadPool(const RenderContext<Scalar>& context, const StagesMaker<features, Scalar>& maker, std::size_t capacity,
               int thread)
        : context_(context),
          camera_capacity_(camera_capacity(capacity, context.settings.split_depth)),
          records_(capacity),
          stages_(maker.make(context, capacity, thread)) {}

    /// The memory of one of these.
    static std::size_t bytes(const RenderContext<Scalar>& context, const StagesMaker<features, Scalar>& maker,
                             std::size_t capacity) {
        return RayColumns<features, Scalar>::bytes(capacity) + maker.bytes(context, capacity);
    }

    /// Brings in paths, and makes room for them by rounds: the pool holds at most `most` records, if it can hold as
    /// many.
    void add(CameraPaths paths, std::int64_t most, ProgressBatch& progress) {
        const std::size_t capacity = std::min(camera_capacity_, static_cast<std::size_t>(most));
        while (!paths.is_done()) {
            const std::size_t wanted = std::min({kCameraChunk, capacity, static_cast<std::size_t>(paths.left())});
            if (count_ + wanted > capacity) {
                do round();
                while (context_.pool.refill == Refill::Drain && count_ > 0);
            } else {
                count_ += stages_->generate(records_, count_, paths.take(static_cast<std::int64_t>(wanted)));
                count_ += stages_->take_overflow(records_, count_);
                progress.add(static_cast<std::int64_t>(wanted));
            }
        }
    }

    /// Rounds until the pool is empty.
    void drain() {
        while (count_ > 0) round();
    }

    RecordStages<features, Scalar>& stages() { return *stages_; }

  private:
    void round() {
        count_ = stages_->advance(records_, 0, count_);
        count_ += stages_->take_overflow(records_, count_);
        stages_->log().occupancy(count_, Trace::Event::Kind::ThreadCounter);
        stages_->log().end_round();
    }

    const RenderContext<Scalar>& context_;
    std::size_t camera_capacity_;
    RayColumns<features, Scalar> records_;
    std::size_t count_ = 0;
    std::unique_ptr<RecordStages<features, Scalar>> stages_;
};

/// The loop over the image of per-thread pools: work items are handed out as to the recursive engine.
template <Features features, class Scalar>
class ThreadPoolSession : public PoolSession<Scalar> {
    using Base = PoolSession<Scalar>;
    using Pool = ThreadPool<features, Scalar>;

  public:
    ThreadPoolSession(const CompiledScene<Scalar>& scene, const RenderSettings& settings, const PoolSettings& pool,
                      Framebuffer& framebuffer, const StagesMaker<features, Scalar>& maker)
        : Base(scene, settings, pool, framebuffer, record_bytes<features, Scalar>()) {
        this->take_memory(
            static_cast<std::size_t>(settings.threads) * Pool::bytes(this->context(), maker, this->capacity()),
            this->capacity());
        pools_.resize(static_cast<std::size_t>(settings.threads));
        this->finish_setup([&](int thread) {
            pools_[static_cast<std::size_t>(thread)] =
                std::make_unique<Pool>(this->context(), maker, this->capacity(), thread);
        });
    }

  private:
    RenderReport run(const RenderUnit& unit) override {
        const auto& scene = this->context().scene;
        const RenderSettings& settings = this->context().settings;
        const double start = wall_seconds();
        if (settings.schedule.kind == LoopSchedule::Kind::Balanced) {
            const BalancedItems items(scene.width, scene.height, unit, settings.threads);
            this->share_pixels(items.splits_pixels());
            const CameraPaths paths(unit, scene.width, scene.height);
            return loop_over(unit, items.count(), start, [&](std::int64_t item, auto add) {
                const PathRange range = items.range(item);
                add(paths.part(range.begin, range.end - range.begin), items.most_held(item));
            });
        }
        const WorkItems items(scene.width, scene.height, settings.grain, unit.pixels);
        const auto most = static_cast<std::int64_t>(this->capacity());
        return loop_over(unit, items.count(), start, [&](std::int64_t item, auto add) {
            if (unit.pixels == nullptr) {
                add(CameraPaths(items.range(item), scene.width, unit.first_sample, unit.end_sample), most);
                return;
            }
            items.for_each_line(item, [&](const LinePixels& line) {
                const std::span pixels(line.list, static_cast<std::size_t>(line.count));
                add(CameraPaths(pixels, scene.width, unit.first_sample, unit.end_sample), most);
            });
        });
    }

    /// Calls visit(item, add) in a thread for each of the items; visit calls add(CameraPaths, most records to hold).
    /// Setup, which takes time for a list of pixels only, began at `start_s`.
    template <class Visit>
    RenderReport loop_over(const RenderUnit& unit, std::int64_t item_count, double start_s, Visit visit) {
        const RenderSettings& settings = this->context().settings;
        TeamLoop loop(settings);
        RenderReport setup;
        if (unit.pixels != nullptr) count_setup(settings, start_s, settings.threads, setup);

        RenderReport report = run_threads(settings, [&](ThreadReport& work, SampleStatistics& statistics) {
            Pool& pool = *pools_[static_cast<std::size_t>(omp_get_thread_num())];
            pool.stages().begin();
            ProgressBatch progress(settings.progress);
            const double waited_s = loop.run(item_count, [&](std::int64_t item) {
                visit(item, [&](const CameraPaths& paths, std::int64_t most) { pool.add(paths, most, progress); });
            });
            pool.drain();
            pool.stages().finish();
            pool.stages().report(work, statistics);
            work.wait_s += waited_s;
        });
        report.add(setup);
        return report;
    }
    [[nodiscard]] const std::vector<RoundReport>& rounds(std::size_t thread) const override {
        return pools_[thread]->stages().log().rounds();
    }
    [[nodiscard]] std::span<const ListLevel> lists(std::size_t thread) const override {
        return pools_[thread]->stages().lists();
    }

    std::vector<std::unique_ptr<Pool>> pools_;  ///< by thread
};

/// The paper's pool: one for all threads, and a barrier after every round. Where camera paths enter as soon as there is
/// free_slots, the last of them leave a pool that only thins out: batches whose records stay in them are then finished,
/// each by one thread, in place of dozens of rounds with nothing in them but barriers.
template <Features features, class Scalar>
class SharedPoolSession : public PoolSession<Scalar> {
    using Base = PoolSession<Scalar>;
    using ThreadStages = RecordStages<features, Scalar>;

  public:
    SharedPoolSession(const CompiledScene<Scalar>& scene, const RenderSettings& settings, const PoolSettings& pool,
                      Framebuffer& framebuffer, const StagesMaker<features, Scalar>& maker)
        : Base(scene, settings, pool, framebuffer, record_bytes<features, Scalar>()) {
        const std::size_t batch = std::clamp<std::size_t>(static_cast<std::size_t>(pool.batch),
                                                          std::size_t{1} << settings.split_depth, this->capacity());
        const PoolShape shape(this->capacity(), batch, settings.split_depth);
        const auto threads = static_cast<std::size_t>(settings.threads);
        this->take_memory(shared_pool_bytes<features, Scalar>(pool.append, shape, settings.threads) +
                              threads * maker.bytes(this->context(), shape.stride),
                          shape.stride);
        pool_ = make_shared_pool<features, Scalar>(pool.append, this->capacity(), batch, settings.split_depth,
                                                   settings.threads);
        stages_.resize(threads);
        this->finish_setup([&](int thread) {
            stages_[static_cast<std::size_t>(thread)] = maker.make(this->context(), pool_->batch(), thread);
        });
    }

  private:
    RenderReport run(const RenderUnit& unit) override {
        const auto& scene = this->context().scene;
        const RenderSettings& settings = this->context().settings;
        const CameraPaths image(unit, scene.width, scene.height);
        PathCounter camera(image.left());
        RenderSettings loop = settings;
        loop.schedule = this->context().pool.batch_schedule;

        // Nothing in here may throw: the other threads would wait at a barrier for ever.
        return run_threads(loop, [&](ThreadReport& work, SampleStatistics& statistics) noexcept {
            const auto thread = static_cast<std::size_t>(omp_get_thread_num());
            SharedPool<features, Scalar>& pool = *pool_;
            ThreadStages& stages = *stages_[thread];
            stages.begin();
            ProgressBatch progress(settings.progress);

            bool finishes = false;
            for (bool is_done = false; !is_done;) {
                const bool takes_camera = pool.is_empty() || this->context().pool.refill == Refill::Regenerate;

#pragma omp for schedule(runtime) nowait
                for (std::int64_t b = 0; b < pool.batch_count(); ++b) {
                    stages.log().start_batch(b);
                    if (finishes) {
                        finish(stages, pool, b);
                        continue;
                    }
                    // Every record by one bounce; what survives goes on to the next round ...
                    const std::size_t survivors = stages.advance(pool.records(), pool.first(b), pool.count(b));
                    std::size_t end = stages.enqueue(pool, b, pool.first(b), survivors);

                    // ... and camera rays take the free slots.
                    for (std::size_t free_slots = takes_camera ? pool.free_slots(b) : 0; free_slots > 0;) {
                        const PathCounter::Part part = camera.take(std::min(free_slots, kCameraChunk));
                        if (part.count == 0) break;
                        const std::size_t made =
                            stages.generate(pool.records(), end, image.part(part.begin, part.count));
                        free_slots -= std::min(free_slots, made + stages.overflow_count());
                        end = stages.enqueue(pool, b, end, made);
                        progress.add(part.count);
                    }
                }
                stages.wait();
                stages.end_round(pool);
                stages.wait();
                is_done = pool.is_empty() && camera.is_done();
                finishes = camera.is_done() && this->context().pool.refill == Refill::Regenerate &&
                           this->context().pool.append == Append::InPlace;
                stages.wait();
                if (thread == 0) stages.log().occupancy(pool.size(), Trace::Event::Kind::Counter);
                stages.log().end_round();
            }
            stages.finish();
            stages.report(work, statistics);
        });
    }
    /// Advances a batch, which has room for all branches of its paths, until it is empty.
    static void finish(ThreadStages& stages, SharedPool<features, Scalar>& pool, std::int64_t b) noexcept {
        const std::size_t first = pool.first(b);
        for (std::size_t count = pool.count(b); count > 0;) {
            count = stages.advance(pool.records(), first, count);
            count += stages.take_overflow(pool.records(), first + count);
            stages.log().go_ahead();
        }
        stages.enqueue(pool, b, first, 0);
    }
    [[nodiscard]] const std::vector<RoundReport>& rounds(std::size_t thread) const override {
        return stages_[thread]->log().rounds();
    }
    [[nodiscard]] std::span<const ListLevel> lists(std::size_t thread) const override {
        return stages_[thread]->lists();
    }

    std::unique_ptr<SharedPool<features, Scalar>> pool_;
    std::vector<std::unique_ptr<ThreadStages>> stages_;  ///< by thread
};

}  // namespace raypool::wavefront
