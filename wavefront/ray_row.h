/// A ray as streams read it: a row of 12 scalars, so that any sixteen rays can be fetched by transposing.
#pragma once

#include <array>
#include <cstdint>

#include "core/geometry/occlusion.h"
#include "wavefront/wide_ids.h"

namespace raypool::wavefront {

/// The first eight are what a test of boxes reads, and the last eight what a test of spheres reads.
template <class Scalar>
struct alignas(16) RayRow {
    enum Column { kScale = 0, kDistance = 3, kOrigin = 4, kTime = 7, kDirection = 8, kLeaving = 11, kColumns = 12 };
    /// kScale: 1 / direction; kDistance: of the closest hit so far; kLeaving: the bits of the id that the ray leaves.
    Scalar value[kColumns];
};

/// What streams find and update: a row a ray, and apart from it, in the order of the rays, their hits.
template <class Scalar>
struct StreamHits {
    RayRow<Scalar>* rows;
    Scalar* distance;
    std::int32_t* primitive_id;

    /// Takes a hit that is closer than the ray's closest so far, or as close and of a smaller id.
    RAYPOOL_INLINE void keep_closer(std::uint32_t ray, Scalar t, std::int32_t id) const {
        if (t > distance[ray] || (t == distance[ray] && primitive_id[ray] < id)) return;
        set(ray, t, id);
    }
    RAYPOOL_INLINE void set(std::uint32_t ray, Scalar t, std::int32_t id) const {
        rows[ray].value[RayRow<Scalar>::kDistance] = distance[ray] = t;
        primitive_id[ray] = id;
    }
};

/// The same of shadow rays, whose distance and primitive are those of their light: a ray that anything else hides is
/// done, and enters no box any more.
template <class Scalar>
struct ShadowHits : StreamHits<Scalar> {
    RAYPOOL_INLINE void keep_closer(std::uint32_t ray, Scalar t, std::int32_t id) const {
        if (Occlusion<Scalar>{this->distance[ray], this->primitive_id[ray]}.hides(t, id)) hide(ray);
    }
    RAYPOOL_INLINE void hide(std::uint32_t ray) const { this->set(ray, Scalar(-1), kNoPrimitive); }
    [[nodiscard]] RAYPOOL_INLINE bool is_hidden(std::uint32_t ray) const { return this->distance[ray] < Scalar(0); }
};

/// A ray in the space of an instance's object: as boxes see it, and where the row of the ray itself begins.
template <class Scalar>
struct alignas(16) ObjectRow {
    enum Column { kScale = 0, kDistance = 3, kNearOrigin = 4, kItself = 7, kFarOrigin = 8, kColumns = 12 };
    /// As RayRow's, and ObjectRay's; kItself: the bits of a whole number, counted in scalars.
    Scalar value[kColumns];

    static_assert(int{kColumns} == RayRow<Scalar>::kColumns, "lists count in either's");
};

/// Three columns from `first` on.
template <class Real>
RAYPOOL_INLINE Vec3<Real> columns(const Real* row, int first) {
    return vec3<Real>(row[first], row[first + 1], row[first + 2]);
}

/// The rays of transposed rows.
template <class Real>
RAYPOOL_INLINE WideRays<Real> rays_of_rows(const Real* row) {
    using Row = RayRow<ScalarOf<Real>>;
    WideRays<Real> rays;
    rays.ray = {columns(row, Row::kOrigin), columns(row, Row::kDirection), row[Row::kTime]};
    rays.inverse = inverse_of_scale<Real>(columns(row, Row::kScale));
    rays.leaving_id = bits_of<Real>(row[Row::kLeaving]);
    return rays;
}

/// The columns of ObjectRows.
template <class Real>
RAYPOOL_INLINE std::array<Real, ObjectRow<ScalarOf<Real>>::kColumns> object_columns(const ObjectRay<Real>& ray,
                                                                                    const Real& distance,
                                                                                    const Int<Real>& itself) {
    const Vec3<Real>& near = ray.near_origin;
    const Vec3<Real>& far = ray.far_origin;
    return {ray.scale[0], ray.scale[1],          ray.scale[2], distance, near[0], near[1],
            near[2],      of_bits<Real>(itself), far[0],       far[1],   far[2],  Real(0)};
}
/// Rays of transposed ObjectRows.
template <class Real>
RAYPOOL_INLINE ObjectRay<Real> object_rays_of_rows(const Real* row) {
    using Row = ObjectRow<ScalarOf<Real>>;
    const Vec3<Real> scale = columns(row, Row::kScale);
    return {columns(row, Row::kNearOrigin), columns(row, Row::kFarOrigin), scale, inverse_of_scale<Real>(scale)};
}

}  // namespace raypool::wavefront
