/// What the sessions of all pools share: the accumulator, the settings of a unit, the check of the memory, the report.
///
/// All memory is taken when a session is made. A unit takes none, so nothing is thrown where threads wait for each
/// other.
#pragma once

#include <omp.h>

#include <algorithm>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/base/memory.h"
#include "core/runtime/engine.h"
#include "core/runtime/loop.h"
#include "wavefront/accumulator.h"
#include "wavefront/capacity.h"
#include "wavefront/pool_report.h"
#include "wavefront/record_stages.h"
#include "wavefront/stream.h"

namespace raypool::wavefront {

template <class Scalar>
class PoolSession : public RenderSession {
  public:
    PoolSession(const CompiledScene<Scalar>& scene, const RenderSettings& settings, const PoolSettings& pool,
                Framebuffer& framebuffer, std::size_t record_bytes)
        : begin_s_(wall_seconds()),
          settings_(settings),
          pool_(with_capacity(pool, scene, settings.threads)),
          framebuffer_(framebuffer),
          context_{scene,
                   settings_,
                   pool_,
                   random_seed(settings.seed, settings.sampler),
                   framebuffer.fixed_point(),
                   framebuffer.has_halves(),
                   nullptr} {
        const auto own = std::make_shared<PoolReport>();
        own->record_bytes = record_bytes;
        own->pool_rays = capacity();
        report_.engine = own;
    }

  protected:
    /// Renders the unit, which has paths.
    virtual RenderReport run(const RenderUnit& unit) = 0;
    /// What a thread logged of the unit.
    [[nodiscard]] virtual const std::vector<RoundReport>& rounds(std::size_t thread) const = 0;
    [[nodiscard]] virtual std::span<const ListLevel> lists(std::size_t thread) const = 0;

    /// Of a session that is made: the settings' threads are those that OpenMP gives.
    [[nodiscard]] const RenderContext<Scalar>& context() const { return context_; }
    /// Records of a pool. A path can become 2^split_depth of them.
    [[nodiscard]] std::size_t capacity() const {
        return std::max<std::size_t>(static_cast<std::size_t>(pool_.capacity), std::size_t{1} << settings_.split_depth);
    }

    /// Refuses `pool_bytes` for pools and stages, and what the accumulator takes, where there is not as much; where
    /// there is, makes the accumulator. Refuses streams of so many rays that pairs of them with shapes have no numbers.
    void take_memory(std::size_t pool_bytes, std::size_t stream_rays) {
        report_.memory_bytes = pool_bytes + accumulator_bytes(pool_.accumulator, framebuffer_, settings_.threads);
        check_available(report_.memory_bytes,
                        "--pool-rays, --threads, --accumulator: the pools, the stages' memory and the accumulator");
        if (pool_.intersection != Intersection::Single && stream_rays > RayStream<Scalar>::kMostRays)
            throw InputError(fmt::format("--pool-rays, --pool-batch: a stream has at most {} rays, got {}",
                                         RayStream<Scalar>::kMostRays, stream_rays));
        accumulator_ = make_accumulator<Scalar>(pool_.accumulator, framebuffer_, settings_.threads);
        context_.accumulator = accumulator_.get();
    }
    /// Whether threads share pixels in the unit that begins.
    void share_pixels(bool are_shared) { accumulator_->share_pixels(are_shared); }
    /// Calls make(thread) in each thread, and ends the setup.
    template <class Make>
    void finish_setup(Make make) {
        settings_.threads = make_by_threads(settings_, make);
        report_.threads.resize(static_cast<std::size_t>(settings_.threads));
        count_setup(settings_, begin_s_, settings_.threads, report_);
    }

  private:
    static PoolSettings with_capacity(PoolSettings pool, const CompiledScene<Scalar>& scene, int threads) {
        pool.capacity = pool_capacity(pool, scene, threads);
        return pool;
    }

    RenderReport render(const RenderUnit& unit) final {
        if (path_count(context_.scene, unit) == 0) return {};
        RenderReport report = run(unit);
        const auto own = std::make_shared<PoolReport>();
        for (std::size_t thread = 0; thread < report.threads.size(); ++thread) {  // added up by their number
            add_each<RoundReport>(own->rounds, rounds(thread));
            add_each<ListLevel>(own->lists, lists(thread));
        }
        report.engine = own;
        return report;
    }

    RenderReport collect() final {
        if (accumulator_->block_count() == 0) return {};  // it adds to the framebuffer itself
        return run_threads(settings_, [&](ThreadReport&, SampleStatistics&) {
            const double begin = wall_seconds();
#pragma omp for schedule(static) nowait
            for (std::size_t block = 0; block < accumulator_->block_count(); ++block) accumulator_->merge(block);
            if (settings_.trace != nullptr)
                settings_.trace->lane(omp_get_thread_num()).span("merge", begin, wall_seconds());
        });
    }

    double begin_s_;
    RenderSettings settings_;
    PoolSettings pool_;
    Framebuffer& framebuffer_;
    std::unique_ptr<AccumulatorBase<Scalar>> accumulator_;
    RenderContext<Scalar> context_;
};

}  // namespace raypool::wavefront
