/// Whether anything lies between a point and a light: any hit is enough, so the order in which a tree is walked does
/// not show. The tests of boxes and shapes are those of traverse.h.
#pragma once

#include "core/geometry/occlusion.h"
#include "core/geometry/traverse.h"

namespace raypool {

namespace detail {

/// From `child` of the tree on, until something hides the light.
template <Features features, class Real, class Tree, class Boxes, class Ready, class Work>
RAYPOOL_INLINE void walk(const Tree& tree, const Boxes& boxes, const Ready& ready, Occlusion<ScalarOf<Real>>& light,
                         Work& work, std::int32_t child) {
    const TreeBounds<features, Tree> bounds(tree);
    std::int32_t stack[kTraversalStack<kLanes<Real>>];
    std::int32_t* top = stack;
    *top++ = child;
    while (top != stack && !light.is_hidden) {
        child = *--top;
        if (child < 0) {
            meet_leaf<features, Real>(tree, child, ready, light, work);
            continue;
        }
        const auto index = static_cast<std::size_t>(child);
        const auto& node = tree.nodes[index];
        work.count(node);
        Vec3<Real> near;
        Vec3<Real> far;
        for (int i = 0; i < 3; ++i)
            bounds.template children<Real>(index, i, boxes.sign[i], boxes.time, near[i], far[i]);
        const Interval<Real> inside = ray_interval<Real>(near, far, boxes, Real(light.t));
        for (unsigned bits = mask_bits(inside.enter <= inside.exit); bits != 0; bits &= bits - 1)
            *top++ = node.child[std::countr_zero(bits)];
    }
}

}  // namespace detail

/// Whether anything lies before a light that the ray is to reach. The order in which shapes are tested does not show.
template <Features features, class Scalar, class Work>
[[gnu::noinline]] bool is_occluded(const ShapeView<Scalar>& scene, const Ray<Scalar>& ray, std::int32_t leaving_id,
                                   Occlusion<Scalar> light, Work& work) {
    using Real = Wide<Scalar, kTreeWidth<Scalar>>;
    const SpreadRay<Real> spread(ray, ray_inverse<Scalar>(ray.direction), leaving_id);
    detail::test_untreed<features, Real>(scene, spread, light, work);
    if constexpr (features.planar) {
        if (!light.is_hidden) detail::walk<features, Real>(scene.quad_tree, spread, light, work);
    }
    if constexpr (features.triangles) {
        const auto walk_apart = [&](const auto& tree) {
            if (light.is_hidden || tree.nodes.empty()) return;
            light = detail::walk_apart<Real>(ray, leaving_id, light, [&](const SpreadRay<Real>& apart, auto& found) {
                detail::walk<features, Real>(tree, apart, found, work);
            });
        };
        walk_apart(scene.triangle_tree);
        walk_apart(scene.instance_tree);
    }
    if (!light.is_hidden) detail::walk<features, Real>(scene.sphere_tree, spread, light, work);
    return light.is_hidden;
}

}  // namespace raypool
