/// The closest hit of one ray: the scene's large shapes, then the trees, a register of boxes or shapes at a time.
///
/// Called by whatever traces rays one by one. Ties go to the smaller primitive id, so to the first listed of its kind.
/// `Work` counts what was tested: TestCount does, NoTestCount costs nothing.
#pragma once

#include <cstdint>

#include "core/geometry/block_tests.h"
#include "core/geometry/occlusion.h"
#include "core/geometry/test_count.h"

namespace raypool {

/// The deepest tree's: a node takes itself from the stack and puts up to `width` children there, so each level of nodes
/// leaves width - 1 behind. A level of a wide tree stands for one or more of the binary one.
template <int width>
inline constexpr int kTraversalStack = kMostTreeLevels*(width - 1) + 1;

namespace detail {

/// The shapes that are in no tree.
template <Features features, class Real, class Found, class Work>
RAYPOOL_INLINE void test_untreed(const ShapeView<ScalarOf<Real>>& scene, const SpreadRay<Real>& ray, Found& hit,
                                 Work& work) {
    const auto test_all = [&](const auto& blocks) {
        for (const auto& block : blocks) {
            work.count(block);
            intersect_block<features, InBox::No, Real>(block, ray, hit);
        }
    };
    test_all(scene.large_spheres);
    if constexpr (features.planar) test_all(scene.planes);
}

/// The triangles of an instance, from `child` of its object's tree on.
template <Features features, class Real, class Tree, class Found, class Work>
[[gnu::noinline]] void meet_instance(const Tree& objects, const InstanceRow<ScalarOf<Real>>& instance,
                                     std::int32_t child, const Sheared<SpreadRay<Real>, Real>& ray, Found& found,
                                     Work& work);

/// What is at leaf ~child of a tree.
template <Features features, class Real, class Tree, class Ready, class Found, class Work>
RAYPOOL_INLINE void meet_leaf(const Tree& tree, std::int32_t child, const Ready& ready, Found& found, Work& work) {
    const auto& block = tree.blocks[~child];
    if constexpr (IsInstance<typename Tree::Block>) {
        meet_instance<features, Real>(tree.objects, block, block.number(Tree::Block::kRoot), ready, found, work);
    } else {
        work.count(block);
        intersect_block<features, InBox::Yes, Real>(block, ready, found);
    }
}

/// From `child` of the tree on: `boxes` is the ray as the boxes see it, and `ready` as what is in leaves does.
template <Features features, class Real, class Tree, class Boxes, class Ready, class Work>
RAYPOOL_INLINE void walk(const Tree& tree, const Boxes& boxes, const Ready& ready, Hit<ScalarOf<Real>>& hit, Work& work,
                         std::int32_t child) {
    using S = ScalarOf<Real>;
    const TreeBounds<features, Tree> bounds(tree);
    struct Entry {
        S enter;
        std::int32_t child;
    };
    Entry stack[kTraversalStack<kLanes<Real>>];
    Entry* top = stack;
    for (;;) {
        if (child >= 0) {
            const auto index = static_cast<std::size_t>(child);
            const auto& node = tree.nodes[index];
            work.count(node);
            Vec3<Real> near;
            Vec3<Real> far;
            for (int i = 0; i < 3; ++i)
                bounds.template children<Real>(index, i, boxes.sign[i], boxes.time, near[i], far[i]);
            const Interval<Real> inside = ray_interval<Real>(near, far, boxes, Real(hit.t));
            alignas(64) S enter[kLanes<Real>];
            inside.enter.copy_to(enter, stdx::vector_aligned);

            // Push the children met, nearest on top.
            Entry* const bottom = top;
            for (unsigned bits = mask_bits(inside.enter <= inside.exit); bits != 0; bits &= bits - 1) {
                const int i = std::countr_zero(bits);
                Entry* place = top++;
                for (; place != bottom && place[-1].enter < enter[i]; --place) *place = place[-1];
                *place = {enter[i], node.child[i]};
            }
        } else {
            meet_leaf<features, Real>(tree, child, ready, hit, work);
        }
        do {
            if (top == stack) return;
            --top;
        } while (top->enter > hit.t);
        child = top->child;
    }
}

/// The same until something hides a light (any_hit.h).
template <Features features, class Real, class Tree, class Boxes, class Ready, class Work>
RAYPOOL_INLINE void walk(const Tree& tree, const Boxes& boxes, const Ready& ready, Occlusion<ScalarOf<Real>>& light,
                         Work& work, std::int32_t child);

/// The same of a ray as it is.
template <Features features, class Real, class Tree, class Found, class Work>
RAYPOOL_INLINE void walk(const Tree& tree, const SpreadRay<Real>& ray, Found& found, Work& work,
                         std::int32_t child = 0) {
    if (tree.nodes.empty()) return;
    const auto& ready = ready_for<typename Tree::Block, Real>(ray);
    walk<features, Real>(tree, ray, ready, found, work, child);
}

template <Features features, class Real, class Tree, class Found, class Work>
[[gnu::noinline]] void meet_instance(const Tree& objects, const InstanceRow<ScalarOf<Real>>& instance,
                                     std::int32_t child, const Sheared<SpreadRay<Real>, Real>& ray, Found& found,
                                     Work& work) {
    using Row = InstanceRow<ScalarOf<Real>>;
    const SpreadObjectRay<Real> in_object(instance, ray);
    const std::int32_t first = instance.number(Row::kFirstId);
    Placed<Sheared<SpreadRay<Real>, Real>, Real> placed{ray, Placing<Real>::of(instance.value + Row::kTransform),
                                                        static_cast<const ObjectRay<Real>&>(in_object)};
    placed.leaving_id -= first;
    count_ids_from(found, first);
    walk<features, Real>(objects, in_object, placed, found, work, child);
    count_ids_from(found, -first);
}

/// Walks a tree by a call, with a spread ray of its own: scenes in which it is empty pay nothing for it. What
/// walk(ray, found) makes of `found` is returned.
template <class Real, class Found, class Walk>
[[gnu::noinline]] Found walk_apart(const Ray<ScalarOf<Real>>& ray, std::int32_t leaving_id, Found found, Walk walk) {
    walk(SpreadRay<Real>(ray, ray_inverse<ScalarOf<Real>>(ray.direction), leaving_id), found);
    return found;
}

}  // namespace detail

/// `leaving_id` is what the ray starts on (RayStart::leaving_id), or kNoPrimitive.
template <Features features, class Scalar, class Work>
[[gnu::noinline]] Hit<Scalar> closest_hit(const ShapeView<Scalar>& scene, const Ray<Scalar>& ray,
                                          std::int32_t leaving_id, Work& work) {
    using Real = Wide<Scalar, kTreeWidth<Scalar>>;
    const SpreadRay<Real> spread(ray, ray_inverse<Scalar>(ray.direction), leaving_id);
    Hit<Scalar> hit;
    detail::test_untreed<features, Real>(scene, spread, hit, work);
    if constexpr (features.planar) detail::walk<features, Real>(scene.quad_tree, spread, hit, work);
    if constexpr (features.triangles) {
        const auto walk_apart = [&](const auto& tree) {
            if (tree.nodes.empty()) return;
            hit = detail::walk_apart<Real>(ray, leaving_id, hit, [&](const SpreadRay<Real>& apart, auto& found) {
                detail::walk<features, Real>(tree, apart, found, work);
            });
        };
        walk_apart(scene.triangle_tree);
        walk_apart(scene.instance_tree);
    }
    detail::walk<features, Real>(scene.sphere_tree, spread, hit, work);
    return hit;
}

}  // namespace raypool
