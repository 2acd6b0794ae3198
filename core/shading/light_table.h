/// The lights of a scene that are sampled: emissive quads, spheres and triangles, and an image around the scene, chosen
/// by their power.
#pragma once

#include <vector>

#include "core/math/real.h"
#include "core/scene/scene.h"

namespace raypool {

/// A light: where points on it are, and its entry in the alias table (alias_table.h). Of the image around the scene all
/// is 0 but that, and the primitive, which is kNoPrimitive.
template <class Scalar>
struct alignas(4 * sizeof(Scalar)) LightRow {
    enum Column {
        kPoint = 0,   ///< the corner of a quad, a vertex of a triangle, the centre of a sphere at time 0; three
        kRadius = 3,  ///< of a sphere; 0 of what is flat
        kEdgeU = 4,   ///< of a quad or, from that vertex, of a triangle, three; of a sphere the motion of its centre
                      ///< from time 0 to 1
        kThreshold = 7,
        kEdgeV = 8,       ///< three
        kAlias = 11,      ///< the bits of a whole number
        kPrimitive = 12,  ///< the bits of the primitive's id
        kColumns = 16
    };
    Scalar value[kColumns];
};

template <class Scalar>
struct LightTable {
    std::vector<LightRow<Scalar>> rows;
    /// By primitive id, of triangles only where a mesh is an emitter, and empty where there is no light: the
    /// probability that a light is chosen, of a quad or triangle divided by its area; 0 of what is no light. It is
    /// exactly that with which sample_light() chooses from the rows, whose random numbers are multiples of 2^-24; so it
    /// differs from the share of the power by rounding to such steps.
    std::vector<Scalar> weights;
    double environment_chance = 0;  ///< the probability that the image around the scene is chosen
};

/// Ids are spheres', then quads', then planes', then triangles', as everywhere. Planes have no end and are no lights,
/// and what is hidden by coincidence (`is_hidden`, by id, of what is no triangle) and triangles without an area are
/// none.
template <class Scalar>
LightTable<Scalar> light_table(const Scene& scene, const std::vector<bool>& is_hidden);

extern template LightTable<float> light_table(const Scene&, const std::vector<bool>&);
extern template LightTable<double> light_table(const Scene&, const std::vector<bool>&);

}  // namespace raypool
