/// A packet: one register of coherent rays (camera rays through neighbouring film points) walked down a tree together.
#pragma once

#include "wavefront/wide_rays.h"

namespace raypool::wavefront {

namespace detail {

template <Features features, class Real, class Tree, class Work>
RAYPOOL_INLINE void walk_packet(const Tree& tree, const WideRays<Real>& rays, const Mask<Real>& is_active,
                                Hit<Real>& hit, Work& work) {
    if (tree.nodes.empty()) return;
    const raypool::detail::TreeBounds<features, Tree> bounds(tree);
    const auto& ready = ready_for<typename Tree::Block, Real>(rays);
    using S = ScalarOf<Real>;
    constexpr int kWidth = kTreeWidth<S>;
    struct Entry {
        S enter;  ///< of the first ray that meets it: only an order to visit in
        std::int32_t child;
    };
    Entry stack[kTraversalStack<kWidth>];
    Entry* top = stack;
    std::int32_t child = 0;
    for (;;) {
        if (child >= 0) {
            const auto index = static_cast<std::size_t>(child);
            const auto& node = tree.nodes[index];
            Entry* const bottom = top;
            for (int i = 0; i < kWidth && node.child[i] != 0; ++i) {  // the root is no child
                const Interval<Real> inside = child_interval<Real>(bounds, index, i, rays, hit.t);
                const unsigned bits = mask_bits(is_active && inside.enter <= inside.exit);
                work.count_boxes(node, i, mask_bits(is_active));
                if (bits == 0) continue;
                const S enter = lane(inside.enter, std::countr_zero(bits));
                Entry* place = top++;
                for (; place != bottom && place[-1].enter < enter; --place) *place = place[-1];
                *place = {enter, node.child[i]};
            }
        } else {
            const auto& block = tree.blocks[static_cast<std::size_t>(~child)];
            for_each_shape(block, [&](int i) {
                work.count_primitives(std::popcount(mask_bits(is_active)));
                intersect_lane<features, InBox::Yes, Real>(block, i, ready, hit);
            });
        }
        if (top == stack) return;
        child = (--top)->child;
    }
}

}  // namespace detail

/// The closest hits of a packet. Lanes that are not active get some hit or none.
template <Features features, class Real, class Work>
RAYPOOL_INLINE Hit<Real> closest_hits(const ShapeView<ScalarOf<Real>>& scene, const WideRays<Real>& rays,
                                      const Mask<Real>& is_active, Work& work) {
    Hit<Real> hit;
    const int count = std::popcount(mask_bits(is_active));
    intersect_all<features>(scene.large_spheres, rays, count, hit, work);
    if constexpr (features.planar) {
        intersect_all<features>(scene.planes, rays, count, hit, work);
        detail::walk_packet<features, Real>(scene.quad_tree, rays, is_active, hit, work);
    }
    if constexpr (features.triangles)
        detail::walk_packet<features, Real>(scene.triangle_tree, rays, is_active, hit, work);
    detail::walk_packet<features, Real>(scene.sphere_tree, rays, is_active, hit, work);
    return hit;
}

}  // namespace raypool::wavefront
