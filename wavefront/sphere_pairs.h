/// Pairs of a ray and a sphere that may meet: what a cheap test lets through, so that registers are full of pairs where
/// the exact test runs.
///
/// Of the rays that reach a leaf one in thirty hits a given sphere of it. Tested sphere by sphere, an exact test runs
/// for a whole register as soon as one of its rays comes near. Here may_meet_sphere() (core/geometry/shapes.h) looks at
/// every ray and sphere first, and the pairs that pass are collected, whatever their sphere, and tested a register at a
/// time.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "wavefront/ray_row.h"

namespace raypool::wavefront {

/// The pairs of one block of spheres. A pair is a number: where the ray's row begins, in scalars, times the lanes of a
/// block, plus the sphere's lane.
template <class Scalar>
class SpherePairs {
    static constexpr int kShapes = kTreeWidth<Scalar>;
    using Row = RayRow<Scalar>;
    using Block = SphereBlock<Scalar, kShapes>;

  public:
    /// Rays whose pairs have a number.
    static constexpr std::size_t kMostRays = (std::uint64_t{1} << 32U) / (Row::kColumns * kShapes);

    /// `memory` has room for kShapes pairs a ray that is looked at, and a register beyond.
    SpherePairs(const Block& block, std::uint32_t* memory) : block_(block), pairs_(memory) {
        using Shapes = Wide<Scalar, kShapes>;
        const SphereReach<Shapes> reach = sphere_reach<Shapes>(raypool::detail::load<Shapes>(block.radius),
                                                               raypool::detail::load<Shapes>(block.padded_radius));
        reach.square.copy_to(square_, stdx::vector_aligned);
        reach.least.copy_to(least_, stdx::vector_aligned);
        while (count_ < kShapes && block.id[count_] != kNoPrimitive) ++count_;
    }

    /// Collects the pairs of the rays set in `valid`, whose rows begin at `offset`.
    template <Features features, class Real, class Work>
    RAYPOOL_INLINE void find(const Ray<Real>& ray, const Int<Real>& leaving_id, const Uint32<Real>& offset,
                             unsigned valid, Work& work) {
        const Uint32<Real> first_pair = offset * Uint32<Real>(kShapes);
        for (int i = 0; i < count_; ++i) {
            const Vec3<Real> center = lane_of<Real>(block_.center, i);
            Vec3<Real> toward =
                vec3<Real>(center[0] - ray.origin[0], center[1] - ray.origin[1], center[2] - ray.origin[2]);
            if constexpr (features.motion)
                toward = toward_sphere<Real>(center, lane_of<Real>(block_.motion, i), ray.time, ray.origin);
            const SphereReach<Real> reach{Real(square_[i]), Real(least_[i])};
            const Mask<Real> is_leaving = as_mask<Real>(leaving_id == Int<Real>(block_.id[i]));
            const unsigned bits = mask_bits(may_meet_sphere<Real>(toward, ray.direction, reach, is_leaving)) & valid;
            work.count_primitives(std::popcount(valid));
            compress_store(pairs_ + filled_, first_pair + Uint32<Real>(static_cast<std::uint32_t>(i)), bits);
            filled_ += static_cast<std::size_t>(std::popcount(bits));
        }
    }

    /// The same of a list of rays, which has a register beyond its end.
    template <Features features, class Real, class Work>
    RAYPOOL_INLINE void find_in_list(const Row* rows, const std::uint32_t* list, std::size_t count, Work& work) {
        constexpr std::size_t kRays = kLanes<Real>;
        for (std::size_t first = 0; first < count; first += kRays) {
            constexpr int kColumns = Row::kColumns - Row::kOrigin;
            Real row[kColumns];
            load_rows_at<kColumns, Real>(rows->value + Row::kOrigin, list + first, row);
            const Ray<Real> ray{columns(row, 0), columns(row, Row::kDirection - Row::kOrigin),
                                row[Row::kTime - Row::kOrigin]};
            const unsigned valid = first + kRays <= count ? (1U << kRays) - 1 : (1U << (count - first)) - 1;
            find<features, Real>(ray, bits_of<Real>(row[Row::kLeaving - Row::kOrigin]),
                                 Uint32<Real>(list + first, stdx::element_aligned), valid, work);
        }
    }

    /// Tests the pairs exactly and gives the hits that are closer to `hits`, StreamHits or ShadowHits. The pairs are
    /// then used up.
    template <Features features, InBox in_box, class Real>
    RAYPOOL_INLINE void meet(const auto& hits) {
        constexpr std::size_t kRays = kLanes<Real>;
        if (filled_ == 0) return;
        Scalar id[kShapes];
        for (int i = 0; i < kShapes; ++i) id[i] = of_bits<Scalar>(block_.id[i]);
        // The tail of the last register repeats the last pair: to test it twice changes nothing.
        std::fill_n(pairs_ + filled_, kRays, pairs_[filled_ - 1]);
        for (std::size_t first = 0; first < filled_; first += kRays) {
            const Uint32<Real> pair(pairs_ + first, stdx::element_aligned);
            const Uint32<Real> which = pair & Uint32<Real>(kShapes - 1);
            alignas(64) std::uint32_t offset[kRays];
            for (std::size_t i = 0; i < kRays; ++i) offset[i] = pairs_[first + i] / kShapes;
            Real row[Row::kColumns];
            load_rows_at<Row::kColumns, Real>(hits.rows->value, offset, row);
            const Vec3<Real> origin = columns(row, Row::kOrigin);
            Vec3<Real> center = pick3<Real>(block_.center, which);
            if constexpr (features.motion)
                center = center_at<Real>(center, pick3<Real>(block_.motion, which), row[Row::kTime]);
            const Mask<Real> is_leaving =
                as_mask<Real>(bits_of<Real>(row[Row::kLeaving]) == bits_of<Real>(pick<kShapes, Real>(id, which)));
            const Real t = sphere_distance<Real>(origin, columns(row, Row::kDirection), center,
                                                 pick<kShapes, Real>(block_.radius, which), is_leaving);
            Mask<Real> is_closer = t <= row[Row::kDistance] && t < Real(kInfinity<Real>);
            if (none(is_closer)) continue;
            if constexpr (in_box == InBox::Yes) {
                const Real r = pick<kShapes, Real>(block_.padded_radius, which);
                const Vec3<Real> low = vec3<Real>(center[0] - r, center[1] - r, center[2] - r);
                const Vec3<Real> high = vec3<Real>(center[0] + r, center[1] + r, center[2] + r);
                is_closer = is_closer && is_inside_box<Real>(low, high, origin,
                                                             inverse_of_scale<Real>(columns(row, Row::kScale)), t);
            }
            for (unsigned bits = mask_bits(is_closer); bits != 0; bits &= bits - 1) {
                const int i = std::countr_zero(bits);
                const std::uint32_t hit = pairs_[first + static_cast<std::size_t>(i)];
                hits.keep_closer(hit / (kShapes * Row::kColumns), lane(t, i), block_.id[hit % kShapes]);
            }
        }
        filled_ = 0;
    }

  private:
    template <class Real>
    RAYPOOL_INLINE static Vec3<Real> pick3(const Scalar (&columns)[3][kShapes], const Uint32<Real>& which) {
        return vec3<Real>(pick<kShapes, Real>(columns[0], which), pick<kShapes, Real>(columns[1], which),
                          pick<kShapes, Real>(columns[2], which));
    }

    const Block& block_;
    alignas(64) Scalar square_[kShapes];
    alignas(64) Scalar least_[kShapes];
    int count_ = 0;  ///< spheres
    std::uint32_t* pairs_;
    std::size_t filled_ = 0;
};

}  // namespace raypool::wavefront
