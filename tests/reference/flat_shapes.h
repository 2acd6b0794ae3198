/// Quads, planes and triangles of the brute-force tracer, and what is smooth about triangles.
#pragma once

#include <array>

#include "core/scene/scene.h"
#include "tests/reference/plain_vector.h"

namespace raypool::test {

inline Vec vec(const Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

/// A quad, a triangle or a plane, with the vectors that coordinates in it are measured along.
struct Flat {
    enum class Kind { Quad, Plane, Triangle };  ///< ends where a coordinate leaves [0, 1], or nowhere, or at u + v = 1
    Vec corner, normal, along_u, along_v;
    Kind kind;
    int material_id;
    Coordinates texture[3] = {{0, 0}, {1, 0}, {0, 1}};  ///< at (0, 0), (1, 0) and (0, 1)
    bool is_smooth = false;
    std::array<Vec, 3> corners{}, normals{};  ///< of a smooth triangle, unit, in the order of `texture`
};

inline Coordinates coordinates(const Flat& flat, Vec p) {
    const Vec offset = p - flat.corner;
    return {dot(offset, flat.along_u), dot(offset, flat.along_v)};
}

inline Coordinates texture_coordinates(const Flat& flat, Vec p) {
    const auto [s, t] = coordinates(flat, p);
    const auto& [at_corner, at_u, at_v] = flat.texture;
    return {at_corner.u + s * (at_u.u - at_corner.u) + t * (at_v.u - at_corner.u),
            at_corner.v + s * (at_u.v - at_corner.v) + t * (at_v.v - at_corner.v)};
}

/// By the matrix of cofactors, which is the inverse transpose but for its length and, where it mirrors, its sign.
inline Vec placed_normal(const MeshShape& shape, const std::array<float, 3>& normal) {
    const Vec x = vec(shape.transform.col(0)), y = vec(shape.transform.col(1)), z = vec(shape.transform.col(2));
    const Vec n = double{normal[0]} * cross(y, z) + double{normal[1]} * cross(z, x) + double{normal[2]} * cross(x, y);
    return unit(dot(cross(x, y), z) < 0 ? -1 * n : n);
}

/// What a smooth triangle has in place of its normal, and the way from a point of it to where rays start.
struct Smooth {
    Vec normal, lift;
    bool is_above;
};
/// Phong's normal, turned to face the ray by a cosine of 0.01, and the start of rays after Hanika: each vertex's
/// tangent plane lifts a point that lies below it. `side` is the triangle's normal toward the ray.
inline Smooth smooth_at(const Flat& flat, Vec p, Vec side, Vec direction) {
    const auto [s, t] = coordinates(flat, p);
    const double weights[3] = {1 - s - t, s, t};
    Vec sum;
    for (int i = 0; i < 3; ++i) sum = sum + weights[i] * flat.normals[i];
    const double turn = dot(sum, side) < 0 ? -1 : 1;
    Smooth smooth{unit(turn * sum), {}, false};
    const double averted = dot(smooth.normal, direction) + 0.01;
    if (averted > 0) smooth.normal = unit(smooth.normal - averted * direction);
    for (int i = 0; i < 3; ++i) {
        const double depth = dot(flat.corners[i] - p, turn * flat.normals[i]);
        if (depth > 0) smooth.lift = smooth.lift + weights[i] * depth * turn * flat.normals[i];
    }
    smooth.is_above = dot(smooth.lift, side) > 1e-5;
    if (!smooth.is_above) smooth.lift = {};
    return smooth;
}

}  // namespace raypool::test
