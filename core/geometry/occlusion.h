/// Whether anything lies between a point and a light: any hit is enough, so the order in which a tree is walked does
/// not show. The tests of boxes and shapes are those of traverse.h.
#pragma once

#include "core/geometry/traverse.h"

namespace raypool {

namespace detail {

/// Whether a shape of the tree is met before `light`.
template <Features features, class Real, class Block, class Work>
RAYPOOL_INLINE bool is_met(const TreeView<Block, ScalarOf<Real>, kLanes<Real>>& tree, const SpreadRay<Real>& ray,
                           const Hit<ScalarOf<Real>>& light, Work& work) {
    if (tree.nodes.empty()) return false;
    const TreeBounds<features, TreeView<Block, ScalarOf<Real>, kLanes<Real>>> bounds(tree);
    std::int32_t stack[kTraversalStack<kLanes<Real>>];
    std::int32_t* top = stack;
    *top++ = 0;
    while (top != stack) {
        const std::int32_t child = *--top;
        if (child < 0) {
            const Block& block = tree.blocks[~child];
            work.count(block);
            Hit<ScalarOf<Real>> hit = light;
            intersect_block<features, InBox::Yes, Real>(block, ray, hit);
            if (hit.primitive_id != light.primitive_id) return true;
            continue;
        }
        const auto index = static_cast<std::size_t>(child);
        const auto& node = tree.nodes[index];
        work.count(node);
        Vec3<Real> near;
        Vec3<Real> far;
        for (int i = 0; i < 3; ++i) bounds.template children<Real>(index, i, ray.sign[i], ray.time, near[i], far[i]);
        const Interval<Real> inside = box_interval<Real>(near, far, ray.origin, ray.inverse, Real(light.t));
        for (unsigned bits = mask_bits(inside.enter <= inside.exit); bits != 0; bits &= bits - 1)
            *top++ = node.child[std::countr_zero(bits)];
    }
    return false;
}

}  // namespace detail

/// Whether anything lies before a light that the ray is to reach: a shape that closest_hit() would prefer to a hit on
/// the light at `light.t`. The order in which shapes are tested does not show.
template <Features features, class Scalar, class Work>
[[gnu::noinline]] bool is_occluded(const ShapeView<Scalar>& scene, const Ray<Scalar>& ray, std::int32_t leaving_id,
                                   const Hit<Scalar>& light, Work& work) {
    using Real = Wide<Scalar, kTreeWidth<Scalar>>;
    const SpreadRay<Real> spread(ray, ray_inverse<Scalar>(ray.direction), leaving_id);
    Hit<Scalar> hit = light;
    detail::test_untreed<features, Real>(scene, spread, hit, work);
    if (hit.primitive_id != light.primitive_id) return true;
    if constexpr (features.planar) {
        if (detail::is_met<features, Real>(scene.quad_tree, spread, light, work)) return true;
    }
    return detail::is_met<features, Real>(scene.sphere_tree, spread, light, work);
}

}  // namespace raypool
