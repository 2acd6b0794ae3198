/// Which shapes of a scene lie on the same surface, so that each surface is met once.
///
/// A ray knows what it leaves. That is not enough where two shapes are one surface: the ray would meet the other one
/// again, an ulp away or not, as rounding has it. So shapes that differ by no more than the rounding error of hits on
/// them count as one, decided here before anything is rendered, and no ray is moved for it. Of shapes that coincide the
/// first listed counts. A shape that an earlier one covers everywhere is hidden. Quads and planes that cover only parts
/// of one another share one plane, bit for bit: they are met at one distance, where the smaller id wins, and a ray that
/// leaves one meets none of them, as a straight line meets a plane once.
#pragma once

#include <cstdint>
#include <vector>

#include "core/scene/scene.h"

namespace raypool {

struct Coincidence {
    /// The plane that a quad or plane is met in.
    struct Planar {
        Vector3d point;
        Vector3d normal;          ///< unit, on the shape's own outward side
        std::uint32_t group = 0;  ///< an id that shapes which share the plane have in common
    };
    std::vector<bool> is_hidden;  ///< by primitive id
    std::vector<Planar> planars;  ///< by primitive id, quads first, less the number of spheres
};

/// For hits that are computed in Scalar. Takes about n log n steps for n shapes, and n^2 where many quads cross one
/// another, as in a fan around an edge.
template <class Scalar>
Coincidence find_coincidence(const Scene& scene);

/// As if no two shapes coincided.
Coincidence no_coincidence(const Scene& scene);

extern template Coincidence find_coincidence<float>(const Scene&);
extern template Coincidence find_coincidence<double>(const Scene&);

}  // namespace raypool
