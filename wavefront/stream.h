/// Stream traversal: a whole list of rays goes down the tree together, and is filtered at every node.
///
/// After Barringer and Akenine-Moeller, "Dynamic Ray Stream Traversal", SIGGRAPH 2014. A visit to a node takes the list
/// of rays that entered it, a register's worth at a time, tests each child's box against them, and appends the indices
/// of those that enter to the child's list. Incoherent rays so fill whole registers as long as lists are long, which is
/// what a pool is for. Rays are read as rows, so that any sixteen of them can be fetched by transposing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "wavefront/wide_rays.h"

namespace raypool::wavefront {

/// A ray as the traversal reads it: 12 scalars. Integers are kept as the bits of a scalar.
template <class Scalar>
struct alignas(16) RayRow {
    enum Column { kOrigin = 0, kDistance = 3, kScale = 4, kLeaving = 7, kDirection = 8, kTime = 11, kColumns = 12 };
    Scalar value[kColumns];  ///< kDistance: of the closest hit so far; kScale: 1 / direction
};

/// Scratch of one thread for streams of up to `capacity` rays, and the hits they found.
template <class Scalar>
class RayStream {
  public:
    RayStream(std::size_t capacity, int tree_depth)
        : rows_(capacity + kLanesMost),
          distance_(capacity + kLanesMost),
          primitive_id_(capacity + kLanesMost),
          lists_((capacity + kLanesMost) * (1 + kTreeWidth<Scalar> * static_cast<std::size_t>(tree_depth))) {}

    static std::size_t bytes(std::size_t capacity, int tree_depth) {
        const std::size_t lists = 1 + kTreeWidth<Scalar> * static_cast<std::size_t>(tree_depth);
        return (capacity + kLanesMost) *
               (sizeof(RayRow<Scalar>) + sizeof(Scalar) + sizeof(std::uint32_t) * (1 + lists));
    }

    RayRow<Scalar>* rows() { return rows_.data(); }
    Scalar* distance() { return distance_.data(); }
    std::int32_t* primitive_id() { return primitive_id_.data(); }
    std::uint32_t* lists() { return lists_.data(); }

  private:
    static constexpr std::size_t kLanesMost = 16;
    std::vector<RayRow<Scalar>> rows_;
    std::vector<Scalar> distance_;
    std::vector<std::int32_t> primitive_id_;
    std::vector<std::uint32_t> lists_;
};

namespace detail {

template <SceneNeeds needs, class Real, class Tree, class Work>
class StreamWalk {
    using S = ScalarOf<Real>;
    using Row = RayRow<S>;
    static constexpr int kRays = kLanes<Real>;
    static constexpr int kWidth = kTreeWidth<S>;
    static constexpr std::int32_t kLargestId = std::numeric_limits<std::int32_t>::max();

  public:
    StreamWalk(const Tree& tree, RayStream<S>& stream, Work& work)
        : tree_(tree),
          rows_(stream.rows()),
          distance_(stream.distance()),
          primitive_id_(stream.primitive_id()),
          work_(work) {}

    /// Takes list[0 .. count), which has room for a register beyond its end; `free` is scratch behind it.
    void visit(std::int32_t child, std::uint32_t* list, std::size_t count, std::uint32_t* free) {
        // The tail of the last register repeats the last ray: testing a ray twice changes nothing.
        for (std::size_t i = count; i < count + kRays; ++i) list[i] = list[count - 1];
        if (child < 0) {
            visit_leaf(tree_.blocks[static_cast<std::size_t>(~child)], list, count);
        } else {
            visit_node(tree_.nodes[static_cast<std::size_t>(child)], list, count, free);
        }
    }

  private:
    void visit_node(const WideNode<S, kWidth>& node, const std::uint32_t* list, std::size_t count,
                    std::uint32_t* free) {
        const std::size_t room = count + kRays;  // a register is stored whole behind the last index
        std::size_t filled[kWidth] = {};
        for (std::size_t first = 0; first < count; first += kRays) {
            Real row[8];
            load_row_block<8>(list + first, row);
            WideRays<Real> rays;
            for (int i = 0; i < 3; ++i) {
                rays.ray.origin[i] = row[Row::kOrigin + i];
                rays.inverse.near_scale[i] = row[Row::kScale + i] * Real(1 - kBoxSlack<S>);
                rays.inverse.far_scale[i] = row[Row::kScale + i] * Real(1 + kBoxSlack<S>);
                rays.inverse.is_negative[i] = copysign(Real(1), row[Row::kScale + i]) < Real(0);
            }
            const unsigned valid = first + kRays <= count ? (1U << kRays) - 1 : (1U << (count - first)) - 1;
            const Uint32<Real> index(list + first, stdx::element_aligned);
            for (int i = 0; i < kWidth; ++i) {
                const Interval<Real> inside = child_interval<Real>(node, i, rays, row[Row::kDistance]);
                const unsigned bits = mask_bits(inside.enter <= inside.exit) & valid;
                work_.count_boxes(node, i, valid);
                compress_store(free + static_cast<std::size_t>(i) * room + filled[i], index, bits);
                filled[i] += static_cast<std::size_t>(std::popcount(bits));
            }
        }

        // Nearest child first, as the first ray of the list sees it.
        const Row& ray = rows_[list[0]];
        int order[kWidth];
        S place[kWidth];
        for (int i = 0; i < kWidth; ++i) {
            place[i] = 0;
            for (int axis = 0; axis < 3; ++axis)
                place[i] += (node.bounds[axis][0][i] + node.bounds[axis][1][i]) * ray.value[Row::kDirection + axis];
            int k = i;
            for (; k > 0 && place[order[k - 1]] > place[i]; --k) order[k] = order[k - 1];
            order[k] = i;
        }
        for (const int i : order) {
            if (filled[i] == 0) continue;
            visit(node.child[i], free + static_cast<std::size_t>(i) * room, filled[i], free + kWidth * room);
        }
    }

    template <class Block>
    void visit_leaf(const Block& block, const std::uint32_t* list, std::size_t count) {
        for (std::size_t first = 0; first < count; first += kRays) {
            Real row[Row::kColumns];
            load_row_block<Row::kColumns>(list + first, row);
            WideRays<Real> rays;
            for (int i = 0; i < 3; ++i) {
                rays.ray.origin[i] = row[Row::kOrigin + i];
                rays.ray.direction[i] = row[Row::kDirection + i];
                rays.inverse.near_scale[i] = row[Row::kScale + i] * Real(1 - kBoxSlack<S>);
                rays.inverse.far_scale[i] = row[Row::kScale + i] * Real(1 + kBoxSlack<S>);
                rays.inverse.is_negative[i] = copysign(Real(1), row[Row::kScale + i]) < Real(0);
            }
            rays.ray.time = row[Row::kTime];
            rays.leaving_id = to_int<Real>(row[Row::kLeaving]);
            Hit<Real> hit;
            hit.t = row[Row::kDistance];
            hit.primitive_id = Int<Real>(kLargestId);  // a tie with the hit so far is settled below, where it is rare
            Mask<Real> is_improved(false);
            for_each_shape(block, [&](int i) {
                work_.count_primitives(static_cast<int>(std::min<std::size_t>(kRays, count - first)));
                is_improved = is_improved || intersect_lane<needs, InBox::Yes, Real>(block, i, rays, hit);
            });
            for (unsigned bits = mask_bits(is_improved); bits != 0; bits &= bits - 1) {
                const int i = std::countr_zero(bits);
                const std::uint32_t ray = list[first + static_cast<std::size_t>(i)];
                const auto id = static_cast<std::int32_t>(lane(hit.primitive_id, i));
                if (lane(hit.t, i) == distance_[ray] && primitive_id_[ray] < id) continue;
                rows_[ray].value[Row::kDistance] = distance_[ray] = lane(hit.t, i);
                primitive_id_[ray] = id;
            }
        }
    }

    template <int count>
    RAYPOOL_INLINE void load_row_block(const std::uint32_t* list, Real* row) const {
        const Uint32<Real> index(list, stdx::element_aligned);
        load_rows<count, Real>(rows_->value, Row::kColumns, stdx::static_simd_cast<Int<Real>>(index), row);
    }

    const Tree& tree_;
    Row* rows_;
    S* distance_;
    std::int32_t* primitive_id_;
    Work& work_;
};

template <SceneNeeds needs, class Real, class Tree, class Work>
void walk_stream(const Tree& tree, RayStream<ScalarOf<Real>>& stream, std::size_t count, Work& work) {
    if (tree.nodes.empty() || count == 0) return;
    std::uint32_t* list = stream.lists();
    for (std::size_t i = 0; i < count; ++i) list[i] = static_cast<std::uint32_t>(i);
    StreamWalk<needs, Real, Tree, Work>(tree, stream, work).visit(0, list, count, list + count + kLanes<Real>);
}

}  // namespace detail

}  // namespace raypool::wavefront
