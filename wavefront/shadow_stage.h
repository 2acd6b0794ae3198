/// The shadow stage: rays toward lights. They are collected while records are shaded, and traced together, as a stream,
/// when there are many; what a ray brings is added where nothing lies before its light.
#pragma once

#include <algorithm>
#include <utility>

#include "core/geometry/any_hit.h"
#include "core/shading/shade.h"
#include "wavefront/contributions.h"
#include "wavefront/ray_columns.h"
#include "wavefront/stream.h"

namespace raypool::wavefront {

/// Of one thread. `Work` counts box and primitive tests, or nothing.
template <Features features, class Real, class Work>
class ShadowStage {
    using Scalar = ScalarOf<Real>;
    using Row = RayRow<Scalar>;
    static constexpr int kRays = kLanes<Real>;

  public:
    /// For at most `most_rays` at a time, as `lists` are, which outlive it.
    ShadowStage(const SceneView<Scalar>& scene, Intersection intersection, std::size_t most_rays,
                const StreamLists<Scalar>& lists)
        : scene_(scene), intersection_(intersection), most_rays_(most_rays), stream_(most_rays), lists_(lists) {
        radiance_.reserve(most_rays);
    }

    static std::size_t bytes(std::size_t most_rays) {
        return RayStream<Scalar>::bytes(most_rays) + Contributions<Scalar>::bytes(most_rays);
    }

    [[nodiscard]] std::size_t count() const { return radiance_.count(); }
    [[nodiscard]] bool has_room() const { return count() + kRays <= most_rays_; }

    /// Takes the shadow rays of the hits in `bits`, for which there is room. What they bring is for the cells.
    RAYPOOL_INLINE void add(const RayRecord<Real>& record, const Scattered<Real>& out, const LightPart<Real>& lights,
                            const Uint32<Real>& cell, unsigned bits, Work& work) {
        const LightSample<Real>& light = lights.light;
        taken_ += static_cast<std::size_t>(std::popcount(bits));
        if (is_stream()) bits &= ~hidden_by_large_shapes(record, out, light, std::popcount(bits), work);
        const Vec3<Real>& origin = out.start.origin;
        const Vec3<Real>& direction = light.direction;
        Real column[Row::kColumns] = {Real(1) / direction[0],
                                      Real(1) / direction[1],
                                      Real(1) / direction[2],
                                      light.t,
                                      origin[0],
                                      origin[1],
                                      origin[2],
                                      record.ray.time,
                                      direction[0],
                                      direction[1],
                                      direction[2],
                                      of_bits<Real>(out.start.leaving_id)};
        const LanePacker<Real> packer(bits);
        for (Real& values : column) values = packer.pack(values);
        store_rows<Row::kColumns, Real>(stream_.rows()[count()].value, column);
        packer.store(stream_.distance() + count(), light.t);
        packer.store(stream_.primitive_id() + count(), id_bits<Real>(light.primitive_id));
        radiance_.template put<Real>(cell, lights.radiance, bits);
    }

    /// Rays that were taken, and of these, that met something before their light.
    struct Traced {
        std::size_t rays, hits;
    };
    /// Traces all rays, and adds what those bring that reach their lights.
    Traced run(Contributions<Scalar>& contributions, Work& work) {
        if (is_stream()) {
            trace_stream(work);
        } else {
            trace_one_by_one(work);
        }
        std::size_t reached = 0;
        for (std::size_t first = 0; first < count(); first += kRays) {
            unsigned seen = 0;
            for (std::size_t i = first; i < std::min(first + kRays, count()); ++i)
                seen |= hits().is_hidden(static_cast<std::uint32_t>(i)) ? 0U : 1U << (i - first);
            contributions.template put_from<Real>(radiance_, first, seen);
            reached += static_cast<std::size_t>(std::popcount(seen));
        }
        radiance_.clear();
        const std::size_t rays = std::exchange(taken_, 0);
        return {rays, rays - reached};
    }

  private:
    [[nodiscard]] bool is_stream() const { return Simd<Real> && intersection_ != Intersection::Single; }
    [[nodiscard]] ShadowHits<Scalar> hits() { return {stream_.hits()}; }

    /// The lanes whose light a shape hides that is in no tree.
    RAYPOOL_INLINE unsigned hidden_by_large_shapes(const RayRecord<Real>& record, const Scattered<Real>& out,
                                                   const LightSample<Real>& light, int count, Work& work) {
        if constexpr (Simd<Real>) {
            const WideRays<Real> rays = wide_rays<Real>({out.start.origin, light.direction, record.ray.time},
                                                        id_bits<Real>(out.start.leaving_id));
            const Hit<Real> hit{light.t, light.primitive_id};
            Mask<Real> is_hidden = hidden_by_any<features>(scene_.large_spheres, rays, count, hit, work);
            if constexpr (features.planar)
                is_hidden = is_hidden || hidden_by_any<features>(scene_.planes, rays, count, hit, work);
            return mask_bits(is_hidden);
        } else {
            return 0;
        }
    }

    void trace_one_by_one(Work& work) {
        for (std::size_t i = 0; i < count(); ++i) {
            const Scalar* row = stream_.rows()[i].value;
            const Ray<Scalar> ray{columns(row, Row::kOrigin), columns(row, Row::kDirection), row[Row::kTime]};
            const Occlusion<Scalar> light{stream_.distance()[i], stream_.primitive_id()[i]};
            const auto leaving_id = static_cast<std::int32_t>(bits_of<Scalar>(row[Row::kLeaving]));
            if (is_occluded<features>(scene_, ray, leaving_id, light, work)) hits().hide(static_cast<std::uint32_t>(i));
        }
    }

    void trace_stream(Work& work) {
        if constexpr (Simd<Real>) {
            if constexpr (features.planar)
                detail::walk_stream<features, Real>(scene_.quad_tree, hits(), count(), lists_, intersection_, work);
            if constexpr (features.triangles) {
                detail::walk_stream<features, Real>(scene_.triangle_tree, hits(), count(), lists_, intersection_, work);
                detail::walk_stream<features, Real>(scene_.instance_tree, hits(), count(), lists_, intersection_, work);
            }
            detail::walk_stream<features, Real>(scene_.sphere_tree, hits(), count(), lists_, intersection_, work);
        }
    }

    const SceneView<Scalar>& scene_;
    Intersection intersection_;
    std::size_t most_rays_;
    RayStream<Scalar> stream_;
    const StreamLists<Scalar>& lists_;
    Contributions<Scalar> radiance_;
    std::size_t taken_ = 0;  ///< since the last run: those in the stream, and those that large shapes hide
};

/// What stages without light sampling have in its place.
template <class Scalar>
struct NoShadowStage {
    NoShadowStage(const SceneView<Scalar>&, Intersection, std::size_t, const StreamLists<Scalar>&) {}
    static std::size_t bytes(std::size_t) { return 0; }
};

}  // namespace raypool::wavefront
