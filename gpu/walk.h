/// One ray down the trees of a scene, a box and a shape at a time, by a thread with a small stack of its own.
///
/// The tests are those of core/geometry/wide_rays.h for a single ray, so a hit is the one that every engine finds, to
/// the bit. A stack entry is a node and which of its children are left, nearest first (after Ylitie, Karras and Laine,
/// "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017): a level of the tree takes
/// eight bytes, however wide its nodes are.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/geometry/occlusion.h"
#include "core/geometry/wide_rays.h"

namespace raypool::gpu {

/// What a walk for the closest hit looks for.
struct ClosestSearch {
    Hit<float>& hit;

    [[nodiscard]] RAYPOOL_INLINE float limit() const { return hit.t; }
    [[nodiscard]] RAYPOOL_INLINE bool is_over() const { return false; }
    template <Features features, InBox in_box, class Block, class Rays>
    RAYPOOL_INLINE void meet(const Block& block, int lane, const Rays& rays) {
        intersect_lane<features, in_box, float>(block, lane, rays, hit);
    }
    RAYPOOL_INLINE void count_from(std::int32_t first) { count_ids_from(hit, first); }
};

/// What one toward a light does: anything before it ends the walk.
struct OcclusionSearch {
    Occlusion<float>& light;

    [[nodiscard]] RAYPOOL_INLINE float limit() const { return light.t; }
    [[nodiscard]] RAYPOOL_INLINE bool is_over() const { return light.is_hidden; }
    template <Features features, InBox in_box, class Block, class Rays>
    RAYPOOL_INLINE void meet(const Block& block, int lane, const Rays& rays) {
        Hit<float> hit{light.t, std::numeric_limits<std::int32_t>::max()};  // a tie is settled by keep_closer()
        if (intersect_lane<features, in_box, float>(block, lane, rays, hit))
            light.keep_closer(hit.t, static_cast<std::int32_t>(hit.primitive_id));
    }
    RAYPOOL_INLINE void count_from(std::int32_t first) { count_ids_from(light, first); }
};

/// Children of a node, a hexadecimal digit each, the next one lowest: its lane and one more. Zero where none is left.
using ChildOrder = std::uint32_t;

/// The children of a node that a ray enters before `limit`, nearest first.
template <Features features, class Tree, class Rays>
RAYPOOL_INLINE ChildOrder entered_children(const Tree& tree, std::size_t node, const Rays& rays, float time,
                                           float limit) {
    constexpr int kWidth = kTreeWidth<float>;
    static_assert(kWidth <= 8);
    const detail::TreeBounds<features, Tree> bounds(tree);
    float enter[kWidth];
    RAYPOOL_UNROLL
    for (int i = 0; i < kWidth; ++i) {
        const Interval<float> inside = child_interval<float>(bounds, node, i, rays, time, limit);
        enter[i] = inside.enter <= inside.exit ? inside.enter : kInfinity<float>;
    }
    ChildOrder order = 0;
    RAYPOOL_UNROLL
    for (int i = 0; i < kWidth; ++i) {
        int before = 0;  // entered earlier than child i
        RAYPOOL_UNROLL
        for (int k = 0; k < kWidth; ++k) before += enter[k] < enter[i] || (enter[k] == enter[i] && k < i) ? 1 : 0;
        if (enter[i] < kInfinity<float>) order |= static_cast<ChildOrder>(i + 1) << (4 * before);
    }
    return order;
}

template <Features features, class Tree, class Rays, class Search>
RAYPOOL_HOST_DEVICE void walk(const Tree& tree, std::int32_t root, const Rays& boxes, const WideRays<float>& rays,
                              const InstanceRow<float>* instance, Search& search);

/// The shapes of a leaf.
template <Features features, class Tree, class Search>
RAYPOOL_INLINE void meet_leaf(const Tree& tree, std::int32_t child, const WideRays<float>& rays,
                              const InstanceRow<float>* instance, Search& search) {
    using Block = typename Tree::Block;
    const Block& block = tree.blocks[static_cast<std::size_t>(~child)];
    if constexpr (IsInstance<Block>) {
        const auto object = ObjectRay<float>::of(block, rays.ray.origin, rays.ray.direction);
        const std::int32_t first = block.number(Block::kFirstId);
        search.count_from(first);
        walk<features>(tree.objects, block.number(Block::kRoot), object, rays, &block, search);
        search.count_from(-first);
    } else if constexpr (IsTriangles<Block>) {
        const Sheared<WideRays<float>, float> sheared = ready_for<Block, float>(rays);
        if (instance == nullptr) {
            for_each_shape(block, [&](int i) { search.template meet<features, InBox::Yes>(block, i, sheared); });
        } else {
            const PlacedRays<float> placed = placed_rays<float>(*instance, sheared);
            for_each_shape(block, [&](int i) { search.template meet<features, InBox::Yes>(block, i, placed); });
        }
    } else {
        for_each_shape(block, [&](int i) { search.template meet<features, InBox::Yes>(block, i, rays); });
    }
}

/// From `root` on: `boxes` is the ray as the boxes see it, and `rays` as it is. `instance` is not null within one.
template <Features features, class Tree, class Rays, class Search>
RAYPOOL_HOST_DEVICE void walk(const Tree& tree, std::int32_t root, const Rays& boxes, const WideRays<float>& rays,
                              const InstanceRow<float>* instance, Search& search) {
    if (root < 0) return meet_leaf<features>(tree, root, rays, instance, search);
    struct Entry {
        std::int32_t node;
        ChildOrder order;
    };
    Entry stack[kMostTreeLevels];
    int level = 0;
    const float time = rays.ray.time;
    std::int32_t node = root;
    ChildOrder order = entered_children<features>(tree, static_cast<std::size_t>(node), boxes, time, search.limit());
    for (;;) {
        while (order == 0) {
            if (level == 0) return;
            --level;
            node = stack[level].node;
            order = stack[level].order;
        }
        const std::int32_t child = tree.nodes[static_cast<std::size_t>(node)].child[(order & 15U) - 1];
        order >>= 4U;
        if (child < 0) {
            meet_leaf<features>(tree, child, rays, instance, search);
            if (search.is_over()) return;
            continue;
        }
        if (order != 0) stack[level++] = {node, order};
        node = child;
        order = entered_children<features>(tree, static_cast<std::size_t>(node), boxes, time, search.limit());
    }
}

/// All shapes of a scene.
template <Features features, class Search>
RAYPOOL_INLINE void search_scene(const ShapeView<float>& scene, const WideRays<float>& rays, Search search) {
    const auto untreed = [&](const auto& blocks) {
        for (const auto& block : blocks)
            for_each_shape(block, [&](int i) { search.template meet<features, InBox::No>(block, i, rays); });
    };
    const auto treed = [&](const auto& tree) {
        if (!tree.nodes.empty() && !search.is_over()) walk<features>(tree, 0, rays, rays, nullptr, search);
    };
    untreed(scene.large_spheres);
    if constexpr (features.planar) {
        untreed(scene.planes);
        treed(scene.quad_tree);
    }
    if constexpr (features.triangles) {
        treed(scene.triangle_tree);
        treed(scene.instance_tree);
    }
    treed(scene.sphere_tree);
}

/// `leaving_id` is what the ray starts on (RayStart::leaving_id), or kNoPrimitive.
template <Features features>
[[gnu::noinline]] RAYPOOL_HOST_DEVICE Hit<float> closest_hit(const ShapeView<float>& scene, const Ray<float>& ray,
                                                             std::int32_t leaving_id) {
    Hit<float> hit;
    search_scene<features>(scene, {ray, ray_inverse<float>(ray.direction), leaving_id}, ClosestSearch{hit});
    return hit;
}

/// Whether anything lies before a light that the ray is to reach.
template <Features features>
[[gnu::noinline]] RAYPOOL_HOST_DEVICE bool is_occluded(const ShapeView<float>& scene, const Ray<float>& ray,
                                                       std::int32_t leaving_id, Occlusion<float> light) {
    search_scene<features>(scene, {ray, ray_inverse<float>(ray.direction), leaving_id}, OcclusionSearch{light});
    return light.is_hidden;
}

}  // namespace raypool::gpu
