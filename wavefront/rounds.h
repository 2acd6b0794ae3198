/// The round loops: the recursive tracer turned inside out.
///
/// Recursion takes one path through all of its bounces before the next path starts. Here a round takes every path of a
/// pool through one bounce, and rounds follow until the pool is empty. SharedPool is the paper's operation pool (He,
/// Song and Zong, "Parallel Ray Tracing with OpenMP"): one pool for all threads, each round an `omp for` over it.
/// ThreadPool is the same loop for one thread by itself, without barriers.
#pragma once

#include <omp.h>

#include "wavefront/append.h"
#include "wavefront/stages.h"

namespace raypool::wavefront {

/// What each thread logged.
using ThreadRounds = std::vector<std::vector<RoundWork>>;

/// Camera paths are brought in this many at a time, a few registers, so that a pool is always nearly full.
inline constexpr std::size_t kCameraChunk = 64;

/// Records that splitting lets grow to at most `capacity`: a path can become 2^split_depth records.
inline std::size_t camera_capacity(std::size_t capacity, int split_depth) {
    return std::max<std::size_t>(capacity >> static_cast<unsigned>(split_depth), 1);
}

/// A pool of one thread. Camera paths are pushed into it; it does rounds whenever it is full.
template <SceneNeeds needs, class Real, class Work, Splitting splitting>
class ThreadPool {
  public:
    using Scalar = ScalarOf<Real>;

    ThreadPool(const RenderContext<Scalar>& context, std::size_t capacity, int thread)
        : context_(context),
          camera_capacity_(camera_capacity(capacity, context.settings.split_depth)),
          records_(capacity),
          stages_(context, capacity, thread) {}

    /// Brings in paths, and makes room for them by rounds.
    void add(CameraPaths paths) {
        while (!paths.is_done()) {
            const std::size_t wanted =
                std::min({kCameraChunk, camera_capacity_, static_cast<std::size_t>(paths.left())});
            if (count_ + wanted > camera_capacity_) {
                do round();
                while (context_.pool.refill == Refill::Drain && count_ > 0);
            } else {
                count_ += stages_.generate(records_, count_, paths.take(static_cast<std::int64_t>(wanted)));
                count_ += stages_.take_overflow(records_, count_);
            }
        }
    }

    /// Rounds until the pool is empty.
    void drain() {
        while (count_ > 0) round();
    }

    Stages<needs, Real, Work, splitting>& stages() { return stages_; }

  private:
    void round() {
        count_ = stages_.advance(records_, 0, count_);
        count_ += stages_.take_overflow(records_, count_);
        stages_.log().occupancy(count_, Trace::Event::Kind::ThreadCounter);
        stages_.log().end_round();
    }

    const RenderContext<Scalar>& context_;
    std::size_t camera_capacity_;
    RayColumns<needs, Scalar> records_;
    std::size_t count_ = 0;
    Stages<needs, Real, Work, splitting> stages_;
};

/// The loop over the image of per-thread pools: work items are handed out by OpenMP, as to the recursive engine.
template <SceneNeeds needs, class Real, class Work, Splitting splitting>
RenderReport render_thread_pools(const RenderContext<ScalarOf<Real>>& context, std::size_t capacity,
                                 ThreadRounds& rounds) {
    const auto& scene = context.scene;
    const RenderSettings& settings = context.settings;
    const WorkItems items(scene.width, scene.height, settings.grain);
    return run_threads(settings, [&](ThreadWork& work, SampleAudit& audit) {
        ThreadPool<needs, Real, Work, splitting> pool(context, capacity, omp_get_thread_num());
        ProgressBatch progress(settings.progress);
        const auto add = [&](const CameraPaths& paths) {
            pool.add(paths);
            progress.add(paths.left());
        };

#pragma omp for schedule(runtime) nowait
        for (std::int64_t item = 0; item < items.count(); ++item) {
            const PixelRange range = items.range(item);
            if (settings.pixels == nullptr) {
                add({range, scene.width, settings.first_sample, settings.end_sample});
            } else {
                for (std::int64_t y = range.y_begin; y < range.y_end; ++y) {
                    const auto line = chosen_between(*settings.pixels, y * scene.width + range.x_begin,
                                                     y * scene.width + range.x_end);
                    add({line, scene.width, settings.first_sample, settings.end_sample});
                }
            }
        }
        pool.drain();
        pool.stages().log().finish();
        pool.stages().report(work, audit);
        rounds[static_cast<std::size_t>(omp_get_thread_num())] = pool.stages().log().rounds();
    });
}

/// The paper's pool: one for all threads, and a barrier after every round.
template <SceneNeeds needs, class Real, class Work, Splitting splitting>
RenderReport render_shared_pool(const RenderContext<ScalarOf<Real>>& context, SharedPool<needs, ScalarOf<Real>>& pool,
                                ThreadRounds& rounds) {
    const auto& scene = context.scene;
    const RenderSettings& settings = context.settings;
    const CameraPaths image(settings, scene.width, scene.height);
    PathCounter camera(image.left());
    RenderSettings loop = settings;
    loop.schedule = context.pool.batch_schedule;

    return run_threads(loop, [&](ThreadWork& work, SampleAudit& audit) {
        Stages<needs, Real, Work, splitting> stages(context, pool.batch(), omp_get_thread_num());
        ProgressBatch progress(settings.progress);

        for (bool is_done = false; !is_done;) {
            const bool takes_camera = pool.is_empty() || context.pool.refill == Refill::Regenerate;

#pragma omp for schedule(runtime) nowait
            for (std::int64_t b = 0; b < pool.batch_count(); ++b) {
                stages.log().start_batch(b);
                // Every record by one bounce; what survives goes on to the next round ...
                const std::size_t survivors = stages.advance(pool.records(), pool.first(b), pool.count(b));
                std::size_t end = stages.pass_on(pool, b, pool.first(b), survivors);

                // ... and camera rays take what room there is.
                for (std::size_t room = takes_camera ? pool.room(b) : 0; room > 0;) {
                    const PathCounter::Part part = camera.take(std::min(room, kCameraChunk));
                    if (part.count == 0) break;
                    const std::size_t made = stages.generate(pool.records(), end, image.part(part.begin, part.count));
                    room -= std::min(room, made + stages.overflow_count());
                    end = stages.pass_on(pool, b, end, made);
                    progress.add(part.count);
                }
            }
            stages.wait();
            stages.end_round(pool);
            stages.wait();
            is_done = pool.is_empty() && camera.is_done();
            stages.wait();
            if (omp_get_thread_num() == 0) stages.log().occupancy(pool.size(), Trace::Event::Kind::Counter);
            stages.log().end_round();
        }
        stages.report(work, audit);
        rounds[static_cast<std::size_t>(omp_get_thread_num())] = stages.log().rounds();
    });
}

}  // namespace raypool::wavefront
