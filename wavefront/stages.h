/// The stages of a round, for one thread and one batch of records: generate, intersect, shade, shadow, accumulate.
///
/// Where recursion follows one path through all of its bounces, a stage takes one bounce of many paths. A batch is a
/// range of a pool; the round loops in rounds.h cut the pool into batches. Survivors of a batch end up at its front.
#pragma once

#include <algorithm>
#include <utility>

#include "core/runtime/engine.h"
#include "core/runtime/loop.h"
#include "core/shading/shade.h"
#include "wavefront/accumulator.h"
#include "wavefront/beam.h"
#include "wavefront/intersect_stage.h"
#include "wavefront/material_sort.h"
#include "wavefront/record_stages.h"
#include "wavefront/shadow_stage.h"
#include "wavefront/stage_sizes.h"

namespace raypool::wavefront {

template <Features features, class Real, class Work, Splitting splitting>
class Stages final : public RecordStages<record_features(features), ScalarOf<Real>> {
    using Base = RecordStages<record_features(features), ScalarOf<Real>>;
    using Base::log_;
    using Base::overflow_;
    using Base::overflow_count_;
    using Base::waited_s_;

  public:
    using Scalar = ScalarOf<Real>;
    using typename Base::Records;
    static constexpr int kRays = kLanes<Real>;
    using Shadow = std::conditional_t<features.lights, ShadowStage<features, Real, Work>, NoShadowStage<Scalar>>;

    /// For batches of at most `most_records`.
    Stages(const RenderContext<Scalar>& context, std::size_t most_records, int thread)
        : Stages(context, most_records, sizes(context, most_records), thread) {}

    /// The memory of one of these.
    static std::size_t bytes(const RenderContext<Scalar>& context, std::size_t most_records) {
        const StageSizes size = sizes(context, most_records);
        return StreamLists<Scalar>::bytes(size.list, size.trees) + RayStream<Scalar>::bytes(most_records) +
               Records::bytes(size.overflow) + MaterialSort<Scalar>::bytes(context.pool.sort, most_records) +
               Contributions<Scalar>::bytes(size.contributions) + Shadow::bytes(size.shadow_rays);
    }

    void begin() override {
        log_.begin();
        converter_ = SampleConverter(context_.fixed);
        intersect_.work() = {};
        paths_ = segments_ = shadow_rays_ = 0;
        waited_s_ = 0;
    }

    std::size_t generate(Records& records, std::size_t first, CameraPaths paths) override {
        log_.start();
        const auto count = static_cast<std::size_t>(paths.left());
        paths_ += paths.left();
        const std::size_t end = first + count;
        std::size_t written = 0;
        while (!paths.is_done()) {
            if (context_.pool.camera == CameraStage::Staged) {
                const CameraLanes<Real> lanes = paths.template next<Real>(kRays);
                records.template append<Real>(
                    first + written, camera_record<features, Real>(context_.scene.camera, lanes, context_.seed),
                    (1U << lanes.count) - 1, end);
                written += static_cast<std::size_t>(lanes.count);
            } else {
                written += first_bounce(records, first + written, end, paths);
            }
        }
        accumulate();
        log_.stop(Stage::Generate, count);
        return written;
    }

    std::size_t advance(Records& records, std::size_t first, std::size_t count) override {
        log_.start();
        intersect(records, first, count);
        segments_ += static_cast<std::int64_t>(count);
        log_.stop(Stage::Intersect, count);

        if (context_.pool.sort == Sort::Material) {
            sort_by_material(records, first, count);
            log_.stop(Stage::Sort, count);
        }

        const std::size_t survivors = shade(records, first, count);
        log_.stop(Stage::Shade, count);

        trace_shadow_rays();
        log_.start();
        const std::size_t ends = contributions_.count();
        accumulate();
        log_.stop(Stage::Accumulate, ends);
        log_.advanced(count, survivors + overflow_count_, (count + kRays - 1) / kRays * kRays);
        return survivors;
    }

    // What advance() is made of, in its order, for benchmarks of one stage.
    /// Finds the closest hits of records [first, first + count), which then lie in stream().
    void intersect(const Records& records, std::size_t first, std::size_t count) {
        intersect_.run(records, first, count);
    }

    /// By material. The settings must ask for it.
    void sort_by_material(Records& records, std::size_t first, std::size_t count) {
        sort_.run(context_.scene, records, first, count, stream(), lists_);
    }

    /// Collects what ended as contributions and moves the survivors to the front. Returns how many they are.
    std::size_t shade(Records& records, std::size_t first, std::size_t count) {
        std::size_t survivors = 0;
        for (std::size_t i = 0; i < count; i += kRays) {
            const unsigned active = count - i >= kRays ? (1U << kRays) - 1 : (1U << (count - i)) - 1;
            survivors += shade(records, first + survivors, first + count, records.template load<Real>(first + i),
                               intersect_.hit(i), active);
        }
        return survivors;
    }

    /// Adds the contributions to the framebuffer.
    void accumulate() {
        context_.accumulator->add(contributions_, converter_, thread_);
        contributions_.clear();
    }

    RayStream<Scalar>& stream() { return intersect_.stream(); }
    [[nodiscard]] std::size_t contribution_count() const { return contributions_.count(); }

    void finish() override {
        trace_shadow_rays();
        accumulate();
        log_.finish();
    }

    void report(ThreadReport& work, SampleStatistics& statistics) const override {
        work.paths = paths_;
        work.segments = segments_;
        work.shadow_rays = shadow_rays_;
        work.box_tests = intersect_.work().box_tests;
        work.primitive_tests = intersect_.work().primitive_tests;
        work.wait_s = waited_s_;
        statistics = converter_.statistics();
    }
    [[nodiscard]] std::span<const ListLevel> lists() const override {
        if constexpr (requires(Work work) { work.lists; })
            return intersect_.work().lists;
        else
            return {};
    }

  private:
    Stages(const RenderContext<Scalar>& context, std::size_t most_records, const StageSizes& size, int thread)
        : Base(context, size.overflow, thread),
          context_(context),
          thread_(thread),
          lists_(size.list, size.trees),
          intersect_(context.scene, context.pool.intersection, most_records, lists_),
          shadow_(context.scene, context.pool.intersection, size.shadow_rays, lists_),
          sort_(context.pool.sort, most_records),
          converter_(context.fixed) {
        contributions_.reserve(size.contributions);
    }
    static StageSizes sizes(const RenderContext<Scalar>& context, std::size_t most_records) {
        return stage_sizes<features, Real>(context, most_records);
    }

    /// Takes the next camera rays, of one register or of a beam, through their first bounce. Returns the survivors.
    RAYPOOL_INLINE std::size_t first_bounce(Records& records, std::size_t target, std::size_t end, CameraPaths& paths) {
        constexpr int kPackets = Simd<Real> ? kBeamPackets<Real> : 1;
        RayRecord<Real> record[kPackets];
        WideRays<Real> rays[kPackets];
        Hit<Real> hit[kPackets];
        unsigned active[kPackets];
        const int most = context_.pool.camera == CameraStage::Beam ? kPackets : 1;
        int packets = 0;
        int count = 0;
        for (; packets < most && !paths.is_done(); ++packets) {
            const CameraLanes<Real> lanes = paths.template next<Real>(kRays);
            count += lanes.count;
            active[packets] = (1U << lanes.count) - 1;
            record[packets] = camera_record<features, Real>(context_.scene.camera, lanes, context_.seed);
            rays[packets] = wide_camera_rays<Real>(record[packets].ray);
        }
        if constexpr (Simd<Real>) {
            if (most > 1) {
                closest_hits<features, Real>(context_.scene, rays, hit, packets, count, intersect_.work());
            } else {
                hit[0] = closest_hits<features, Real>(
                    context_.scene, rays[0], lanes_before<Real>(static_cast<std::size_t>(count)), intersect_.work());
            }
        } else {
            hit[0] = closest_hits<features, Real>(context_.scene, rays[0], true, intersect_.work());
        }
        segments_ += count;
        std::size_t written = 0;
        for (int p = 0; p < packets; ++p)
            written += shade(records, target + written, end, record[p], hit[p], active[p]);
        if (contributions_.count() > StageSizes::kKeptContributions) accumulate();
        return written;
    }

    /// Ends paths that left or met an emitter, scatters the others, and appends those that go on.
    RAYPOOL_INLINE std::size_t shade(Records& records, std::size_t target, std::size_t end,
                                     const RayRecord<Real>& record, const Hit<Real>& hit, unsigned active) {
        const Mask<Real> is_hit = as_mask<Real>(hit.primitive_id >= Int<Real>(0));
        const unsigned hits = mask_bits(is_hit) & active;
        if (const unsigned misses = active & ~hits; misses != 0) {
            const Vec3<Real> radiance = escaping_radiance<features, Real>(
                context_.scene, record.ray.direction, record.throughput,
                needed_light_sampling(context_.scene.features, context_.settings), record.density);
            contributions_.template put<Real>(cell_of(record.key), radiance, misses);
        }
        if (hits == 0) return 0;

        const Int<Real> id = select(is_hit, hit.primitive_id, Int<Real>(0));
        LightPart<Real> lights;
        if constexpr (features.lights) {
            lights.sampling = needed_light_sampling(context_.scene.features, context_.settings);
            lights.arriving_density = record.density;
            lights.depth = context_.settings.depth;
        }
        const Scattered<Real> out = scatter<features, Real, splitting>(
            context_.scene, record.ray, hit.t, id, record.throughput, record.key, record.step, context_.seed,
            context_.settings.split_depth, context_.settings.roulette, features.lights ? &lights : nullptr);
        if constexpr (features.lights) {
            if (const unsigned bits = mask_bits(lights.has_shadow_ray) & hits; bits != 0) {
                if (!shadow_.has_room()) {
                    trace_shadow_rays();
                    accumulate();
                }
                shadow_.add(record, out, lights, cell_of(record.key), bits, intersect_.work());
            }
        }
        if constexpr (features.emissive) {
            if (const unsigned ends = mask_bits(out.is_emitter) & hits; ends != 0)
                contributions_.template put<Real>(cell_of(record.key), out.throughput, ends);
        }
        const Uint32<Real> step = record.step + Uint32<Real>(1U);
        const Mask<Real> is_deepest = from_uint32<Real>(path_step::bounce<Uint32<Real>>(step)) >=
                                      Real(static_cast<Scalar>(context_.settings.depth));
        const unsigned alive = mask_bits(out.is_alive && !is_deepest) & hits;
        RayRecord<Real> next = record;
        set_start(next, out.start);
        next.step = step;
        if constexpr (features.lights) next.density = lights.density;
        if constexpr (splitting == Splitting::On) {
            const Uint32<Real> reflected = path_step::reflected_branch<Uint32<Real>>(step);
            const unsigned alive_too = mask_bits(out.is_reflected_alive && !is_deepest) & hits;
            set_start(next, out.reflected_start);
            next.ray.direction = out.reflected_direction;
            next.throughput = out.reflected_throughput;
            next.step = reflected;
            overflow_.template append<Real>(overflow_count_, next, alive_too, overflow_count_ + kRays);
            overflow_count_ += static_cast<std::size_t>(std::popcount(alive_too));
            next.step = select_bits<Real>(mask_bits(out.is_split),
                                          reflected + Uint32<Real>(1U << path_step::kBranchShift), step);
        }
        if (alive == 0) return 0;
        if constexpr (splitting == Splitting::On) set_start(next, out.start);
        next.ray.direction = out.direction;
        next.throughput = out.throughput;
        records.template append<Real>(target, next, alive, end);
        return static_cast<std::size_t>(std::popcount(alive));
    }

    [[nodiscard]] RAYPOOL_INLINE Uint32<Real> cell_of(const PathKey<Real>& key) const {
        return raypool::cell_of<Uint32<Real>>(context_.has_halves, key.pixel, key.sample);
    }

    /// Traces the shadow rays that wait, and adds what they bring.
    void trace_shadow_rays() {
        if constexpr (features.lights) {
            const double begin_s = log_.now();
            const auto [rays, hits] = shadow_.run(contributions_, intersect_.work());
            if (rays == 0) return;
            log_.stop_within(Stage::Shadow, begin_s, rays);
            log_.traced_shadows(rays, hits, (rays + kRays - 1) / kRays * kRays);
            shadow_rays_ += static_cast<std::int64_t>(rays);
        }
    }

    const RenderContext<Scalar>& context_;
    int thread_;
    StreamLists<Scalar> lists_;
    IntersectStage<features, Real, Work> intersect_;
    Shadow shadow_;
    Contributions<Scalar> contributions_;
    MaterialSort<Scalar> sort_;
    SampleConverter converter_;
    std::int64_t paths_ = 0;
    std::int64_t segments_ = 0;
    std::int64_t shadow_rays_ = 0;
};

}  // namespace raypool::wavefront
