/// The blocks of shapes that a ray is tested against, and the trees over them: made of the rows of a compiled scene.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/geometry/coincidence.h"
#include "core/scene/scene.h"
#include "core/shading/compiled_scene.h"

namespace raypool {

/// Fills the ShapeTables part of `tables`, whose rows of surfaces and planars are complete. A shape that another one
/// hides is in no block.
template <class Scalar>
void add_blocks(const Scene& scene, const Coincidence& coincidence, SceneTables<Scalar>& tables);

/// A binary tree over boxes, with at most so many in a leaf.
using BuildBvh = std::function<BinaryBvh(const std::vector<Box>& boxes, std::uint32_t block)>;
template <class Scalar>
using TriangleTree = decltype(ShapeTables<Scalar>::triangle_tree);

/// What add_blocks() makes of the triangles of `tables`, by any builder. The first of them has the id `first_triangle`;
/// those without an area are not in it.
template <class Scalar>
TriangleTree<Scalar> triangle_tree(const SceneTables<Scalar>& tables, std::int32_t first_triangle,
                                   const BuildBvh& build);

extern template void add_blocks(const Scene&, const Coincidence&, SceneTables<float>&);
extern template void add_blocks(const Scene&, const Coincidence&, SceneTables<double>&);
extern template TriangleTree<float> triangle_tree(const SceneTables<float>&, std::int32_t, const BuildBvh&);
extern template TriangleTree<double> triangle_tree(const SceneTables<double>&, std::int32_t, const BuildBvh&);

}  // namespace raypool
