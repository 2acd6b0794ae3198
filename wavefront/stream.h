/// Stream traversal: a whole list of rays goes down the tree together, and is filtered at every node.
///
/// After Barringer and Akenine-Moeller, "Dynamic Ray Stream Traversal", SIGGRAPH 2014. A visit to a node takes the list
/// of rays that entered it, a register's worth at a time, tests each child's box against them, and appends those that
/// enter to the child's list. Incoherent rays so fill whole registers as long as lists are long, which is what a pool
/// is for; where a list has become short, its rays go on one by one, each against a register of boxes. Rays are read as
/// rows, so that any sixteen of them can be fetched by transposing. A list holds where rows begin, counted in scalars.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "wavefront/settings.h"
#include "wavefront/sphere_pairs.h"

namespace raypool::wavefront {

/// The lists of rays on the way down a tree: scratch, which streams of one thread share.
template <class Scalar>
class StreamLists {
  public:
    /// For streams of up to `capacity` rays.
    StreamLists(std::size_t capacity, int tree_depth)
        : lists_(std::make_unique_for_overwrite<std::uint32_t[]>(size(capacity, tree_depth))) {}
    static std::size_t bytes(std::size_t capacity, int tree_depth) {
        return size(capacity, tree_depth) * sizeof(std::uint32_t);
    }
    [[nodiscard]] std::uint32_t* data() const { return lists_.get(); }

  private:
    /// The list at the root, one for each child of a node on the way down, and a leaf's pairs.
    static std::size_t size(std::size_t capacity, int tree_depth) {
        return (capacity + kMostLanes) * (1 + kTreeWidth<Scalar> * (1 + static_cast<std::size_t>(tree_depth)));
    }
    static constexpr std::size_t kMostLanes = 16;

    std::unique_ptr<std::uint32_t[]> lists_;
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

namespace detail {

/// Lists shorter than this are walked ray by ray. From a prototype on triangles, in which the length hardly mattered.
inline constexpr std::size_t kShortList = 12;

/// `Hits` is StreamHits, for closest hits, or ShadowHits.
template <Features features, class Real, class Tree, class Hits, class Work>
class StreamWalk {
    using S = ScalarOf<Real>;
    using Row = RayRow<S>;
    static constexpr int kRays = kLanes<Real>;
    static constexpr int kWidth = kTreeWidth<S>;
    static constexpr bool kIsShadow = std::same_as<Hits, ShadowHits<S>>;
    static constexpr bool kCountsLists = requires(Work work) { work.count_list(1, 1, true); };
    static constexpr std::int32_t kLargestId = std::numeric_limits<std::int32_t>::max();

  public:
    StreamWalk(const Tree& tree, const Hits& hits, Intersection intersection, Work& work)
        : tree_(tree), hits_(hits), intersection_(intersection), work_(work) {}

    /// Takes list[0 .. count), which has room for a register beyond its end; `free` is scratch behind it.
    void visit(std::int32_t child, std::uint32_t* list, std::size_t count, std::uint32_t* free) {
        const bool is_single = count < kShortList;
        if constexpr (kCountsLists) work_.count_list(count, kRays, is_single);
        if (is_single) {
            for (std::size_t i = 0; i < count; ++i) walk_single(child, list[i]);
            return;
        }
        // The tail of the last register repeats the last ray, so that there are rows to load.
        for (std::size_t i = count; i < count + kRays; ++i) list[i] = list[count - 1];
        if (child < 0) {
            visit_leaf(tree_.blocks[static_cast<std::size_t>(~child)], list, count, free);
        } else {
            visit_node(static_cast<std::size_t>(child), list, count, free);
        }
    }

  private:
    void visit_node(std::size_t index, const std::uint32_t* list, std::size_t count, std::uint32_t* free) {
        const raypool::detail::TreeBounds<features, Tree> bounds(tree_);
        const auto& node = tree_.nodes[index];
        const std::size_t room = count + kRays;  // a register is stored whole behind the last ray
        int children = 0;                        // the lanes in use come first; the root is no child
        std::uint32_t* end[kWidth];
        for (; children < kWidth && node.child[children] != 0; ++children)
            end[children] = free + static_cast<std::size_t>(children) * room;
        for (std::size_t first = 0; first < count; first += kRays) {
            Real row[8];
            load_rows_at<8, Real>(hits_.rows->value, list + first, row);
            WideRays<Real> rays;
            rays.ray.origin = columns(row, Row::kOrigin);
            rays.ray.time = row[Row::kTime];
            rays.inverse = inverse_of_scale<Real>(columns(row, Row::kScale));
            Real limit = row[Row::kDistance];
            unsigned valid = (1U << kRays) - 1;
            if (first + kRays > count) [[unlikely]] {
                valid = (1U << (count - first)) - 1;
                limit = select(lanes_before<Real>(count - first), limit, Real(-1));  // enters no box
            }
            const Uint32<Real> offset(list + first, stdx::element_aligned);
            for (int i = 0; i < children; ++i) {
                const Interval<Real> inside = child_interval<Real>(bounds, index, i, rays, limit);
                const unsigned bits = mask_bits(inside.enter <= inside.exit);
                work_.count_boxes(node, i, valid);
                compress_store(end[i], offset, bits);
                end[i] += std::popcount(bits);
            }
        }

        // Nearest child first, as the first ray of the list sees it.
        const S* ray = hits_.rows[list[0] / Row::kColumns].value;
        int order[kWidth];
        S place[kWidth];
        for (int i = 0; i < children; ++i) {
            place[i] = 0;
            for (int axis = 0; axis < 3; ++axis)
                place[i] += (node.bounds[axis][0][i] + node.bounds[axis][1][i]) * ray[Row::kDirection + axis];
            int k = i;
            for (; k > 0 && place[order[k - 1]] > place[i]; --k) order[k] = order[k - 1];
            order[k] = i;
        }
        if constexpr (kCountsLists) ++work_.level;
        std::uint32_t* const next_free = free + static_cast<std::size_t>(children) * room;
        for (int k = 0; k < children; ++k) {
            const int i = order[k];
            std::uint32_t* const begin = free + static_cast<std::size_t>(i) * room;
            if (end[i] != begin) visit(node.child[i], begin, static_cast<std::size_t>(end[i] - begin), next_free);
        }
        if constexpr (kCountsLists) --work_.level;
    }

    template <class Block>
    void visit_leaf(const Block& block, const std::uint32_t* list, std::size_t count, std::uint32_t* free) {
        if constexpr (requires { block.radius; }) {
            if (intersection_ == Intersection::Pairs) {
                SpherePairs<S> pairs(block, free);
                pairs.template find_in_list<features, Real>(hits_.rows, list, count, work_);
                pairs.template meet<features, InBox::Yes, Real>(hits_);
                return;
            }
        }
        for (std::size_t first = 0; first < count; first += kRays) {
            Real row[Row::kColumns];
            load_rows_at<Row::kColumns, Real>(hits_.rows->value, list + first, row);
            const WideRays<Real> loaded = rays_of_rows<Real>(row);
            const auto& rays = ready_for<Block, Real>(loaded);
            Hit<Real> hit;
            hit.t = row[Row::kDistance];
            hit.primitive_id = Int<Real>(kLargestId);  // a tie with the hit so far is settled below, where it is rare
            const auto tell = [&](unsigned bits, const Hit<Real>& found) {
                for (; bits != 0; bits &= bits - 1) {
                    const int i = std::countr_zero(bits);
                    const std::uint32_t ray = list[first + static_cast<std::size_t>(i)] / Row::kColumns;
                    hits_.keep_closer(ray, lane(found.t, i), static_cast<std::int32_t>(lane(found.primitive_id, i)));
                }
            };
            Mask<Real> is_improved(false);
            for_each_shape(block, [&](int i) {
                work_.count_primitives(static_cast<int>(std::min<std::size_t>(kRays, count - first)));
                if constexpr (kIsShadow) {  // each by itself: what is closest may be the light, before its own distance
                    Hit<Real> any = hit;
                    tell(mask_bits(intersect_lane<features, InBox::Yes, Real>(block, i, rays, any)), any);
                } else {
                    is_improved = is_improved || intersect_lane<features, InBox::Yes, Real>(block, i, rays, hit);
                }
            });
            if constexpr (!kIsShadow) tell(mask_bits(is_improved), hit);
        }
    }

    /// One ray from `child` down, against a register of boxes or shapes at a time.
    [[gnu::noinline]] void walk_single(std::int32_t child, std::uint32_t offset) {
        using Boxes = Wide<S, kWidth>;
        const std::uint32_t i = offset / Row::kColumns;
        const S* row = hits_.rows[i].value;
        const Ray<S> ray{columns(row, Row::kOrigin), columns(row, Row::kDirection), row[Row::kTime]};
        const SpreadRay<Boxes> spread(ray, inverse_of_scale<S>(columns(row, Row::kScale)),
                                      static_cast<std::int32_t>(bits_of<S>(row[Row::kLeaving])));
        if constexpr (kIsShadow) {
            Occlusion<S> light{hits_.distance[i], hits_.primitive_id[i]};
            raypool::detail::walk<features, Boxes>(tree_, spread, light, work_, child);
            if (light.is_hidden) hits_.hide(i);
        } else {
            Hit<S> hit{hits_.distance[i], hits_.primitive_id[i]};
            raypool::detail::walk<features, Boxes>(tree_, spread, hit, work_, child);
            hits_.set(i, hit.t, static_cast<std::int32_t>(hit.primitive_id));
        }
    }

    const Tree& tree_;
    const Hits hits_;
    Intersection intersection_;
    Work& work_;
};

/// Takes the first `count` rays of `hits` down a tree. `lists` are for as many.
template <Features features, class Real, class Tree, class Hits, class Work>
void walk_stream(const Tree& tree, const Hits& hits, std::size_t count, const StreamLists<ScalarOf<Real>>& lists,
                 Intersection intersection, Work& work) {
    if (tree.nodes.empty() || count == 0) return;
    using Row = RayRow<ScalarOf<Real>>;
    std::uint32_t* list = lists.data();
    for (std::size_t i = 0; i < count; ++i) list[i] = static_cast<std::uint32_t>(i * Row::kColumns);
    StreamWalk<features, Real, Tree, Hits, Work>(tree, hits, intersection, work)
        .visit(0, list, count, list + count + kLanes<Real>);
}

}  // namespace detail

}  // namespace raypool::wavefront
