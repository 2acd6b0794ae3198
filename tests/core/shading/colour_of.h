/// The colour of a surface, as shading finds it.
#pragma once

#include "core/shading/interaction.h"

namespace raypool::test {

/// `row` is the primitive's SurfaceRow.
template <class Scalar>
Vec3<double> colour_of(const CompiledScene<Scalar>& scene, const SurfacePoint<Scalar>& point, int primitive_id,
                       const Scalar* row) {
    const SurfaceCode<Int<Scalar>> code{bits_of<Scalar>(row[SurfaceRow<Scalar>::kCode])};
    return surface_colour<kEverything, Scalar>(scene, point, {}, primitive_id, row, code, true).template cast<double>();
}

}  // namespace raypool::test
