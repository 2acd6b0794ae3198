/// Where lights are, seen from a point: a direction toward one is sampled, and the density of a direction is known.
///
/// A light is chosen by its power. Of a quad or triangle a point is sampled by area; of a sphere a direction by solid
/// angle, within the cone that it fills (Shirley, Wang and Zimmerman, "Monte Carlo Techniques for Direct Lighting
/// Calculations", 1996), and all around where the point is in it. Of an image around the scene the direction is drawn
/// by its brightness (environment.h).
#pragma once

#include <numbers>

#include "core/math/random.h"
#include "core/math/sampling.h"
#include "core/shading/interaction.h"

namespace raypool {

/// Whether lights are sampled: not at all; alone, where a surface is diffuse or a fuzzy mirror; or so that what is
/// sampled and what is found by chance share the weight (multiple importance sampling by the balance heuristic; Veach
/// and Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", 1995).
enum class LightSampling : std::uint8_t { None, Light, Mis };

/// Hits of a path at which lights may be sampled. Behind them lights are found by chance, so that no sample comes in
/// more parts, whose sum must fit into an integer.
inline constexpr std::int32_t kMostSampledHits = 255;

/// A direction toward a light.
template <class Real>
struct LightSample {
    Vec3<Real> direction;    ///< unit
    Real t;                  ///< how far the light is
    Int<Real> primitive_id;  ///< which it is; kNoPrimitive of the image around the scene
    Mask<Real> is_seen;      ///< unless anything lies before it; not where the light is turned edge on
    Mask<Real> is_front;     ///< it is seen from its outward side

    /// Whether it is the image around the scene.
    template <Features features>
    [[nodiscard]] RAYPOOL_INLINE Mask<Real> is_environment() const {
        return features.environment ? as_mask<Real>(primitive_id == Int<Real>(kNoPrimitive)) : Mask<Real>(false);
    }
};

/// What is read of the surface of a light that was sampled: its SurfaceRow, and where on it if it is a triangle.
template <class Real>
struct LightSurface {
    Real row[SurfaceRow<ScalarOf<Real>>::kColumns];
    TrianglePoint<Real> triangle;
};

namespace detail {

/// 1 - cos of half the angle that a sphere fills: to full precision for one that is small or far.
template <class Real>
RAYPOOL_INLINE Real cone_height(const Real& radius, const Real& square_distance) {
    const Real square_sine = min(radius * radius / square_distance, Real(1));
    return square_sine / (Real(1) + sqrt(Real(1) - square_sine));
}

/// Two unit vectors that stand on unit `axis` and on each other (Duff et al., "Building an Orthonormal Basis,
/// Revisited", JCGT 6(1), 2017).
template <class Real>
RAYPOOL_INLINE void make_frame(const Vec3<Real>& axis, Vec3<Real>& u, Vec3<Real>& v) {
    const Real sign = copysign(Real(1), axis[2]);
    const Real a = Real(-1) / (sign + axis[2]);
    const Real b = axis[0] * axis[1] * a;
    u = vec3<Real>(mad<Real>(sign * axis[0] * axis[0], a, Real(1)), sign * b, -sign * axis[0]);
    v = vec3<Real>(b, mad<Real>(axis[1] * axis[1], a, sign), -axis[1]);
}

}  // namespace detail

/// Of solid angle: of sample_light() in the direction of a ray that meets a light at distance t. `weight` is the
/// light's of LightTable::weights, `row` its SurfaceRow.
template <Features features, class Real>
RAYPOOL_INLINE Real light_density(const Ray<Real>& ray, const Real& t, const Real& weight, const Real* row) {
    using S = ScalarOf<Real>;
    using Row = SurfaceRow<S>;
    const Real radius = row[Row::kRadius];
    Vec3<Real> center = vec3<Real>(row[Row::kCenter], row[Row::kCenter + 1], row[Row::kCenter + 2]);
    const Real area_density = weight * t * t / abs(dot<Real>(ray.direction, center));  // of a quad this is the normal
    if constexpr (features.motion) {
        const Vec3<Real> motion = vec3<Real>(row[Row::kMotion], row[Row::kMotion + 1], row[Row::kMotion + 2]);
        center = center_at<Real>(center, motion, ray.time);
    }
    const Vec3<Real> to = vec3<Real>(center[0] - ray.origin[0], center[1] - ray.origin[1], center[2] - ray.origin[2]);
    const Real square = dot<Real>(to, to);
    constexpr S kPi = std::numbers::pi_v<S>;
    const Real solid_angle =
        select(square > radius * radius, Real(2 * kPi) * detail::cone_height<Real>(radius, square), Real(4 * kPi));
    return select(radius > Real(0), weight / solid_angle, area_density);
}

/// Samples a light, of a scene that has some, from where a ray starts, at `time`, by a block of RandomPurpose::Light.
/// Where the light is the image around the scene, sample_environment() says the rest: here it is not seen, and
/// `surface` is that of something.
template <Features features, class Real>
RAYPOOL_INLINE LightSample<Real> sample_light(const SceneView<ScalarOf<Real>>& scene, const RayStart<Real>& start,
                                              const Real& time, const std::array<Real, 4>& random,
                                              LightSurface<Real>& surface) {
    using S = ScalarOf<Real>;
    using Light = LightRow<S>;
    using Row = SurfaceRow<S>;
    const auto load = [&](const Int<Real>& which, Real* light) {
        detail::load_light_rows<Light::kColumns, Real>(scene.lights.data()->value, which, light);
    };
    Real light[Light::kColumns];
    const Int<Real> drawn = draw_entry<Real>(random[0], static_cast<S>(scene.lights.size()));
    load(drawn, light);
    load(select(random[3] < light[Light::kThreshold], drawn, bits_of<Real>(light[Light::kAlias])), light);

    LightSample<Real> sample;
    sample.primitive_id = bits_of<Real>(light[Light::kPrimitive]);
    const Mask<Real> is_around = sample.template is_environment<features>();
    Real* row = surface.row;
    TrianglePoint<Real>& triangle = surface.triangle;
    if constexpr (features.triangles)
        triangle.is_here = as_mask<Real>(sample.primitive_id >= Int<Real>(scene.first_triangle));
    const bool has_triangles = features.triangles && any(triangle.is_here);
    const auto id_or_0 = [&](const Mask<Real>& is_none) { return select(is_none, Int<Real>(0), sample.primitive_id); };
    const Int<Real> row_id =
        features.environment || features.triangles ? id_or_0(is_around || triangle.is_here) : sample.primitive_id;
    detail::load_light_rows<Row::kColumns, Real>(scene.surfaces.data()->value, row_id, row);
    const auto part = [&](int first) { return vec3<Real>(light[first], light[first + 1], light[first + 2]); };
    const Real radius = light[Light::kRadius];
    const Mask<Real> is_sphere = radius > Real(0);
    const Mask<Real> is_leaving =
        as_mask<Real>(PlanarMark<Real>::group(row[Row::kRadius], sample.primitive_id) == start.leaving_id);
    const Vec3<Real>& origin = start.origin;
    Vec3<Real> place = part(Light::kPoint);
    if constexpr (features.motion) {
        if (any(is_sphere)) place = select<Real>(is_sphere, center_at<Real>(place, part(Light::kEdgeU), time), place);
    }
    const Vec3<Real> to = vec3<Real>(place[0] - origin[0], place[1] - origin[1], place[2] - origin[2]);
    sample.direction = vec3<Real>(Real(1), Real(0), Real(0));
    sample.t = Real(kInfinity<Real>);
    sample.is_front = Mask<Real>(false);
    if (!all(is_sphere || is_around)) {
        // Of a triangle those of the parallelogram's points that lie beyond it are turned back into it.
        const Mask<Real> is_beyond = triangle.is_here && random[1] + random[2] > Real(1);
        const Vec3<Real> across =
            along<Real>(to, select(is_beyond, Real(1) - random[1], random[1]), part(Light::kEdgeU));
        const Vec3<Real> point =
            along<Real>(across, select(is_beyond, Real(1) - random[2], random[2]), part(Light::kEdgeV));
        const Mask<Real> is_apart = !is_sphere && dot<Real>(point, point) > Real(0);
        sample.direction = unit<Real>(select<Real>(is_apart, point, sample.direction));
        Real met_triangle(kInfinity<Real>);
        if (has_triangles) {
            Vec3<Real> outward;
            Int<Real> surface_id;
            const TriangleWeights<Real> weights = load_triangle<features, Real>(
                scene, {origin, sample.direction, time}, sample.primitive_id, triangle, outward, surface_id);
            Real of_mesh[Row::kColumns];
            load_rows<Row::kColumns, Real>(scene.surfaces.data()->value, Row::kColumns,
                                           select(triangle.is_here, surface_id, row_id), of_mesh);
            for (int i = 0; i < Row::kColumns; ++i) row[i] = select(triangle.is_here, of_mesh[i], row[i]);
            put_triangle<Real>(triangle.is_here, outward, sample.primitive_id, row);
            const Real t = weights.height / weights.determinant;
            met_triangle = select(is_apart && t > Real(0), t, met_triangle);
        }
        const Vec3<Real> normal = vec3<Real>(row[Row::kCenter], row[Row::kCenter + 1], row[Row::kCenter + 2]);
        const Vec3<Real> plane = vec3<Real>(row[Row::kMotion], row[Row::kMotion + 1], row[Row::kMotion + 2]);
        Real met = plane_distance<Real>(origin, sample.direction, plane, normal, is_leaving || !is_apart);
        if (has_triangles) met = select(triangle.is_here, met_triangle, met);
        // By the plane, as a hit is measured; by the point where the origin lies in the plane but for rounding.
        const Real apart = sqrt(dot<Real>(point, point));
        const Mask<Real> is_grazing = met < Real(kInfinity<Real>) && !(abs(met - apart) <= Real(S(1e-3)) * apart);
        sample.t = select(is_grazing, apart, met);
        sample.is_front = dot<Real>(sample.direction, normal) < Real(0);
    }
    if (any(is_sphere)) {
        const Real square = dot<Real>(to, to);
        const Mask<Real> is_outside = is_sphere && square > radius * radius;
        const Vec3<Real> axis = unit<Real>(select<Real>(is_outside, to, vec3<Real>(Real(1), Real(0), Real(0))));
        Vec3<Real> u;
        Vec3<Real> v;
        detail::make_frame<Real>(axis, u, v);
        const Real height = random[1] * detail::cone_height<Real>(radius, select(is_outside, square, Real(1)));
        const Real sine = sqrt(max(height * (Real(2) - height), Real(0)));
        const SinCos<Real> turn = sincos_of_turn<Real>(random[2]);
        Vec3<Real> toward;
        for (int i = 0; i < 3; ++i)
            toward[i] = mad<Real>(Real(1) - height, axis[i], sine * mad<Real>(turn.cos, u[i], turn.sin * v[i]));
        const Vec3<Real> direction =
            unit<Real>(select<Real>(is_outside, toward, unit_sphere<Real>(random[1], random[2])));
        sample.direction = select<Real>(is_sphere, direction, sample.direction);
        const Real met = sphere_distance<Real>(origin, direction, place, radius, is_leaving);
        // Rounding lets a direction pass the edge, and beside a light that is small or far all of them may.
        const Mask<Real> is_passed = is_outside && !is_leaving && !(met < Real(kInfinity<Real>));
        sample.t = select(is_sphere, select(is_passed, dot<Real>(to, direction), met), sample.t);
        sample.is_front = (is_sphere && is_outside) || (!is_sphere && sample.is_front);
    }
    sample.is_seen = sample.t < Real(kInfinity<Real>) && !is_around;
    return sample;
}

/// What a light sends toward where the ray of a sample starts.
template <Features features, class Real>
RAYPOOL_INLINE Vec3<Real> emitted_radiance(const SceneView<ScalarOf<Real>>& scene, const Ray<Real>& ray,
                                           const LightSample<Real>& light, const LightSurface<Real>& surface,
                                           const Mask<Real>& is_wanted) {
    const Real* row = surface.row;
    const SurfaceCode<Int<Real>> code{bits_of<Real>(row[SurfaceRow<ScalarOf<Real>>::kCode])};
    SurfacePoint<Real> point = surface_point<features, Real>(ray, light.t, row);
    if constexpr (features.triangles) surface.triangle.place(point);
    const SurfaceMaterial<features, Real> material{code.material(), row[SurfaceRow<ScalarOf<Real>>::kParameter]};
    const Vec3<Real> colour =
        surface_colour<features, Real>(scene, point, surface.triangle, light.primitive_id, row, code, is_wanted);
    const Real emission = material.emission(light.is_front);
    return vec3<Real>(colour[0] * emission, colour[1] * emission, colour[2] * emission);
}

}  // namespace raypool
