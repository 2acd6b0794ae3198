/// Whether anything lies between a point and a light: any hit is enough, so the order in which a tree is walked does
/// not show. The tests of boxes and shapes are those of traverse.h.
#pragma once

#include "core/geometry/traverse.h"

namespace raypool {

/// Whether a light is hidden: by another shape that closest_hit() would prefer to a hit on it at distance t.
template <class Scalar>
struct Occlusion {
    Scalar t;               ///< of the light; infinity of what is behind all shapes
    std::int32_t light_id;  ///< kNoPrimitive of what is no shape
    bool is_hidden = false;

    [[nodiscard]] RAYPOOL_INLINE bool hides(Scalar distance, std::int32_t id) const {
        return id != light_id && (distance < t || (distance == t && id < light_id));
    }
    RAYPOOL_INLINE void keep_closer(Scalar distance, std::int32_t id) { is_hidden = is_hidden || hides(distance, id); }
};

namespace detail {

/// From `child` of the tree on, until something hides the light.
template <Features features, class Real, class Block, class Work>
RAYPOOL_INLINE void walk(const TreeView<Block, ScalarOf<Real>, kLanes<Real>>& tree, const SpreadRay<Real>& ray,
                         Occlusion<ScalarOf<Real>>& light, Work& work, std::int32_t child = 0) {
    if (tree.nodes.empty()) return;
    const auto& ready = ready_for<Block, Real>(ray);
    const TreeBounds<features, TreeView<Block, ScalarOf<Real>, kLanes<Real>>> bounds(tree);
    std::int32_t stack[kTraversalStack<kLanes<Real>>];
    std::int32_t* top = stack;
    *top++ = child;
    while (top != stack && !light.is_hidden) {
        child = *--top;
        if (child < 0) {
            const Block& block = tree.blocks[~child];
            work.count(block);
            intersect_block<features, InBox::Yes, Real>(block, ready, light);
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
        if (!light.is_hidden && !scene.triangle_tree.nodes.empty())
            light = detail::walk_apart<Real>(ray, leaving_id, light, [&](const SpreadRay<Real>& apart, auto& found) {
                detail::walk<features, Real>(scene.triangle_tree, apart, found, work);
            });
    }
    if (!light.is_hidden) detail::walk<features, Real>(scene.sphere_tree, spread, light, work);
    return light.is_hidden;
}

}  // namespace raypool
