/// Where rays met triangles: which, and where on them. Called by interaction.h alone.
#pragma once

#include <array>

#include "core/geometry/triangles.h"
#include "core/shading/compiled_scene.h"

namespace raypool {

/// Of the lanes that met a triangle: the triangle, and where on it.
template <class Real>
struct TrianglePoint {
    Mask<Real> is_here = Mask<Real>(false);
    std::array<Int<Real>, 3> vertex_id;
    std::array<Real, 3> weight;  ///< of the vertices, which add up to 1
    Vec3<Real> position;         ///< of the vertices by their weights: its error is one of their coordinates'
    Vec3<Real> error;            ///< of the position, at most, along each axis

    /// Puts a SurfacePoint onto the triangle.
    RAYPOOL_INLINE void place(auto& point) const {
        if (any(is_here)) point.position = select<Real>(is_here, position, point.position);
    }
};

/// Of the lanes in `triangle.is_here`, of which there are some: the rest of it, and its normal and the row of its mesh
/// among the surfaces. Says where the rays meet its plane.
template <Features features, class Real>
RAYPOOL_INLINE TriangleWeights<Real> load_triangle(const SceneView<ScalarOf<Real>>& scene, const Ray<Real>& ray,
                                                   const Int<Real>& primitive_id, TrianglePoint<Real>& triangle,
                                                   Vec3<Real>& outward, Int<Real>& surface_id) {
    using S = ScalarOf<Real>;
    using Triangle = TriangleRow<S>;
    Real columns[Triangle::kColumns];
    const Int<Real> number = select(triangle.is_here, primitive_id - Int<Real>(scene.first_triangle), Int<Real>(0));
    load_rows<Triangle::kColumns, Real>(scene.triangles.data()->value, Triangle::kColumns, number, columns);
    surface_id = select(triangle.is_here, bits_of<Real>(columns[Triangle::kSurface]), primitive_id);
    std::array<Vec3<Real>, 3> vertex;
    for (int i = 0; i < 3; ++i) {
        using Vertex = VertexRow<S>;
        Real position[Vertex::kColumns];
        triangle.vertex_id[i] = bits_of<Real>(columns[Triangle::kVertex + i]);
        load_rows<Vertex::kColumns, Real>(scene.vertices.data()->value, Vertex::kColumns, triangle.vertex_id[i],
                                          position);
        vertex[i] = vec3<Real>(position[0], position[1], position[2]);
    }
    const TriangleWeights<Real> weights = triangle_weights<Real>(ray.origin, ray_shear<Real>(ray.direction), vertex);
    const Real scale = Real(1) / weights.determinant;
    for (int i = 0; i < 3; ++i) triangle.weight[i] = weights.of_vertex[i] * scale;
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = [&](int i) { return vertex[i][axis]; };
        triangle.position[axis] =
            mad<Real>(triangle.weight[0], at(0), mad<Real>(triangle.weight[1], at(1), triangle.weight[2] * at(2)));
    }
    triangle.error = triangle_error<Real>(vertex);
    outward = triangle_normal<Real>(vertex);
    return weights;
}

/// The same by a call: a recursion has its frame at every depth, and needs none of the temporaries there.
template <Features features, class Real>
[[gnu::noinline]] RAYPOOL_HOST_DEVICE void call_load_triangle(const SceneView<ScalarOf<Real>>& scene,
                                                              const Ray<Real>& ray, const Int<Real>& primitive_id,
                                                              TrianglePoint<Real>& triangle, Vec3<Real>& outward,
                                                              Int<Real>& surface_id) {
    load_triangle<features, Real>(scene, ray, primitive_id, triangle, outward, surface_id);
}

}  // namespace raypool
