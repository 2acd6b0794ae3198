/// The blocks of shapes that a ray is tested against, and the trees over them: made of the rows of a compiled scene.
#pragma once

#include "core/geometry/coincidence.h"
#include "core/scene/scene.h"
#include "core/shading/compiled_scene.h"

namespace raypool {

/// Fills the ShapeTables part of `tables`, whose rows of surfaces and planars are complete. A shape that another one
/// hides is in no block.
template <class Scalar>
void add_blocks(const Scene& scene, const Coincidence& coincidence, SceneTables<Scalar>& tables);

extern template void add_blocks(const Scene&, const Coincidence&, SceneTables<float>&);
extern template void add_blocks(const Scene&, const Coincidence&, SceneTables<double>&);

}  // namespace raypool
