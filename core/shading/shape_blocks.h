/// The blocks of shapes that a ray is tested against, and the trees over them: made of the rows of a compiled scene.
#pragma once

#include <span>

#include "core/geometry/coincidence.h"
#include "core/scene/scene.h"
#include "core/shading/compiled_scene.h"
#include "core/shading/mesh_rows.h"

namespace raypool {

/// Fills the ShapeTables part of `tables`, whose rows are complete but for the roots of instances. A shape that another
/// one hides is in no block.
template <class Scalar>
void add_blocks(const Scene& scene, const Coincidence& coincidence, std::span<const ObjectRows> objects,
                SceneTables<Scalar>& tables);

extern template void add_blocks(const Scene&, const Coincidence&, std::span<const ObjectRows>, SceneTables<float>&);
extern template void add_blocks(const Scene&, const Coincidence&, std::span<const ObjectRows>, SceneTables<double>&);

}  // namespace raypool
