/// A packet: one register of coherent rays (camera rays through neighbouring film points) walked down a tree together.
#pragma once

#include "core/geometry/traverse.h"
#include "wavefront/wide_ids.h"

namespace raypool::wavefront {

namespace detail {

template <Features features, class Real, class Tree, class Work>
[[gnu::noinline]] void meet_instance(const Tree& objects, const InstanceRow<ScalarOf<Real>>& instance,
                                     const Sheared<WideRays<Real>, Real>& rays, const Mask<Real>& is_active,
                                     Hit<Real>& hit, Work& work);

/// From `child` of the tree on: `boxes` are the rays as the boxes see them, and `ready` as what is in leaves does.
template <Features features, class Real, class Tree, class Boxes, class Ready, class Work>
RAYPOOL_INLINE void walk_packet(const Tree& tree, const Boxes& boxes, const Ready& ready, const Mask<Real>& is_active,
                                Hit<Real>& hit, Work& work, std::int32_t child) {
    const raypool::detail::TreeBounds<features, Tree> bounds(tree);
    using S = ScalarOf<Real>;
    constexpr int kWidth = kTreeWidth<S>;
    struct Entry {
        S enter;  ///< of the first ray that meets it: only an order to visit in
        std::int32_t child;
    };
    Entry stack[kTraversalStack<kWidth>];
    Entry* top = stack;
    for (;;) {
        if (child >= 0) {
            const auto index = static_cast<std::size_t>(child);
            const auto& node = tree.nodes[index];
            Entry* const bottom = top;
            for (int i = 0; i < kWidth && node.child[i] != 0; ++i) {  // the root is no child
                const Interval<Real> inside = child_interval<Real>(bounds, index, i, boxes, ready.ray.time, hit.t);
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
            if constexpr (IsInstance<typename Tree::Block>) {
                meet_instance<features, Real>(tree.objects, block, ready, is_active, hit, work);
            } else {
                for_each_shape(block, [&](int i) {
                    work.count_primitives(std::popcount(mask_bits(is_active)));
                    intersect_lane<features, InBox::Yes, Real>(block, i, ready, hit);
                });
            }
        }
        if (top == stack) return;
        child = (--top)->child;
    }
}

/// The same of rays as they are.
template <Features features, class Real, class Tree, class Work>
RAYPOOL_INLINE void walk_packet(const Tree& tree, const WideRays<Real>& rays, const Mask<Real>& is_active,
                                Hit<Real>& hit, Work& work) {
    if (tree.nodes.empty()) return;
    const auto& ready = ready_for<typename Tree::Block, Real>(rays);
    walk_packet<features, Real>(tree, rays, ready, is_active, hit, work, 0);
}

/// The triangles of an instance, by the tree of its object.
template <Features features, class Real, class Tree, class Work>
[[gnu::noinline]] void meet_instance(const Tree& objects, const InstanceRow<ScalarOf<Real>>& instance,
                                     const Sheared<WideRays<Real>, Real>& rays, const Mask<Real>& is_active,
                                     Hit<Real>& hit, Work& work) {
    using Row = InstanceRow<ScalarOf<Real>>;
    const PlacedRays<Real> placed = placed_rays<Real>(instance, rays);
    const std::int32_t first = instance.number(Row::kFirstId);
    count_ids_from(hit, first);
    walk_packet<features, Real>(objects, placed.in_object, placed, is_active, hit, work, instance.number(Row::kRoot));
    count_ids_from(hit, -first);
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
    if constexpr (features.triangles) {
        detail::walk_packet<features, Real>(scene.triangle_tree, rays, is_active, hit, work);
        detail::walk_packet<features, Real>(scene.instance_tree, rays, is_active, hit, work);
    }
    detail::walk_packet<features, Real>(scene.sphere_tree, rays, is_active, hit, work);
    return hit;
}

}  // namespace raypool::wavefront
