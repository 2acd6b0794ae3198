/// The rays of a stream as a tree sees them: as they are, or in the space of an instance's object.
///
/// Rays are read as rows, so that any sixteen of them can be fetched by transposing. A list holds where rows begin,
/// counted in scalars.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include "wavefront/ray_row.h"
#include "wavefront/wide_ids.h"

namespace raypool::wavefront::detail {

/// The rays that a stream takes through a tree, where they are what its shapes and boxes see. `Hits` is StreamHits, for
/// closest hits, or ShadowHits.
template <class Hits, class Scalar>
struct StandingRays {
    using Row = RayRow<Scalar>;
    static constexpr int kBoxColumns = 8;
    /// Lists shorter than this are walked ray by ray. From a prototype on triangles, in which the length hardly
    /// mattered.
    static constexpr std::size_t kShortList = 12;
    static constexpr bool kIsShadow = std::same_as<Hits, ShadowHits<Scalar>>;

    Hits hits;

    [[nodiscard]] const Scalar* box_rows() const { return hits.rows->value; }
    template <class Real>
    RAYPOOL_INLINE static WideRays<Real> boxes_see(const Real* row) {
        WideRays<Real> rays;
        rays.ray.origin = columns(row, Row::kOrigin);
        rays.inverse = inverse_of_scale<Real>(columns(row, Row::kScale));
        return rays;
    }
    /// Where the row of a ray of a list begins.
    [[nodiscard]] RAYPOOL_INLINE std::uint32_t row_of(std::uint32_t offset) const { return offset; }
    /// The same of a register of them, in `scratch` if need be.
    template <std::size_t count>
    RAYPOOL_INLINE static const std::uint32_t* rows_of(const std::uint32_t* list, std::uint32_t (&)[count]) {
        return list;
    }
    /// Of the ray, as far as the order of boxes asks.
    [[nodiscard]] RAYPOOL_INLINE Vec3<Scalar> direction_of(std::uint32_t offset) const {
        return columns(box_rows() + offset, Row::kDirection);
    }
    template <class Block, class Real>
    RAYPOOL_INLINE static decltype(auto) shapes_see(const WideRays<Real>& rays) {
        return ready_for<Block, Real>(rays);
    }
    RAYPOOL_INLINE void keep_closer(std::uint32_t offset, Scalar t, std::int32_t id) const {
        hits.keep_closer(offset / Row::kColumns, t, id);
    }
    template <Features features, class Boxes, class Tree, class Found, class Work>
    RAYPOOL_INLINE static void walk_from(std::int32_t child, const Tree& tree, const SpreadRay<Boxes>& ray,
                                         Found& found, Work& work) {
        raypool::detail::walk<features, Boxes>(tree, ray, found, work, child);
    }
    RAYPOOL_INLINE void is_walked(std::uint32_t) const {}
};

/// The same of rays that go through an instance: `rows` are theirs in its object's space.
template <class Hits, class Scalar>
struct PlacedStreamRays {
    using Row = ObjectRow<Scalar>;
    static constexpr int kBoxColumns = Row::kColumns;
    /// A ray by itself pays anew for its way into the object's space, so lists stay together longer. Of lengths from 1
    /// to 48 the best, at 100,000 and 1,000,000 triangles of instances.
    static constexpr std::size_t kShortList = 4;
    static constexpr bool kIsShadow = std::same_as<Hits, ShadowHits<Scalar>>;

    Hits hits;
    Row* rows;
    const InstanceRow<Scalar>& instance;

    [[nodiscard]] const Scalar* box_rows() const { return rows->value; }
    template <class Real>
    RAYPOOL_INLINE static ObjectRay<Real> boxes_see(const Real* row) {
        return object_rays_of_rows<Real>(row);
    }
    [[nodiscard]] RAYPOOL_INLINE std::uint32_t row_of(std::uint32_t offset) const {
        return static_cast<std::uint32_t>(bits_of<Scalar>(rows[offset / Row::kColumns].value[Row::kItself]));
    }
    template <std::size_t count>
    RAYPOOL_INLINE const std::uint32_t* rows_of(const std::uint32_t* list, std::uint32_t (&scratch)[count]) const {
        for (std::size_t i = 0; i < count; ++i) scratch[i] = row_of(list[i]);
        return scratch;
    }
    [[nodiscard]] RAYPOOL_INLINE Vec3<Scalar> direction_of(std::uint32_t offset) const {
        const Scalar* scale = box_rows() + offset + Row::kScale;
        return vec3<Scalar>(1 / scale[0], 1 / scale[1], 1 / scale[2]);
    }
    template <class Block, class Real>
    RAYPOOL_INLINE PlacedRays<Real> shapes_see(const WideRays<Real>& rays_of_list) const {
        return placed_rays<Real>(instance, ready_for<Block, Real>(rays_of_list));
    }
    RAYPOOL_INLINE void keep_closer(std::uint32_t offset, Scalar t, std::int32_t id) const {
        hits.keep_closer(row_of(offset) / RayRow<Scalar>::kColumns, t,
                         id + instance.number(InstanceRow<Scalar>::kFirstId));
        is_walked(offset);
    }
    template <Features features, class Boxes, class Tree, class Found, class Work>
    RAYPOOL_INLINE void walk_from(std::int32_t child, const Tree& tree, const SpreadRay<Boxes>& ray, Found& found,
                                  Work& work) const {
        raypool::detail::meet_instance<features, Boxes>(
            tree, instance, child, raypool::detail::ready_for<typename Tree::Block, Boxes>(ray), found, work);
    }
    /// Boxes are to know the distance of the ray's closest hit.
    RAYPOOL_INLINE void is_walked(std::uint32_t offset) const {
        const RayRow<Scalar>& itself = hits.rows[row_of(offset) / RayRow<Scalar>::kColumns];
        rows[offset / Row::kColumns].value[Row::kDistance] = itself.value[RayRow<Scalar>::kDistance];
    }
};

}  // namespace raypool::wavefront::detail
