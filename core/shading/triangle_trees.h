/// The trees over triangles: of those that stand alone, of objects, and over the instances of these.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/shading/compiled_scene.h"
#include "core/shading/mesh_rows.h"

namespace raypool {

/// A binary tree over boxes, with at most so many in a leaf.
using BuildBvh = std::function<BinaryBvh(const std::vector<Box>& boxes, std::uint32_t block)>;
template <class Scalar>
using TriangleTree = decltype(ShapeTables<Scalar>::triangle_tree);

/// Over the triangles in `rows`, by any builder. The first of them has the id `first_id`; those without an area are not
/// in it.
template <class Scalar>
TriangleTree<Scalar> triangle_tree(const SceneTables<Scalar>& tables, const TriangleRows& rows, std::int32_t first_id,
                                   const BuildBvh& build);

/// Fills the trees of triangles and instances in `tables`, whose rows are complete but for the roots of instances.
template <class Scalar>
void add_triangle_trees(std::int32_t first_triangle, std::span<const ObjectRows> objects, SceneTables<Scalar>& tables);

extern template TriangleTree<float> triangle_tree(const SceneTables<float>&, const TriangleRows&, std::int32_t,
                                                  const BuildBvh&);
extern template TriangleTree<double> triangle_tree(const SceneTables<double>&, const TriangleRows&, std::int32_t,
                                                   const BuildBvh&);
extern template void add_triangle_trees(std::int32_t, std::span<const ObjectRows>, SceneTables<float>&);
extern template void add_triangle_trees(std::int32_t, std::span<const ObjectRows>, SceneTables<double>&);

}  // namespace raypool
