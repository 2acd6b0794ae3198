/// The shadow stage: rays toward lights. They are collected while records are shaded, and traced together, as a stream,
/// when there are many; what a ray brings is added where nothing lies before its light.
#pragma once

#include <algorithm>
#include <vector>

#include "core/geometry/occlusion.h"
#include "core/shading/shade.h"
#include "wavefront/contributions.h"
#include "wavefront/ray_record.h"
#include "wavefront/stream.h"

namespace raypool::wavefront {

/// Of one thread. `Work` counts box and primitive tests, or nothing.
template <Features features, class Real, class Work>
class ShadowStage {
    using Scalar = ScalarOf<Real>;
    using Row = RayRow<Scalar>;
    static constexpr int kRays = kLanes<Real>;

  public:
    /// For at most `most_rays` at a time.
    ShadowStage(const SceneView<Scalar>& scene, Intersection intersection, std::size_t most_rays)
        : scene_(scene),
          intersection_(intersection),
          most_rays_(most_rays),
          stream_(most_rays, tree_depth(scene)),
          light_id_(most_rays + kRays) {
        radiance_.reserve(most_rays);
    }

    static std::size_t bytes(const SceneView<Scalar>& scene, std::size_t most_rays) {
        return RayStream<Scalar>::bytes(most_rays, tree_depth(scene)) + Contributions<Scalar>::bytes(most_rays) +
               (most_rays + kRays) * sizeof(std::int32_t);
    }

    [[nodiscard]] std::size_t count() const { return radiance_.count(); }
    [[nodiscard]] bool has_room() const { return count() + kRays <= most_rays_; }

    /// Takes the shadow rays of the hits in `bits`, for which there is room.
    RAYPOOL_INLINE void add(const RayRecord<Real>& record, const Scattered<Real>& out, const LightPart<Real>& lights,
                            unsigned bits) {
        const Vec3<Real>& origin = out.start.origin;
        const Vec3<Real>& direction = lights.light.direction;
        const Real column[Row::kColumns] = {Real(1) / direction[0],
                                            Real(1) / direction[1],
                                            Real(1) / direction[2],
                                            lights.light.t,
                                            origin[0],
                                            origin[1],
                                            origin[2],
                                            record.ray.time,
                                            direction[0],
                                            direction[1],
                                            direction[2],
                                            of_bits<Real>(out.start.leaving_id)};
        Row rows[kRays];
        store_rows<Row::kColumns, Real>(rows[0].value, column);
        std::size_t next = count();
        for (unsigned left = bits; left != 0; left &= left - 1, ++next) {
            const int i = std::countr_zero(left);
            stream_.rows()[next] = rows[i];
            stream_.distance()[next] = rows[i].value[Row::kDistance];
            stream_.primitive_id()[next] = light_id_[next] =
                static_cast<std::int32_t>(lane(lights.light.primitive_id, i));
        }
        radiance_.template put<Real>(record.key.pixel, lights.radiance, bits);
    }

    /// Traces all rays, and adds what those bring that reach their lights. Returns how many rays there were.
    std::size_t run(Contributions<Scalar>& contributions, Work& work) {
        const std::size_t rays = count();
        if (rays == 0) return 0;
        if (intersection_ == Intersection::Single || !Simd<Real>) {
            trace_one_by_one(work);
        } else {
            trace_stream(work);
        }
        for (std::size_t i = 0; i < rays; ++i) {
            if (stream_.primitive_id()[i] == light_id_[i])
                contributions.template put<Scalar>(radiance_.pixel(i), radiance_.radiance(i), 1);
        }
        radiance_.clear();
        return rays;
    }

  private:
    static int tree_depth(const SceneView<Scalar>& scene) {
        return std::max(scene.sphere_tree.depth, scene.quad_tree.depth);
    }

    void trace_one_by_one(Work& work) {
        for (std::size_t i = 0; i < count(); ++i) {
            const Scalar* row = stream_.rows()[i].value;
            const Ray<Scalar> ray{columns(row, Row::kOrigin), columns(row, Row::kDirection), row[Row::kTime]};
            const Hit<Scalar> light{stream_.distance()[i], light_id_[i]};
            const auto leaving_id = static_cast<std::int32_t>(bits_of<Scalar>(row[Row::kLeaving]));
            if (is_occluded<features>(scene_, ray, leaving_id, light, work)) stream_.primitive_id()[i] = kNoPrimitive;
        }
    }

    void trace_stream(Work& work) {
        if constexpr (Simd<Real>) {
            test_large_shapes(work);
            if constexpr (features.planar) {
                detail::walk_stream<features, Real>(scene_.quad_tree, stream_, count(), intersection_, work);
                end_hidden();
            }
            detail::walk_stream<features, Real>(scene_.sphere_tree, stream_, count(), intersection_, work);
        }
    }

    void test_large_shapes(Work& work) requires Simd<Real> {
        if (scene_.large_spheres.empty() && scene_.planes.empty()) return;
        const StreamHits<Scalar> hits{stream_.rows(), stream_.distance(), stream_.primitive_id()};
        for (std::size_t first = 0; first < count(); first += kRays) {
            std::uint32_t offset[kRays];
            const auto lanes = static_cast<int>(std::min<std::size_t>(kRays, count() - first));
            for (int i = 0; i < kRays; ++i)
                offset[i] = static_cast<std::uint32_t>((first + static_cast<std::size_t>(std::min(i, lanes - 1))) *
                                                       Row::kColumns);
            Real row[Row::kColumns];
            load_rows_at<Row::kColumns, Real>(stream_.rows()->value, offset, row);
            const WideRays<Real> rays = rays_of_rows<Real>(row);
            Hit<Real> hit;
            hit.t = row[Row::kDistance];
            hit.primitive_id = Int<Real>(
                [&](auto i) { return light_id_[first + static_cast<std::size_t>(std::min<int>(i, lanes - 1))]; });
            const Int<Real> light_id = hit.primitive_id;
            if constexpr (features.planar) intersect_all<features>(scene_.planes, rays, lanes, hit, work);
            intersect_all<features>(scene_.large_spheres, rays, lanes, hit, work);
            unsigned hidden = mask_bits(as_mask<Real>(hit.primitive_id != light_id)) & ((1U << lanes) - 1);
            for (; hidden != 0; hidden &= hidden - 1)
                hits.set(static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(std::countr_zero(hidden)),
                         Scalar(-1), kNoPrimitive);
        }
    }

    /// Rays that something hides enter no box any more.
    void end_hidden() {
        const StreamHits<Scalar> hits{stream_.rows(), stream_.distance(), stream_.primitive_id()};
        for (std::size_t i = 0; i < count(); ++i)
            if (hits.primitive_id[i] != light_id_[i]) hits.set(static_cast<std::uint32_t>(i), Scalar(-1), kNoPrimitive);
    }

    const SceneView<Scalar>& scene_;
    Intersection intersection_;
    std::size_t most_rays_;
    RayStream<Scalar> stream_;
    std::vector<std::int32_t> light_id_;  ///< a ray that something hides has another primitive_id
    Contributions<Scalar> radiance_;
};

/// What stages without light sampling have in its place.
template <class Scalar>
struct NoShadowStage {
    NoShadowStage(const SceneView<Scalar>&, Intersection, std::size_t) {}
    static std::size_t bytes(const SceneView<Scalar>&, std::size_t) { return 0; }
};

}  // namespace raypool::wavefront
