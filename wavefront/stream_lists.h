/// What a thread keeps for its streams: rays, their hits, and the lists of rays on the way down a tree.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "wavefront/ray_row.h"
#include "wavefront/sphere_pairs.h"

namespace raypool::wavefront {

/// What lists must be for the trees of a scene.
struct StreamTrees {
    int depth = 0;
    bool has_instances = false;

    template <class Scalar>
    explicit StreamTrees(const ShapeView<Scalar>& scene)
        : depth(std::max({scene.sphere_tree.depth, scene.quad_tree.depth, scene.triangle_tree.depth})),
          has_instances(!scene.instance_tree.nodes.empty()) {
        // Within an instance a list begins anew.
        if (has_instances) depth = std::max(depth, scene.instance_tree.depth + 1 + scene.instance_tree.objects.depth);
    }
};

/// The lists of rays on the way down a tree: scratch, which streams of one thread share.
template <class Scalar>
class StreamLists {
  public:
    /// For streams of up to `capacity` rays.
    StreamLists(std::size_t capacity, const StreamTrees& trees)
        : lists_(std::make_unique_for_overwrite<std::uint32_t[]>(size(capacity, trees))),
          object_rows_(object_rows(capacity, trees)) {}
    static std::size_t bytes(std::size_t capacity, const StreamTrees& trees) {
        return size(capacity, trees) * sizeof(std::uint32_t) + object_rows(capacity, trees) * sizeof(ObjectRow<Scalar>);
    }
    [[nodiscard]] std::uint32_t* data() const { return lists_.get(); }
    /// One for each ray; where a scene has no instances there are none.
    [[nodiscard]] ObjectRow<Scalar>* object_rows() const { return object_rows_.data(); }

  private:
    /// The list at the root, one for each child of a node on the way down, and a leaf's pairs.
    static std::size_t size(std::size_t capacity, const StreamTrees& trees) {
        return (capacity + kMostLanes) * (1 + kTreeWidth<Scalar> * (1 + static_cast<std::size_t>(trees.depth)));
    }
    static std::size_t object_rows(std::size_t capacity, const StreamTrees& trees) {
        return trees.has_instances ? capacity + kMostLanes : 0;
    }
    static constexpr std::size_t kMostLanes = 16;

    std::unique_ptr<std::uint32_t[]> lists_;
    mutable std::vector<ObjectRow<Scalar>> object_rows_;
};

/// Up to `capacity` rays of one thread, and the hits they found.
template <class Scalar>
class RayStream {
  public:
    /// More rays than this have no numbers for their pairs with shapes (SpherePairs).
    static constexpr std::size_t kMostRays = SpherePairs<Scalar>::kMostRays;

    explicit RayStream(std::size_t capacity)
        : rows_(capacity + kMostLanes), distance_(capacity + kMostLanes), primitive_id_(capacity + kMostLanes) {}

    static std::size_t bytes(std::size_t capacity) {
        return (capacity + kMostLanes) * (sizeof(RayRow<Scalar>) + sizeof(Scalar) + sizeof(std::int32_t));
    }

    RayRow<Scalar>* rows() { return rows_.data(); }
    Scalar* distance() { return distance_.data(); }
    std::int32_t* primitive_id() { return primitive_id_.data(); }
    StreamHits<Scalar> hits() { return {rows(), distance(), primitive_id()}; }

  private:
    static constexpr std::size_t kMostLanes = 16;

    std::vector<RayRow<Scalar>> rows_;
    std::vector<Scalar> distance_;
    std::vector<std::int32_t> primitive_id_;
};

}  // namespace raypool::wavefront
