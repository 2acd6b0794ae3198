/// Where rays met triangles: which, where on them, and what is smooth about them. Called by interaction.h and
/// lights.h.
#pragma once

#include <array>

#include "core/geometry/smooth_triangles.h"
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
    Mask<Real> is_smooth = Mask<Real>(false);  ///< it is here, and all of its vertices have normals
    SmoothPoint<Real> smooth;                  ///< where is_smooth

    /// Puts a SurfacePoint onto the triangle.
    RAYPOOL_INLINE void place(auto& point) const {
        if (any(is_here)) point.position = select<Real>(is_here, position, point.position);
        if (any(is_smooth)) {
            point.normal = select<Real>(is_smooth, smooth.normal, point.normal);
            point.is_bounded = is_smooth && !smooth.is_lifted;
            point.is_bounded_beyond = is_smooth;
        }
    }
};

/// Of the lanes that met an instance: how it is placed, and its material.
template <class Real>
struct InstancePoint {
    bool is_any = false;  ///< else nothing else is set
    Mask<Real> is_here;
    Placing<Real> placing;
    Int<Real> surface_id;
};

/// Makes of `triangle`, the number of a triangle by its id, the row of one of an object where there is an instance.
template <class Real>
RAYPOOL_INLINE InstancePoint<Real> load_instance(const SceneView<ScalarOf<Real>>& scene, const Int<Real>& primitive_id,
                                                 Int<Real>& triangle) {
    using Row = InstanceRow<ScalarOf<Real>>;
    InstancePoint<Real> instance;
    if (scene.instance_first_ids.empty()) return instance;
    instance.is_here = as_mask<Real>(primitive_id >= Int<Real>(scene.first_instanced));
    instance.is_any = any(instance.is_here);
    if (!instance.is_any) return instance;
    const Int<Real> number = instance_of<Real>(scene, primitive_id);
    constexpr int kFirst = Row::kTransform;
    Real columns[Row::kColumns - kFirst];
    load_rows<Row::kColumns - kFirst, Real>(scene.instance_tree.blocks.data()->value + kFirst, Row::kColumns, number,
                                            columns);
    const auto whole = [&](int column) { return bits_of<Real>(columns[column - kFirst]); };
    instance.placing = Placing<Real>::of(columns);
    instance.surface_id = whole(Row::kSurface);
    triangle = select(instance.is_here, primitive_id - whole(Row::kFirstId) + whole(Row::kFirstTriangle), triangle);
    return instance;
}

/// Of the lanes in `triangle.is_here`, of which there are some: the rest of it, and its normal and the row of its mesh
/// among the surfaces. Says where the rays meet its plane.
template <Features features, class Real>
RAYPOOL_INLINE TriangleWeights<Real> load_triangle(const SceneView<ScalarOf<Real>>& scene, const Ray<Real>& ray,
                                                   const Int<Real>& primitive_id, TrianglePoint<Real>& triangle,
                                                   Vec3<Real>& outward, Int<Real>& surface_id) {
    using S = ScalarOf<Real>;
    using Triangle = TriangleRow<S>;
    Real columns[Triangle::kColumns];
    Int<Real> number = select(triangle.is_here, primitive_id - Int<Real>(scene.first_triangle), Int<Real>(0));
    const InstancePoint<Real> instance = load_instance<Real>(scene, primitive_id, number);
    load_rows<Triangle::kColumns, Real>(scene.triangles.data()->value, Triangle::kColumns, number, columns);
    surface_id = select(triangle.is_here, bits_of<Real>(columns[Triangle::kSurface]), primitive_id);
    if (instance.is_any) surface_id = select(instance.is_here, instance.surface_id, surface_id);
    std::array<Vec3<Real>, 3> vertex;
    std::array<Int<Real>, 3> normal_id;
    for (int i = 0; i < 3; ++i) {
        using Vertex = VertexRow<S>;
        Real position[Vertex::kColumns];
        triangle.vertex_id[i] = bits_of<Real>(columns[Triangle::kVertex + i]);
        load_rows<Vertex::kColumns, Real>(scene.vertices.data()->value, Vertex::kColumns, triangle.vertex_id[i],
                                          position);
        vertex[i] = vec3<Real>(position[0], position[1], position[2]);
        normal_id[i] = bits_of<Real>(position[Vertex::kNormal]);
        if (instance.is_any) vertex[i] = select<Real>(instance.is_here, instance.placing.point(vertex[i]), vertex[i]);
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
    if (instance.is_any) {  // placed where rounding leaves its triangle no area, it may be met all the same
        const Mask<Real> is_flat = !(dot<Real>(outward, outward) > Real(0));
        outward = select<Real>(instance.is_here && is_flat, -ray.direction, outward);
    }

    const Int<Real> lowest_bits = normal_id[0] | normal_id[1] | normal_id[2];  // negative where one of them is
    triangle.is_smooth = triangle.is_here && as_mask<Real>(lowest_bits >= Int<Real>(0));
    if (none(triangle.is_smooth)) return weights;
    std::array<Vec3<Real>, 3> normal;
    for (int i = 0; i < 3; ++i) {
        Real columns_of_normal[4];  // the fourth is of the next
        load_rows<4, Real>(scene.vertex_normals.data(), 3, select(triangle.is_smooth, normal_id[i], Int<Real>(0)),
                           columns_of_normal);
        normal[i] = vec3<Real>(columns_of_normal[0], columns_of_normal[1], columns_of_normal[2]);
        if (instance.is_any) normal[i] = select<Real>(instance.is_here, instance.placing.normal(normal[i]), normal[i]);
    }
    triangle.smooth =
        smooth_point<Real>(vertex, normal, triangle.weight, triangle.position, triangle.error, outward, ray.direction);
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
