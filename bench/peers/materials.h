/// What a ray does at a surface, in the peer's own words: where it is, its colour, and where the path goes next.
///
/// Called by both tracers, one lane at a time. What the packet tracer calls has no branches; directions are unit.
#pragma once

#include "bench/peers/embree_scene.h"

namespace raypool::peers {

template <class F>
struct SurfacePoint {
    V3<F> position;
    V3<F> outward;  ///< away from a sphere's centre, along a flat's normal
    V3<F> normal;   ///< the same, on the side the ray comes from
    MaskOf<F> is_front;
};

/// The rows of the surface table of one hit, or of a packet.
template <class F>
class Rows {
  public:
    Rows(const EmbreeScene& scene, IntOf<F> id) : table_(scene.surfaces()), start_(id * int{Surface::kColumns}) {}

    RAYPOOL_PEER_INLINE F value(Surface::Column column) const { return gather(table_ + column, start_); }
    RAYPOOL_PEER_INLINE V3<F> vector(Surface::Column column) const {
        return {gather(table_ + column, start_), gather(table_ + column + 1, start_),
                gather(table_ + column + 2, start_)};
    }
    RAYPOOL_PEER_INLINE MaskOf<F> is(Texture::Kind kind) const {
        return value(Surface::kTexture) == static_cast<float>(kind);
    }
    /// Whether the colour depends on surface coordinates.
    RAYPOOL_PEER_INLINE MaskOf<F> is_mapped() const {
        return value(Surface::kTexture) >= static_cast<float>(Texture::Kind::CheckerUv);
    }

  private:
    const float* table_;
    IntOf<F> start_;
};

/// Where the distance is longer than a sphere's radius, what rounding has moved off the sphere is put back onto it.
template <class F>
RAYPOOL_PEER_INLINE SurfacePoint<F> surface_point(const Rows<F>& rows, V3<F> origin, V3<F> direction, F time, F t) {
    const V3<F> shape = rows.vector(Surface::kShape);
    const F radius = rows.value(Surface::kRadius);
    const V3<F> center = shape + time * rows.vector(Surface::kMotion);
    const V3<F> p = origin + t * direction;
    const MaskOf<F> is_sphere = radius > 0.0F;
    SurfacePoint<F> point;
    point.outward = choose(is_sphere, unit_or(p - center, shape), shape);
    point.position = choose(is_sphere & (radius < t), center + radius * point.outward, p);
    point.is_front = dot(direction, point.outward) < 0.0F;
    point.normal = choose(point.is_front, point.outward, -point.outward);
    return point;
}

// Textures.

/// Whether the cell that holds p, with `density` cells a unit, has an odd sum of indices.
template <class F>
RAYPOOL_PEER_INLINE MaskOf<F> is_odd_cell(V3<F> p, F density) {
    const F sum = floor(p.x * density) + floor(p.y * density) + floor(p.z * density);
    return 2.0F * floor(0.5F * sum) != sum;
}

/// Of a solid colour or a checker in space.
template <class F>
RAYPOOL_PEER_INLINE V3<F> colour(const Rows<F>& rows, V3<F> position) {
    const V3<F> even = rows.vector(Surface::kColour);
    const MaskOf<F> is_checker = rows.is(Texture::Kind::Checker3d);
    if (!any(is_checker)) return even;
    const MaskOf<F> is_odd = is_odd_cell<F>(position + rows.vector(Surface::kOffset), rows.value(Surface::kDensity));
    return choose(is_checker & is_odd, rows.vector(Surface::kOdd), even);
}

/// Of a texture in surface coordinates; (u, v) are a flat's, a sphere has its own.
V3<float> mapped_colour(const EmbreeScene& scene, int id, V3<float> outward, float u, float v);

// Materials.

template <class F>
RAYPOOL_PEER_INLINE V3<F> diffuse(V3<F> normal, V3<F> sphere_point) {
    return unit_or(normal + sphere_point, normal);
}

template <class F>
RAYPOOL_PEER_INLINE V3<F> mirror(V3<F> direction, V3<F> normal) {
    return direction - (2.0F * dot(direction, normal)) * normal;
}

template <class F>
RAYPOOL_PEER_INLINE V3<F> fuzzy(V3<F> mirrored, F fuzz, V3<F> sphere_point) {
    return unit_or(mirrored + fuzz * sphere_point, mirrored);
}

/// Reflects or refracts by chance, with Fresnel's reflectance (Born and Wolf, "Principles of Optics", 1.5.2) of
/// unpolarised light as the probability. Where ior is 1 nothing happens.
template <class F>
RAYPOOL_PEER_INLINE V3<F> glass(V3<F> direction, V3<F> mirrored, V3<F> normal, MaskOf<F> is_front, F ior, F chance) {
    const F eta = select(is_front, 1.0F / ior, ior);
    const F cos_in = -dot(direction, normal);
    const F sin2_in = 1.0F - cos_in * cos_in;
    const F sin2_out = eta * eta * select(sin2_in > 0.0F, sin2_in, F{});
    const F cos_out = root(1.0F - sin2_out);
    const F across = (eta * cos_in - cos_out) / (eta * cos_in + cos_out);
    const F within = (eta * cos_out - cos_in) / (eta * cos_out + cos_in);
    const F reflectance = 0.5F * (across * across + within * within);
    const V3<F> refracted = unit_or(eta * direction + (eta * cos_in - cos_out) * normal, direction);
    const MaskOf<F> is_reflected = (sin2_out >= 1.0F) | (chance < reflectance);
    return choose(eta == 1.0F, direction, choose(is_reflected, mirrored, refracted));
}

}  // namespace raypool::peers
