/// What happens to a ray at the end of its segment: it leaves for the sky, meets an emitter, or is scattered.
///
/// Called by every engine, one ray or a register of rays at a time, with the same bits per ray either way. A path is
/// carried on by value: throughput is multiplied down the path in one order, so that engines agree.
#pragma once

#include "core/geometry/shapes.h"
#include "core/math/path.h"
#include "core/shading/checker_method.h"
#include "core/shading/compiled_scene.h"
#include "core/shading/materials.h"
#include "core/shading/textures.h"

namespace raypool {

/// Radiance from the direction of a ray that met nothing.
template <class Real>
RAYPOOL_INLINE Vec3<Real> sky_radiance(const Sky<ScalarOf<Real>>& sky, const Vec3<Real>& direction) {
    return along<Real>(broadcast<Real>(sky.middle), direction[1], broadcast<Real>(sky.slope));
}

/// A point on a surface, seen along a ray.
template <class Real>
struct SurfacePoint {
    Vec3<Real> position;
    Vec3<Real> normal;    ///< unit, on the side that the ray arrives from
    Vec3<Real> outward;   ///< unit, geometric: away from a sphere's centre
    Mask<Real> is_front;  ///< the ray arrives from the outward side
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

/// The row's colour, or what its texture makes of it, where `is_wanted`.
template <Features features, class Real>
RAYPOOL_INLINE Vec3<Real> surface_colour(const SceneView<ScalarOf<Real>>& scene, const SurfacePoint<Real>& point,
                                         const Int<Real>& primitive_id, const Real* row,
                                         const SurfaceCode<Int<Real>>& code, const Mask<Real>& is_wanted) {
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
                const Mask<Real> is_planar = row[Row::kRadius] < Real(0);
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
        const Mask<Real> is_odd = (is_checker_3d || is_checker_uv) &&
                                  CheckerMethod<features.variant>::template is_odd<Real>(at, outward, scale);
        colour = select<Real>(is_odd, odd, colour);
    }
    if constexpr (features.uv) {
        for (unsigned bits = mask_bits(is_image); bits != 0; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            const auto& image = scene.images[static_cast<std::size_t>(lane(code.texture_row(), i))];
            const auto repeat = static_cast<int>(lane(texture_kind, i)) - static_cast<int>(Texture::Kind::Image);
            const Vec3<S> texel =
                image_colour<S>(image, lane(uv[0], i), lane(uv[1], i), ImageRepeat::of_number(repeat));
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

/// Hits after which a path takes part in Russian roulette.
inline constexpr std::uint32_t kHitsBeforeRoulette = 3;

/// Ends paths by chance and makes up for it in those that go on (Arvo and Kirk, "Particle Transport and Image
/// Synthesis", 1990): a path survives with the probability q = min(1, greatest channel of its throughput) and is
/// divided by q, so that its expectation stays. q is rounded up to a multiple of 2^-24, the step of `random`: then
/// random < q has exactly that probability. Returns who survives.
template <class Real>
RAYPOOL_INLINE Mask<Real> survives_roulette(Vec3<Real>& throughput, const Real& random, const Mask<Real>& is_played) {
    constexpr float kSteps = 1U << 24U;
    const Real most = max(max(throughput[0], throughput[1]), throughput[2]);
    const Real q = -floor(-most * Real(kSteps)) * Real(1 / kSteps);
    const Mask<Real> is_chance = is_played && q < Real(1) && q > Real(0);
    const Real divisor = select(is_chance, q, Real(1));
    for (int i = 0; i < 3; ++i) throughput[i] = throughput[i] / divisor;
    return !is_chance || random < q;
}

/// Whether glass may send a path both ways instead of drawing one of them.
enum class Splitting : bool { Off, On };

/// How a ray starts on a surface: where, and what it cannot hit.
template <class Real>
struct RayStart {
    Vec3<Real> origin;
    Int<Real> leaving_id;  ///< a sphere's id; of a quad or plane the id of the shapes in its plane
};

/// A path after a hit.
template <class Real>
struct Scattered {
    RayStart<Real> start;
    Vec3<Real> direction;
    Vec3<Real> throughput;  ///< where is_emitter: the radiance that the path brings home
    Mask<Real> is_alive;    ///< the path goes on
    Mask<Real> is_emitter;  ///< the path ends on an emitter

    // With Splitting::On, and where is_split: the above is the refracted branch, and there is a reflected one.
    Mask<Real> is_split;
    Vec3<Real> reflected_direction;
    Vec3<Real> reflected_throughput;
    Mask<Real> is_reflected_alive;
};

/// Scatters rays that hit primitive `primitive_id` (valid in every lane, also those the caller ignores) at distance t.
/// `step` is the path's (path_step). A path that can carry nothing any more is not alive. With Splitting::On, the first
/// `split_depth` hits on glass split a path in two, weighted by Fresnel's reflectance. With `roulette`, paths end by
/// chance after kHitsBeforeRoulette hits; both branches of a split play with one number.
template <Features features, class Real, Splitting splitting = Splitting::Off>
RAYPOOL_INLINE Scattered<Real> scatter(const SceneView<ScalarOf<Real>>& scene, const Ray<Real>& ray, const Real& t,
                                       const Int<Real>& primitive_id, const Vec3<Real>& throughput,
                                       const PathKey<Real>& key, const Uint32<Real>& step, const RandomSeed& seed,
                                       int split_depth = 0, bool roulette = false) {
    using S = ScalarOf<Real>;
    using Row = SurfaceRow<S>;
    Real row[Row::kColumns];
    load_rows<Row::kColumns, Real>(scene.surfaces.data()->value, Row::kColumns, primitive_id, row);
    const SurfaceCode<Int<Real>> code{bits_of<Real>(row[Row::kCode])};
    const Int<Real> material = code.material();
    const auto is_material = [&](Material::Kind kind) {
        return as_mask<Real>(material == Int<Real>(static_cast<int>(kind)));
    };

    const SurfacePoint<Real> point = surface_point<features, Real>(ray, t, row);
    const std::array<Real, 4> random = random_block<Real>(key, step, RandomPurpose::Scatter, seed);

    Scattered<Real> out;
    out.start.origin = point.position;
    out.start.leaving_id = primitive_id;
    if constexpr (features.planar) out.start.leaving_id = PlanarMark<Real>::group(row[Row::kRadius], primitive_id);
    out.is_emitter = features.emissive ? is_material(Material::Kind::Emissive) : Mask<Real>(false);
    const Mask<Real> is_glass = features.dielectric ? is_material(Material::Kind::Dielectric) : Mask<Real>(false);
    const Mask<Real> is_metal = features.metal ? is_material(Material::Kind::Metal) : Mask<Real>(false);

    // Colour: of all but glass.
    const Vec3<Real> colour = surface_colour<features, Real>(scene, point, primitive_id, row, code, !is_glass);
    for (int i = 0; i < 3; ++i) out.throughput[i] = select(is_glass, throughput[i], throughput[i] * colour[i]);

    // Direction, by material.
    out.direction = point.normal;
    Mask<Real> is_absorbed(false);
    if constexpr (splitting == Splitting::On) {
        out.is_split = Mask<Real>(false);
        out.reflected_direction = out.reflected_throughput = vec3<Real>(Real(0), Real(0), Real(0));
    }
    const Mask<Real> is_rough = features.fuzz ? is_metal && row[Row::kParameter] > Real(0) : Mask<Real>(false);
    const Mask<Real> is_diffuse = !(is_glass || is_metal || out.is_emitter);
    Vec3<Real> on_sphere = point.normal;
    if (any(is_diffuse || is_rough)) on_sphere = unit_sphere<Real>(random[0], random[1]);
    if (any(is_diffuse)) out.direction = diffuse_direction<Real>(point.normal, on_sphere);
    if constexpr (features.metal || features.dielectric) {
        if (any(is_metal || is_glass)) {
            const Vec3<Real> mirrored = mirror_direction<Real>(ray.direction, point.normal);
            Vec3<Real> direction = mirrored;  // NOLINT(performance-unnecessary-copy-initialization): fuzz changes it
            if constexpr (features.fuzz) {
                if (any(is_rough)) {
                    direction = select<Real>(is_rough, fuzzy_direction<Real>(mirrored, row[Row::kParameter], on_sphere),
                                             direction);
                }
            }
            if constexpr (features.metal) is_absorbed = is_metal && dot<Real>(direction, point.normal) <= Real(0);
            if constexpr (features.dielectric) {
                if (any(is_glass)) {
                    const Real ior = row[Row::kParameter];
                    const Real eta = select(point.is_front, Real(1) / ior, ior);
                    const FresnelSplit<Real> split = fresnel_split<Real>(ray.direction, point.normal, eta);
                    Mask<Real> is_refracted = is_glass && random[2] >= split.reflectance;
                    if constexpr (splitting == Splitting::On) {
                        const Real most_branches(static_cast<S>((1 << split_depth) - 1));
                        out.is_split =
                            is_glass && from_uint32<Real>(path_step::branch<Uint32<Real>>(step)) < most_branches;
                        is_refracted = is_refracted || out.is_split;
                        out.reflected_direction = mirrored;
                        const Real transmittance = Real(1) - split.reflectance;
                        for (int i = 0; i < 3; ++i) {
                            out.reflected_throughput[i] = throughput[i] * split.reflectance;
                            out.throughput[i] = select(out.is_split, throughput[i] * transmittance, out.throughput[i]);
                        }
                    }
                    direction = select<Real>(is_refracted, split.refracted, direction);
                }
            }
            out.direction = select<Real>(is_metal || is_glass, direction, out.direction);
        }
    }

    const auto carries_light = [](const Vec3<Real>& carried) {
        return carried[0] > Real(0) || carried[1] > Real(0) || carried[2] > Real(0);
    };
    out.is_alive = carries_light(out.throughput) && !(is_absorbed || out.is_emitter);
    if constexpr (splitting == Splitting::On) {
        out.is_reflected_alive = out.is_split && carries_light(out.reflected_throughput);
    }
    if (roulette) [[unlikely]] {
        const Mask<Real> is_played =
            from_uint32<Real>(path_step::bounce<Uint32<Real>>(step)) >= Real(static_cast<S>(kHitsBeforeRoulette - 1));
        const Mask<Real> survives = survives_roulette<Real>(out.throughput, random[3], is_played && !out.is_emitter);
        out.is_alive = out.is_alive && survives;
        if constexpr (splitting == Splitting::On) {
            const Mask<Real> survives_too = survives_roulette<Real>(out.reflected_throughput, random[3], is_played);
            out.is_reflected_alive = out.is_reflected_alive && survives_too;
        }
    }
    return out;
}

}  // namespace raypool
