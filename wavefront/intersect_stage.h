/// The intersection stage: the closest hits of a batch of records, ray by ray or as a stream.
#pragma once

#include <algorithm>

#include "wavefront/ray_columns.h"
#include "wavefront/stream.h"

namespace raypool::wavefront {

/// Of one thread. `Work` counts box and primitive tests, or nothing.
template <Features features, class Real, class Work>
class IntersectStage {
  public:
    using Scalar = ScalarOf<Real>;
    using Records = RayColumns<record_features(features), Scalar>;
    static constexpr int kRays = kLanes<Real>;

    /// For batches of at most `most_records`, as `lists` are, which outlive it.
    IntersectStage(const SceneView<Scalar>& scene, Intersection intersection, std::size_t most_records,
                   const StreamLists<Scalar>& lists)
        : scene_(scene), intersection_(intersection), stream_(most_records), lists_(lists) {}

    /// Finds the closest hits of records [first, first + count), which then lie in stream().
    void run(const Records& records, std::size_t first, std::size_t count) {
        if (intersection_ == Intersection::Single) {
            intersect_single(records, first, count);
        } else {
            intersect_stream(records, first, count);
        }
    }
    /// The hits of records i, i + 1, ... of the batch, a lane each.
    RAYPOOL_INLINE Hit<Real> hit(std::size_t i) {
        if constexpr (Simd<Real>) {
            using Ids = stdx::rebind_simd_t<std::int32_t, Uint32<Real>>;
            const Ids ids(stream_.primitive_id() + i, stdx::element_aligned);
            return {Real(stream_.distance() + i, stdx::element_aligned), stdx::static_simd_cast<Int<Real>>(ids)};
        } else {
            return {stream_.distance()[i], stream_.primitive_id()[i]};
        }
    }

    RayStream<Scalar>& stream() { return stream_; }
    Work& work() { return work_; }
    [[nodiscard]] const Work& work() const { return work_; }

  private:
    void intersect_single(const Records& records, std::size_t first, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            const RayRecord<Scalar> record = records.template load<Scalar>(first + i);
            const Hit<Scalar> hit =
                closest_hit<features>(scene_, record.ray, static_cast<std::int32_t>(record.leaving_id), work_);
            stream_.distance()[i] = hit.t;
            stream_.primitive_id()[i] = static_cast<std::int32_t>(hit.primitive_id);
        }
    }

    void intersect_stream(const Records& records, std::size_t first, std::size_t count) {
        if constexpr (!Simd<Real>) {
            intersect_single(records, first, count);  // a stream of one lane is a single ray
        } else {
            const bool has_pairs = intersection_ == Intersection::Pairs;
            for (std::size_t i = 0; i < count; i += kRays) {
                const RayRecord<Real> record = records.template load<Real>(first + i);
                const WideRays<Real> rays = wide_rays<Real>(record.ray, record.leaving_id);
                const auto lanes = static_cast<int>(std::min<std::size_t>(kRays, count - i));
                Hit<Real> hit;
                if constexpr (features.planar) intersect_all<features>(scene_.planes, rays, lanes, hit, work_);
                if (!has_pairs) intersect_all<features>(scene_.large_spheres, rays, lanes, hit, work_);
                store_row(i, rays, hit);
            }
            if (has_pairs) {
                for (const auto& block : scene_.large_spheres) pair_with_all(block, records, first, count);
            }
            const StreamHits<Scalar> hits = stream_.hits();
            if constexpr (features.planar)
                detail::walk_stream<features, Real>(scene_.quad_tree, hits, count, lists_, intersection_, work_);
            if constexpr (features.triangles) {
                detail::walk_stream<features, Real>(scene_.triangle_tree, hits, count, lists_, intersection_, work_);
                detail::walk_stream<features, Real>(scene_.instance_tree, hits, count, lists_, intersection_, work_);
            }
            detail::walk_stream<features, Real>(scene_.sphere_tree, hits, count, lists_, intersection_, work_);
        }
    }

    /// Spheres that every ray tests.
    void pair_with_all(const auto& block, const Records& records, std::size_t first,
                       std::size_t count) requires Simd<Real> {
        SpherePairs<Scalar> pairs(block, lists_.data());
        for (std::size_t i = 0; i < count; i += kRays) {
            const RayRecord<Real> record = records.template load<Real>(first + i);
            const unsigned valid = count - i >= kRays ? (1U << kRays) - 1 : (1U << (count - i)) - 1;
            const Uint32<Real> ray = lane_numbers<Real>() + Uint32<Real>(static_cast<std::uint32_t>(i));
            pairs.template find<features, Real>(record.ray, signed_ids<Real>(record.leaving_id),
                                                ray * Uint32<Real>(RayRow<Scalar>::kColumns), valid, work_);
        }
        pairs.template meet<features, InBox::No, Real>(stream_.hits());
    }

    RAYPOOL_INLINE void store_row(std::size_t i, const WideRays<Real>& rays, const Hit<Real>& hit) requires Simd<Real> {
        hit.t.copy_to(stream_.distance() + i, stdx::element_aligned);
        using Ids = stdx::rebind_simd_t<std::int32_t, Uint32<Real>>;
        stdx::static_simd_cast<Ids>(hit.primitive_id).copy_to(stream_.primitive_id() + i, stdx::element_aligned);
        Vec3<Real> scale;
        for (int k = 0; k < 3; ++k) scale[k] = Real(1) / rays.ray.direction[k];
        const Vec3<Real>& origin = rays.ray.origin;
        const Vec3<Real>& direction = rays.ray.direction;
        const Real column[12] = {scale[0],     scale[1],     scale[2],     hit.t,
                                 origin[0],    origin[1],    origin[2],    rays.ray.time,
                                 direction[0], direction[1], direction[2], of_bits<Real>(rays.leaving_id)};
        store_rows<12, Real>(stream_.rows()[i].value, column);
    }

    const SceneView<Scalar>& scene_;
    Intersection intersection_;
    RayStream<Scalar> stream_;
    const StreamLists<Scalar>& lists_;
    Work work_;
};

}  // namespace raypool::wavefront
