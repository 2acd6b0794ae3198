/// What is where a ray meets a surface: the point with its normal, the material, the colour, and how a ray starts
/// there.
#pragma once

#include "core/geometry/shapes.h"
#include "core/shading/compiled_scene.h"
#include "core/shading/textures.h"
#include "core/shading/triangle_point.h"

namespace raypool {

/// A point on a surface, seen along a ray.
template <class Real>
struct SurfacePoint {
    Vec3<Real> position;
    Vec3<Real> normal;    ///< unit, of shading, on the side that the ray arrives from: of flat shapes +-outward
    Vec3<Real> outward;   ///< unit, geometric: away from a sphere's centre
    Mask<Real> is_front;  ///< the ray arrives from the outward side

    // Of smooth triangles: directions are lost that leave the surface of shading and not the triangle, on this side or
    // beyond.
    Mask<Real> is_bounded = Mask<Real>(false);
    Mask<Real> is_bounded_beyond = Mask<Real>(false);

    /// The geometric normal on the side that the ray arrives from.
    [[nodiscard]] RAYPOOL_INLINE Vec3<Real> side() const { return select<Real>(is_front, outward, -outward); }
    /// Of a unit direction that leaves the surface of shading on this side, or beyond.
    [[nodiscard]] RAYPOOL_INLINE Mask<Real> loses(const Vec3<Real>& direction, const Mask<Real>& is_beyond) const {
        const Real height = dot<Real>(direction, side());
        return (is_bounded && !is_beyond && height <= Real(0)) || (is_bounded_beyond && is_beyond && height >= Real(0));
    }
};

/// `row` is the primitive's SurfaceRow, transposed. A hit on a sphere is put back onto the sphere where the distance
/// travelled, and with it the rounding error, is larger than the radius; on a large sphere that would do harm. A hit on
/// a quad or plane is put back always: its error is then a few ulps of its own coordinates, whatever the ray's length,
/// and none across a plane that lies across an axis.
template <Features features, class Real>
RAYPOOL_INLINE SurfacePoint<Real> surface_point(const Ray<Real>& ray, const Real& t, const Real* row) {
    using Row = SurfaceRow<ScalarOf<Real>>;
    const Vec3<Real> p = along<Real>(ray.origin, t, ray.direction);
    const Real radius = row[Row::kRadius];
    Vec3<Real> center = vec3<Real>(row[Row::kCenter], row[Row::kCenter + 1], row[Row::kCenter + 2]);
    const Vec3<Real> stored = center;  // of a quad or plane this is the normal, and the motion is a point of it
    const Vec3<Real> motion = vec3<Real>(row[Row::kMotion], row[Row::kMotion + 1], row[Row::kMotion + 2]);
    if constexpr (features.motion) center = center_at<Real>(center, motion, ray.time);

    SurfacePoint<Real> point;
    const Mask<Real> is_planar = features.planar ? radius < Real(0) : Mask<Real>(false);
    if (!all(is_planar)) {
        point.outward = unit<Real>(vec3<Real>(p[0] - center[0], p[1] - center[1], p[2] - center[2]));
        point.position = select<Real>(radius < t, along<Real>(center, radius, point.outward), p);
    }
    if (features.planar && any(is_planar)) {
        // Not the height above the plane, negated: gcc 12 makes one instruction of that, with another sign of zero.
        const Real depth = dot<Real>(vec3<Real>(motion[0] - p[0], motion[1] - p[1], motion[2] - p[2]), stored);
        const Vec3<Real> in_plane = along<Real>(p, depth, stored);
        const bool is_alone = all(is_planar);
        point.outward = is_alone ? stored : select<Real>(is_planar, stored, point.outward);
        point.position = is_alone ? in_plane : select<Real>(is_planar, in_plane, point.position);
    }
    point.is_front = dot<Real>(ray.direction, point.outward) < Real(0);
    point.normal = select<Real>(point.is_front, point.outward, -point.outward);
    return point;
}

/// Makes of a mesh's SurfaceRow that of a triangle, by its normal and id, where `is_here`.
template <class Real>
RAYPOOL_INLINE void put_triangle(const Mask<Real>& is_here, const Vec3<Real>& outward, const Int<Real>& primitive_id,
                                 Real* row) {
    using Row = SurfaceRow<ScalarOf<Real>>;
    for (int i = 0; i < 3; ++i) row[Row::kCenter + i] = select(is_here, outward[i], row[Row::kCenter + i]);
    row[Row::kRadius] = select(is_here, PlanarMark<Real>::make(primitive_id), row[Row::kRadius]);
}

/// Loads the SurfaceRow of the primitives that rays met: of a triangle that of its mesh, with its own normal and mark.
template <Features features, class Real>
RAYPOOL_INLINE TrianglePoint<Real> load_surface(const SceneView<ScalarOf<Real>>& scene, const Ray<Real>& ray,
                                                const Int<Real>& primitive_id, Real* row) {
    using Row = SurfaceRow<ScalarOf<Real>>;
    TrianglePoint<Real> triangle;
    if constexpr (features.triangles) triangle.is_here = as_mask<Real>(primitive_id >= Int<Real>(scene.first_triangle));
    if (!features.triangles || none(triangle.is_here)) {
        load_rows<Row::kColumns, Real>(scene.surfaces.data()->value, Row::kColumns, primitive_id, row);
        return triangle;
    }
    Vec3<Real> outward;
    Int<Real> surface_id;
    if constexpr (Simd<Real>) {
        load_triangle<features, Real>(scene, ray, primitive_id, triangle, outward, surface_id);
    } else {
        call_load_triangle<features, Real>(scene, ray, primitive_id, triangle, outward, surface_id);
    }
    load_rows<Row::kColumns, Real>(scene.surfaces.data()->value, Row::kColumns, surface_id, row);
    put_triangle<Real>(triangle.is_here, outward, primitive_id, row);
    return triangle;
}

/// The row's colour, or what its texture makes of it, where `is_wanted`.
template <Features features, class Real>
RAYPOOL_INLINE Vec3<Real> surface_colour(const SceneView<ScalarOf<Real>>& scene, const SurfacePoint<Real>& point,
                                         const TrianglePoint<Real>& triangle, const Int<Real>& primitive_id,
                                         const Real* row, const SurfaceCode<Int<Real>>& code,
                                         const Mask<Real>& is_wanted) {
    using S = ScalarOf<Real>;
    using Row = SurfaceRow<S>;
    Vec3<Real> colour = vec3<Real>(row[Row::kColour], row[Row::kColour + 1], row[Row::kColour + 2]);
    if constexpr (!features.checker && !features.uv) return colour;

    const Int<Real> texture_kind = code.texture();
    const auto is_kind = [&](Texture::Kind kind) {
        return is_wanted && as_mask<Real>(texture_kind == Int<Real>(static_cast<int>(kind)));
    };
    const Mask<Real> is_checker_3d = features.checker ? is_kind(Texture::Kind::Checker3d) : Mask<Real>(false);
    const Mask<Real> is_checker_uv = features.uv ? is_kind(Texture::Kind::CheckerUv) : Mask<Real>(false);
    const Mask<Real> is_image =
        features.uv ? is_wanted && as_mask<Real>(texture_kind >= Int<Real>(static_cast<int>(Texture::Kind::Image)))
                    : Mask<Real>(false);

    std::array<Real, 2> uv{Real(0), Real(0)};
    if constexpr (features.uv) {
        if (any(is_checker_uv || is_image)) {
            uv = sphere_coordinates<Real>(point.outward);
            if constexpr (features.planar) {
                const Mask<Real> is_planar = row[Row::kRadius] < Real(0) && !triangle.is_here;
                if (any(is_planar)) {
                    Real planar[PlanarRow<S>::kColumns];
                    const Int<Real> planar_row = primitive_id - Int<Real>(static_cast<int>(scene.first_planar()));
                    load_rows<PlanarRow<S>::kColumns, Real>(scene.planars.data()->value, PlanarRow<S>::kColumns,
                                                            select(is_planar, planar_row, Int<Real>(0)), planar);
                    const auto part = [&](int first) {
                        return vec3<Real>(planar[first], planar[first + 1], planar[first + 2]);
                    };
                    const std::array<Real, 2> in_plane =
                        plane_coordinates<Real>(point.position, part(PlanarRow<S>::kCorner), part(PlanarRow<S>::kDualU),
                                                part(PlanarRow<S>::kDualV));
                    uv = {select(is_planar, in_plane[0], uv[0]), select(is_planar, in_plane[1], uv[1])};
                }
            }
            if constexpr (features.triangles) {
                const Mask<Real> is_mapped = triangle.is_here && (is_checker_uv || is_image);
                if (any(is_mapped)) {
                    std::array<Real, 2> on_triangle{Real(0), Real(0)};
                    for (int i = 0; i < 3; ++i) {
                        const Int<Real> first = select(is_mapped, triangle.vertex_id[i], Int<Real>(0)) * Int<Real>(2);
                        for (int k = 0; k < 2; ++k)
                            on_triangle[k] = mad<Real>(
                                triangle.weight[i], detail::gather<Real>(scene.vertex_uv.data(), first + Int<Real>(k)),
                                on_triangle[k]);
                    }
                    uv = {select(is_mapped, on_triangle[0], uv[0]), select(is_mapped, on_triangle[1], uv[1])};
                }
            }
        }
    }
    if (any(is_checker_3d || is_checker_uv)) {
        using Tex = TextureRow<S>;
        Real texture[Tex::kColumns];
        const Int<Real> texture_row = code.texture_row();
        const Mask<Real> is_checker = is_checker_3d || is_checker_uv;
        const auto first = lane(texture_row, std::countr_zero(mask_bits(is_checker)));
        if (none(is_checker && as_mask<Real>(texture_row != Int<Real>(first)))) {  // mostly all want the same
            const S* one = scene.textures[static_cast<std::size_t>(first)].value;
            for (int k = 0; k < Tex::kColumns; ++k) texture[k] = Real(one[k]);
        } else {
            load_rows<Tex::kColumns, Real>(scene.textures.data()->value, Tex::kColumns, texture_row, texture);
        }
        const TwoParts<Real> scale{texture[Tex::kScaleHigh], texture[Tex::kScaleLow]};
        const Vec3<Real> odd = vec3<Real>(texture[Tex::kOdd], texture[Tex::kOdd + 1], texture[Tex::kOdd + 2]);
        Vec3<Real> at;
        Vec3<Real> outward;
        for (int i = 0; i < 3; ++i) {
            const Real offset = texture[Tex::kOffset + i];
            at[i] = point.position[i] + offset;
            outward[i] = outward_part<Real>(point.position[i], offset, scale, point.outward[i]);
        }
        if constexpr (features.uv) {
            const Vec3<Real> zero = vec3<Real>(Real(0), Real(0), Real(0));
            at = select<Real>(is_checker_uv, vec3<Real>(uv[0], uv[1], Real(0)), at);
            outward = select<Real>(is_checker_uv, zero, outward);
        }
        colour = select<Real>(is_checker && is_odd_cell<Real>(at, outward, scale), odd, colour);
    }
    if constexpr (features.uv) {
        for (unsigned bits = mask_bits(is_image); bits != 0; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            const ImagePlace& image = scene.images[static_cast<std::size_t>(lane(code.texture_row(), i))];
            const auto repeat = static_cast<int>(lane(texture_kind, i)) - static_cast<int>(Texture::Kind::Image);
            const Vec3<S> texel = image_colour<S>(image.view(scene.texels.data()), lane(uv[0], i), lane(uv[1], i),
                                                  ImageRepeat::of_number(repeat));
            for (int k = 0; k < 3; ++k) {
                if constexpr (Simd<Real>) {
                    colour[k][i] = texel[k];
                } else {
                    colour[k] = texel[k];
                }
            }
        }
    }
    return colour;
}

/// What the surface is made of, where it was hit.
template <Features features, class Real>
struct SurfaceMaterial {
    Int<Real> kind;  ///< a Material::Kind
    Real parameter;  ///< SurfaceRow::kParameter

    [[nodiscard]] RAYPOOL_INLINE Mask<Real> is_emitter() const {
        return features.emissive ? is(Material::Kind::Emissive) : Mask<Real>(false);
    }
    /// Of an emitter: what its colour is multiplied by, toward a ray that arrives at the front or at the back.
    [[nodiscard]] RAYPOOL_INLINE Real emission(const Mask<Real>& is_front) const {
        return select(is_front || parameter > Real(0), abs(parameter), Real(0));
    }
    [[nodiscard]] RAYPOOL_INLINE Mask<Real> is_glass() const {
        return features.dielectric ? is(Material::Kind::Dielectric) : Mask<Real>(false);
    }
    [[nodiscard]] RAYPOOL_INLINE Mask<Real> is_metal() const {
        return features.metal ? is(Material::Kind::Metal) : Mask<Real>(false);
    }
    [[nodiscard]] RAYPOOL_INLINE Mask<Real> is_fuzzy() const {
        return features.fuzz ? is_metal() && parameter > Real(0) : Mask<Real>(false);
    }
    [[nodiscard]] RAYPOOL_INLINE Mask<Real> is_diffuse() const { return !(is_glass() || is_metal() || is_emitter()); }
    /// Whether it sends some light from any direction onward, so that lights can be sampled.
    [[nodiscard]] RAYPOOL_INLINE Mask<Real> has_density() const { return is_diffuse() || is_fuzzy(); }

  private:
    [[nodiscard]] RAYPOOL_INLINE Mask<Real> is(Material::Kind which) const {
        return as_mask<Real>(kind == Int<Real>(static_cast<int>(which)));
    }
};

/// How a ray starts on a surface: where, and what it cannot hit.
template <class Real>
struct RayStart {
    Vec3<Real> origin;
    Int<Real> leaving_id;  ///< a sphere's id; of a quad or plane the id of the shapes in its plane
};

/// Where rays start that leave a triangle on the side of unit `side`, which is its normal or that negated: above `from`
/// by as much as the point of the triangle may be off.
template <class Real>
RAYPOOL_INLINE Vec3<Real> triangle_start(const Vec3<Real>& from, const TrianglePoint<Real>& triangle,
                                         const Vec3<Real>& side) {
    const Vec3<Real> length = vec3<Real>(abs(side[0]), abs(side[1]), abs(side[2]));
    return along<Real>(from, dot<Real>(length, triangle.error), side);
}

/// Of a ray that leaves `point` of primitive `primitive_id`, whose SurfaceRow is `row`, on the side from
/// which it was met. On a triangle the start lies above it: neighbours share its edges and are not left with it. Where
/// a smooth triangle lifts the start, the ray leaves nothing and may meet the triangle. No other place decides where a
/// ray starts. (Set in place: of a returned one gcc 12 makes a copy, which single rays feel.)
template <Features features, class Real>
RAYPOOL_INLINE void set_ray_start(RayStart<Real>& start, const SurfacePoint<Real>& point,
                                  const TrianglePoint<Real>& triangle, const Int<Real>& primitive_id, const Real* row) {
    start.origin = point.position;
    start.leaving_id = primitive_id;
    if constexpr (features.planar) {
        start.leaving_id = PlanarMark<Real>::group(row[SurfaceRow<ScalarOf<Real>>::kRadius], primitive_id);
    }
    if constexpr (features.triangles) {
        if (none(triangle.is_here)) return;
        Vec3<Real> from = point.position;
        if (any(triangle.is_smooth)) {
            const Vec3<Real>& lift = triangle.smooth.lift;
            from = select<Real>(triangle.is_smooth, vec3<Real>(from[0] + lift[0], from[1] + lift[1], from[2] + lift[2]),
                                from);
            const Mask<Real> is_lifted = triangle.is_smooth && triangle.smooth.is_lifted;
            start.leaving_id = select(is_lifted, Int<Real>(kNoPrimitive), start.leaving_id);
        }
        start.origin = select<Real>(triangle.is_here, triangle_start<Real>(from, triangle, point.side()), start.origin);
    }
}

/// The same of rays in `is_through`, which go through the triangle, and are not lifted.
template <class Real>
RAYPOOL_INLINE void set_start_beyond(RayStart<Real>& start, const SurfacePoint<Real>& point,
                                     const TrianglePoint<Real>& triangle, const Int<Real>& primitive_id,
                                     const Mask<Real>& is_through) {
    start.origin =
        select<Real>(is_through, triangle_start<Real>(point.position, triangle, -point.side()), start.origin);
    start.leaving_id = select(is_through, primitive_id, start.leaving_id);
}

}  // namespace raypool
