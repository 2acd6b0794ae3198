/// How many records a pool has room for where the settings leave it open.
///
/// Where the trees fit into the second-level cache, a pool must fit in beside them. Where they do not, rays share the
/// misses on nodes, and more rays share better: so the capacity grows with the trees (docs/pool.md has the figures).
/// Instances count as if each had a tree of its own: among many rays part, and only large pools have long lists there.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/memory.h"
#include "core/shading/compiled_scene.h"
#include "wavefront/settings.h"

namespace raypool::wavefront {

/// Of nodes, their motion and leaves; and of the objects' as many times as they are shown.
template <class Scalar>
std::size_t tree_bytes(const SceneView<Scalar>& scene) {
    const auto bytes = [](const auto& tree) {
        std::size_t all = tree.nodes.size() * sizeof(tree.nodes[0]) + tree.blocks.size() * sizeof(tree.blocks[0]);
        for (const auto& along_axis : tree.motion) all += along_axis.size() * sizeof(along_axis[0]);
        return all;
    };
    const auto shown = static_cast<std::size_t>(scene.end_instanced - scene.first_instanced);
    const std::size_t stored =
        scene.triangles.size() - static_cast<std::size_t>(scene.first_instanced - scene.first_triangle);
    const std::size_t of_objects = stored == 0 ? 0 : bytes(scene.instance_tree.objects) / stored * shown;
    return bytes(scene.sphere_tree) + bytes(scene.quad_tree) + bytes(scene.triangle_tree) + bytes(scene.instance_tree) +
           of_objects;
}

/// Of the pools of all threads together: they would take gigabytes.
inline constexpr std::int64_t kMostRecordsOfAll = std::int64_t{1} << 24;

/// Records of the pool of each of `threads` threads: a power of two in [kThreadCapacity, 64 kThreadCapacity], for trees
/// of so many bytes and a second-level cache of so many, > 0. Where there are many threads it is smaller, down to
/// kThreadCapacity, so that all together hold at most kMostRecordsOfAll.
constexpr std::int64_t thread_capacity(std::size_t tree_bytes, std::size_t cache_bytes, int threads) {
    constexpr std::size_t kMostGrowth = 64;
    const std::size_t growth = std::clamp<std::size_t>(tree_bytes / cache_bytes, 1, kMostGrowth);
    std::int64_t capacity = PoolSettings::kThreadCapacity * static_cast<std::int64_t>(std::bit_floor(growth));
    while (capacity > PoolSettings::kThreadCapacity && capacity * threads > kMostRecordsOfAll) capacity /= 2;
    return capacity;
}

/// Records of each pool in a render of the scene by `threads` threads: what the settings say, or as many as suit the
/// trees and this machine.
template <class Scalar>
std::int64_t pool_capacity(const PoolSettings& pool, const SceneView<Scalar>& scene, int threads) {
    if (pool.capacity != PoolSettings::kAutomatic) return pool.capacity;
    if (pool.scope == PoolScope::Shared) return PoolSettings::kSharedCapacity;
    return thread_capacity(tree_bytes(scene), second_level_cache(), threads);
}

}  // namespace raypool::wavefront
