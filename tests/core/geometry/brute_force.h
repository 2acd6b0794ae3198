/// The closest hit by asking every shape, one by one: what any walk through any tree must return, to the last bit.
///
/// The rules are those of core/geometry/shapes.h: a shape that has a box counts only where the ray is inside its own
/// padded box; of equal distances the smaller id counts.
#pragma once

#include <cstdint>
#include <span>

#include "core/geometry/traverse.h"

namespace raypool::test {

template <class Scalar>
Vec3<Scalar> lane_of(const auto& components, int lane) {
    return vec3<Scalar>(components[0][lane], components[1][lane], components[2][lane]);
}

template <class Scalar>
void keep_closer(Scalar t, std::int32_t id, Hit<Scalar>& hit) {
    if (t < hit.t || (t == hit.t && t < kInfinity<Scalar> && id < hit.primitive_id)) {
        hit.t = t;
        hit.primitive_id = id;
    }
}

/// Distance to the shape in a lane of a block; infinity where its box rules a hit out.
template <InBox in_box, class Scalar, class Block>
requires requires(Block b) {
    b.radius;
}
Scalar shape_distance(const Block& block, int lane, const Ray<Scalar>& ray, std::int32_t leaving_id) {
    const Vec3<Scalar> center =
        center_at<Scalar>(lane_of<Scalar>(block.center, lane), lane_of<Scalar>(block.motion, lane), ray.time);
    const Scalar t =
        sphere_distance<Scalar>(ray.origin, ray.direction, center, block.radius[lane], block.id[lane] == leaving_id);
    if (in_box == InBox::No || t == kInfinity<Scalar>) return t;
    const Scalar r = block.padded_radius[lane];
    const Vec3<Scalar> low = vec3<Scalar>(center[0] - r, center[1] - r, center[2] - r);
    const Vec3<Scalar> high = vec3<Scalar>(center[0] + r, center[1] + r, center[2] + r);
    const RayInverse<Scalar> inverse = ray_inverse<Scalar>(ray.direction);
    return is_inside_box<Scalar>(low, high, ray.origin, inverse, t) ? t : kInfinity<Scalar>;
}

template <InBox in_box, class Scalar, class Block>
requires requires(Block b) {
    b.dual_u;
}
Scalar shape_distance(const Block& block, int lane, const Ray<Scalar>& ray, std::int32_t leaving_id) {
    const Vec3<Scalar> point = lane_of<Scalar>(block.point, lane);
    const Vec3<Scalar> normal = lane_of<Scalar>(block.normal, lane);
    const bool is_leaving = block.group[lane] == leaving_id;
    if (in_box == InBox::No) return plane_distance<Scalar>(ray.origin, ray.direction, point, normal, is_leaving);
    const Scalar t =
        quad_distance<Scalar>(ray.origin, ray.direction, point, normal, lane_of<Scalar>(block.corner, lane),
                              lane_of<Scalar>(block.dual_u, lane), lane_of<Scalar>(block.dual_v, lane), is_leaving);
    if (t == kInfinity<Scalar>) return t;
    const RayInverse<Scalar> inverse = ray_inverse<Scalar>(ray.direction);
    const bool is_inside = is_inside_box<Scalar>(lane_of<Scalar>(block.low, lane), lane_of<Scalar>(block.high, lane),
                                                 ray.origin, inverse, t);
    return is_inside ? t : kInfinity<Scalar>;
}

template <InBox, class Scalar, IsTriangles Block>
Scalar shape_distance(const Block& block, int lane, const Ray<Scalar>& ray, std::int32_t leaving_id) {
    std::array<Vec3<Scalar>, 3> vertices;
    for (int i = 0; i < 3; ++i) vertices[static_cast<std::size_t>(i)] = lane_of<Scalar>(block.vertex[i], lane);
    const Scalar t =
        triangle_distance<Scalar>(ray.origin, ray_shear<Scalar>(ray.direction), vertices, block.id[lane] == leaving_id);
    Vec3<Scalar> low;
    Vec3<Scalar> high;
    triangle_box<Scalar>(vertices, low, high);
    const RayInverse<Scalar> inverse = ray_inverse<Scalar>(ray.direction);
    return is_inside_box<Scalar>(low, high, ray.origin, inverse, t) ? t : kInfinity<Scalar>;
}

template <InBox in_box, class Scalar, class Block>
void ask_all(std::span<const Block> blocks, const Ray<Scalar>& ray, std::int32_t leaving_id, auto tell) {
    for (const Block& block : blocks)
        for (int lane = 0; lane < Block::kLanes; ++lane)
            if (block.id[lane] != kNoPrimitive)
                tell(shape_distance<in_box, Scalar>(block, lane, ray, leaving_id), block.id[lane]);
}

/// Calls tell(distance, id) for the triangles of an instance, from `child` of its object's tree on.
template <class Scalar>
void ask_instance(const InstanceTreeView<Scalar>& tree, const InstanceRow<Scalar>& instance, std::int32_t child,
                  const Ray<Scalar>& ray, std::int32_t leaving_id, auto tell) {
    using Row = InstanceRow<Scalar>;
    if (child >= 0) {
        for (const std::int32_t below : tree.objects.nodes[static_cast<std::size_t>(child)].child)
            if (below != 0) ask_instance(tree, instance, below, ray, leaving_id, tell);
        return;
    }
    auto block = tree.objects.blocks[static_cast<std::size_t>(~child)];
    const auto placing = Placing<Scalar>::of(instance.value + Row::kTransform);
    const auto in_object = ObjectRay<Scalar>::of(instance, ray.origin, ray.direction);
    for (int lane = 0; lane < block.kLanes; ++lane) {
        if (block.id[lane] == kNoPrimitive) continue;
        block.id[lane] += instance.number(Row::kFirstId);
        std::array<Vec3<Scalar>, 3> stored;
        for (int i = 0; i < 3; ++i) {
            stored[static_cast<std::size_t>(i)] = lane_of<Scalar>(block.vertex[i], lane);
            const Vec3<Scalar> placed = placing.point(stored[static_cast<std::size_t>(i)]);
            for (int axis = 0; axis < 3; ++axis) block.vertex[i][axis][lane] = placed[axis];
        }
        const Scalar t = shape_distance<InBox::Yes, Scalar>(block, lane, ray, leaving_id);
        Vec3<Scalar> low;
        Vec3<Scalar> high;
        triangle_box<Scalar>(stored, low, high);
        const bool is_inside =
            is_inside_box<Scalar>(low, high, in_object.near_origin, in_object.far_origin, in_object.inverse, t);
        tell(is_inside ? t : kInfinity<Scalar>, block.id[lane]);
    }
}

/// Calls tell(distance, id) for every shape; the distance is infinity where the ray does not meet it.
template <class Scalar>
void for_each_distance(const ShapeView<Scalar>& scene, const Ray<Scalar>& ray, std::int32_t leaving_id, auto tell) {
    ask_all<InBox::No>(scene.large_spheres, ray, leaving_id, tell);
    ask_all<InBox::No>(scene.planes, ray, leaving_id, tell);
    ask_all<InBox::Yes>(scene.sphere_tree.blocks, ray, leaving_id, tell);
    ask_all<InBox::Yes>(scene.quad_tree.blocks, ray, leaving_id, tell);
    ask_all<InBox::Yes>(scene.triangle_tree.blocks, ray, leaving_id, tell);
    for (const InstanceRow<Scalar>& instance : scene.instance_tree.blocks)
        ask_instance(scene.instance_tree, instance, instance.number(InstanceRow<Scalar>::kRoot), ray, leaving_id, tell);
}

template <class Scalar>
Hit<Scalar> brute_force_hit(const ShapeView<Scalar>& scene, const Ray<Scalar>& ray, std::int32_t leaving_id) {
    Hit<Scalar> hit;
    for_each_distance(scene, ray, leaving_id, [&](Scalar t, std::int32_t id) { keep_closer<Scalar>(t, id, hit); });
    return hit;
}

}  // namespace raypool::test
