/// The stages of a round, for one thread and one batch of records: generate, intersect, shade, accumulate.
///
/// Where recursion follows one path through all of its bounces, a stage takes one bounce of many paths. A batch is a
/// range of a pool; the round loops in rounds.h cut the pool into batches. Survivors
/// of a batch end up at its front.
#pragma once

#include <algorithm>
#include <utility>

#include "core/runtime/engine.h"
#include "core/runtime/loop.h"
#include "core/shading/shade.h"
#include "wavefront/accumulator.h"
#include "wavefront/beam.h"
#include "wavefront/intersect_stage.h"
#include "wavefront/record_stages.h"

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

    /// For batches of at most `most_records`.
    Stages(const RenderContext<Scalar>& context, std::size_t most_records, int thread)
        : Base(context, most_overflow(context, most_records), thread),
          context_(context),
          thread_(thread),
          intersect_(context.scene, context.pool.intersection, most_records),
          sort_scratch_(context.pool.sort == Sort::None ? 0 : most_records),
          converter_(context.fixed) {
        contributions_.reserve(std::max(most_records, kMostContributions) + kBeamRays + kRays);
    }

    /// The memory of one of these.
    static std::size_t bytes(const RenderContext<Scalar>& context, std::size_t most_records) {
        return IntersectStage<features, Real, Work>::bytes(context.scene, most_records) +
               Records::bytes(most_overflow(context, most_records)) +
               (context.pool.sort == Sort::None ? 0 : most_records * sizeof(double)) +
               Contributions<Scalar>::bytes(std::max(most_records, kMostContributions) + kBeamRays + kRays);
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
                records.template append<Real>(first + written, camera_record(lanes), (1U << lanes.count) - 1, end);
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

    /// A counting sort by material kind (misses last) of records and hits. The settings must ask for it.
    void sort_by_material(Records& records, std::size_t first, std::size_t count) {
        constexpr std::size_t kKinds = Material::kKindCount + 1;
        const auto kind = [&](std::size_t i) -> std::size_t {
            const std::int32_t id = stream().primitive_id()[i];
            if (id < 0) return kKinds - 1;
            const auto& row = context_.scene.surfaces[static_cast<std::size_t>(id)];
            const Int<Scalar> code = bits_of<Scalar>(row.value[SurfaceRow<Scalar>::kCode]);
            return static_cast<std::size_t>(SurfaceCode<Int<Scalar>>{code}.material());
        };
        std::size_t place[kKinds + 1] = {};
        for (std::size_t i = 0; i < count; ++i) ++place[kind(i) + 1];
        for (std::size_t k = 1; k <= kKinds; ++k) place[k] += place[k - 1];
        std::uint32_t* order = stream().lists();
        for (std::size_t i = 0; i < count; ++i) order[place[kind(i)]++] = static_cast<std::uint32_t>(i);
        auto* scratch = reinterpret_cast<std::byte*>(sort_scratch_.data());
        records.permute(first, count, order, scratch);
        permute(stream().distance(), order, count, scratch);
        permute(stream().primitive_id(), order, count, scratch);
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
    /// Kept back in the fused camera stage; they fit into the first-level cache.
    static constexpr std::size_t kMostContributions = 1024;

    static std::size_t most_overflow(const RenderContext<Scalar>& context, std::size_t most_records) {
        return context.settings.split_depth > 0 ? most_records : 0;
    }

    RAYPOOL_INLINE RayRecord<Real> camera_record(const CameraLanes<Real>& lanes) const {
        RayRecord<Real> record;
        record.ray = camera_ray<features, Real>(context_.scene.camera, lanes.x, lanes.y, lanes.pixel, lanes.sample,
                                                context_.seed);
        record.throughput = vec3<Real>(Real(1), Real(1), Real(1));
        record.key = {lanes.pixel, lanes.sample};
        record.leaving_id = Uint32<Real>(static_cast<std::uint32_t>(kNoPrimitive));
        record.step = Uint32<Real>(0U);
        record.density = Real(0);
        return record;
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
            record[packets] = camera_record(lanes);
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
        if (contributions_.count() > kMostContributions) accumulate();
        return written;
    }

    /// Ends paths that left or met an emitter, scatters the others, and appends those that go on.
    RAYPOOL_INLINE std::size_t shade(Records& records, std::size_t target, std::size_t end,
                                     const RayRecord<Real>& record, const Hit<Real>& hit, unsigned active) {
        const Mask<Real> is_hit = as_mask<Real>(hit.primitive_id >= Int<Real>(0));
        const unsigned hits = mask_bits(is_hit) & active;
        if (const unsigned misses = active & ~hits; misses != 0) {
            const Vec3<Real> sky = sky_radiance<Real>(context_.scene.sky, record.ray.direction);
            contributions_.template put<Real>(record.key.pixel, product(record.throughput, sky), misses);
        }
        if (hits == 0) return 0;

        const Int<Real> id = select(is_hit, hit.primitive_id, Int<Real>(0));
        LightPart<Real> lights;
        if constexpr (features.lights) {
            lights.sampling = context_.settings.light_sampling;
            lights.arriving_density = record.density;
            lights.may_go_on = !is_deepest(record.step);
        }
        const Scattered<Real> out = scatter<features, Real, splitting>(
            context_.scene, record.ray, hit.t, id, record.throughput, record.key, record.step, context_.seed,
            context_.settings.split_depth, context_.settings.roulette, features.lights ? &lights : nullptr);
        if constexpr (features.lights) {
            if (lights.sampling != LightSampling::None) follow_shadow_rays(record, out, lights, hits);
        }
        if constexpr (features.emissive) {
            if (const unsigned ends = mask_bits(out.is_emitter) & hits; ends != 0)
                contributions_.template put<Real>(record.key.pixel, out.throughput, ends);
        }
        const Uint32<Real> step = record.step + Uint32<Real>(1U);
        const Mask<Real> is_deepest = this->is_deepest(record.step);
        const unsigned alive = mask_bits(out.is_alive && !is_deepest) & hits;
        RayRecord<Real> next = record;
        next.ray.origin = out.start.origin;
        next.leaving_id = id_bits(out.start.leaving_id);
        next.step = step;
        if constexpr (features.lights) next.density = lights.density;
        if constexpr (splitting == Splitting::On) {
            const Uint32<Real> reflected = path_step::reflected_branch<Uint32<Real>>(step);
            const unsigned alive_too = mask_bits(out.is_reflected_alive && !is_deepest) & hits;
            next.ray.direction = out.reflected_direction;
            next.throughput = out.reflected_throughput;
            next.step = reflected;
            overflow_.template append<Real>(overflow_count_, next, alive_too, overflow_count_ + kRays);
            overflow_count_ += static_cast<std::size_t>(std::popcount(alive_too));
            next.step =
                select_bits(mask_bits(out.is_split), reflected + Uint32<Real>(1U << path_step::kBranchShift), step);
        }
        if (alive == 0) return 0;
        next.ray.direction = out.direction;
        next.throughput = out.throughput;
        records.template append<Real>(target, next, alive, end);
        return static_cast<std::size_t>(std::popcount(alive));
    }

    /// Whether the segment that ended at step `step` was the last that the depth allows.
    RAYPOOL_INLINE Mask<Real> is_deepest(const Uint32<Real>& step) const {
        return from_uint32<Real>(path_step::bounce<Uint32<Real>>(step + Uint32<Real>(1U))) >=
               Real(static_cast<Scalar>(context_.settings.depth));
    }

    /// Adds what comes from lights that nothing hides, of the hits in `bits`.
    void follow_shadow_rays(const RayRecord<Real>& record, const Scattered<Real>& out, const LightPart<Real>& lights,
                            unsigned bits) {
        const LightSample<Real>& light = lights.light;
        unsigned free = 0;
        for (unsigned left = mask_bits(lights.has_shadow_ray) & bits; left != 0; left &= left - 1) {
            const int i = std::countr_zero(left);
            ++shadow_rays_;
            const auto part = [i](const Vec3<Real>& v) {
                return vec3<Scalar>(lane(v[0], i), lane(v[1], i), lane(v[2], i));
            };
            const Ray<Scalar> ray{part(out.start.origin), part(light.direction), lane(record.ray.time, i)};
            const Hit<Scalar> at{lane(light.t, i), lane(light.primitive_id, i)};
            const auto leaving_id = static_cast<std::int32_t>(lane(out.start.leaving_id, i));
            if (!is_occluded<features>(context_.scene, ray, leaving_id, at, intersect_.work())) free |= 1U << i;
        }
        if (free != 0) contributions_.template put<Real>(record.key.pixel, lights.radiance, free);
    }

    static Uint32<Real> select_bits(unsigned bits, const Uint32<Real>& yes, const Uint32<Real>& no) {
        if constexpr (Simd<Real>) {
            return Uint32<Real>([&](auto i) { return (bits >> i & 1U) != 0 ? lane(yes, i) : lane(no, i); });
        } else {
            return bits != 0 ? yes : no;
        }
    }
    RAYPOOL_INLINE static Vec3<Real> product(const Vec3<Real>& a, const Vec3<Real>& b) {
        return vec3<Real>(a[0] * b[0], a[1] * b[1], a[2] * b[2]);
    }
    RAYPOOL_INLINE static Uint32<Real> id_bits(const Int<Real>& id) {
        if constexpr (Simd<Real>) {
            return stdx::static_simd_cast<Uint32<Real>>(id);
        } else {
            return static_cast<std::uint32_t>(id);
        }
    }

    template <class T>
    static void permute(T* values, const std::uint32_t* order, std::size_t count, std::byte* scratch) {
        T* sorted = reinterpret_cast<T*>(scratch);
        for (std::size_t i = 0; i < count; ++i) sorted[i] = values[order[i]];
        std::copy_n(sorted, count, values);
    }

    const RenderContext<Scalar>& context_;
    int thread_;
    IntersectStage<features, Real, Work> intersect_;
    Contributions<Scalar> contributions_;
    std::vector<double> sort_scratch_;
    SampleConverter converter_;
    std::int64_t paths_ = 0;
    std::int64_t segments_ = 0;
    std::int64_t shadow_rays_ = 0;
};

}  // namespace raypool::wavefront
