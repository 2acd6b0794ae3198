/// Stream traversal: a whole list of rays goes down the tree together, and is filtered at every node.
///
/// After Barringer and Akenine-Moeller, "Dynamic Ray Stream Traversal", SIGGRAPH 2014. A visit to a node takes the list
/// of rays that entered it, a register's worth at a time, tests each child's box against them, and appends those that
/// enter to the child's list. Incoherent rays so fill whole registers as long as lists are long, which is what a pool
/// is for; where a list has become short, its rays go on one by one, each against a register of boxes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/geometry/any_hit.h"
#include "wavefront/settings.h"
#include "wavefront/sphere_pairs.h"
#include "wavefront/stream_lists.h"
#include "wavefront/stream_rays.h"

namespace raypool::wavefront {

namespace detail {

/// `Rays` is StandingRays, or PlacedStreamRays.
template <Features features, class Real, class Tree, class Rays, class Work>
class StreamWalk {
    using S = ScalarOf<Real>;
    using Row = RayRow<S>;
    static constexpr int kRays = kLanes<Real>;
    static constexpr int kWidth = kTreeWidth<S>;
    static constexpr bool kIsShadow = Rays::kIsShadow;
    static constexpr bool kCountsLists = requires(Work work) { work.count_list(1, 1, true); };
    static constexpr std::int32_t kLargestId = std::numeric_limits<std::int32_t>::max();

  public:
    StreamWalk(const Tree& tree, const Rays& rays, const StreamLists<S>& lists, Intersection intersection, Work& work)
        : tree_(tree), rays_(rays), lists_(lists), intersection_(intersection), work_(work) {}

    /// Takes list[0 .. count), which has room for a register beyond its end; `free` is scratch behind it.
    void visit(std::int32_t child, std::uint32_t* list, std::size_t count, std::uint32_t* free) {
        const bool is_single = count < Rays::kShortList;
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
            Real row[Rays::kBoxColumns];
            load_rows_at<Rays::kBoxColumns, Real>(rays_.box_rows(), list + first, row);
            const auto rays = Rays::template boxes_see<Real>(row);
            Real limit = row[Row::kDistance];
            unsigned valid = (1U << kRays) - 1;
            if (first + kRays > count) [[unlikely]] {
                valid = (1U << (count - first)) - 1;
                limit = select(lanes_before<Real>(count - first), limit, Real(-1));  // enters no box
            }
            const Uint32<Real> offset(list + first, stdx::element_aligned);
            for (int i = 0; i < children; ++i) {
                const Interval<Real> inside = child_interval<Real>(bounds, index, i, rays, row[Row::kTime], limit);
                const unsigned bits = mask_bits(inside.enter <= inside.exit);
                work_.count_boxes(node, i, valid);
                compress_store(end[i], offset, bits);
                end[i] += std::popcount(bits);
            }
        }

        // Nearest child first, as the first ray of the list sees it.
        const Vec3<S> direction = rays_.direction_of(list[0]);
        int order[kWidth];
        S place[kWidth];
        for (int i = 0; i < children; ++i) {
            place[i] = 0;
            for (int axis = 0; axis < 3; ++axis)
                place[i] += (node.bounds[axis][0][i] + node.bounds[axis][1][i]) * direction[axis];
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
                pairs.template find_in_list<features, Real>(rays_.hits.rows, list, count, work_);
                pairs.template meet<features, InBox::Yes, Real>(rays_.hits);
                return;
            }
        }
        for (std::size_t first = 0; first < count; first += kRays) {
            std::uint32_t scratch[kRays];
            Real row[Row::kColumns];
            load_rows_at<Row::kColumns, Real>(rays_.hits.rows->value, rays_.rows_of(list + first, scratch), row);
            const WideRays<Real> loaded = rays_of_rows<Real>(row);
            const auto& rays = rays_.template shapes_see<Block, Real>(loaded);
            Hit<Real> hit;
            hit.t = row[Row::kDistance];
            hit.primitive_id = Int<Real>(kLargestId);  // a tie with the hit so far is settled below, where it is rare
            const auto tell = [&](unsigned bits, const Hit<Real>& found) {
                for (; bits != 0; bits &= bits - 1) {
                    const int i = std::countr_zero(bits);
                    rays_.keep_closer(list[first + static_cast<std::size_t>(i)], lane(found.t, i),
                                      static_cast<std::int32_t>(lane(found.primitive_id, i)));
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

    /// The rays go on in the space of the instance's object, by rows of their own.
    void visit_leaf(const InstanceRow<S>& instance, const std::uint32_t* list, std::size_t count, std::uint32_t* free) {
        ObjectRow<S>* const rows = lists_.object_rows();
        for (std::size_t first = 0; first < count; first += kRays) {
            Real row[Row::kColumns];
            load_rows_at<Row::kColumns, Real>(rays_.hits.rows->value, list + first, row);
            const auto ray = ObjectRay<Real>::of(instance, columns(row, Row::kOrigin), columns(row, Row::kDirection));
            const Uint32<Real> itself(list + first, stdx::element_aligned);
            const auto column = object_columns<Real>(ray, row[Row::kDistance], signed_ids<Real>(itself));
            store_rows<ObjectRow<S>::kColumns, Real>(rows[first].value, column.data());
        }
        for (std::size_t i = 0; i < count; ++i) free[i] = static_cast<std::uint32_t>(i * ObjectRow<S>::kColumns);
        using Objects = typename Tree::Objects;
        using Placed = PlacedStreamRays<decltype(rays_.hits), S>;
        StreamWalk<features, Real, Objects, Placed, Work>(tree_.objects, {rays_.hits, rows, instance}, lists_,
                                                          intersection_, work_)
            .visit(instance.number(InstanceRow<S>::kRoot), free, count, free + count + kRays);
    }

    /// One ray from `child` down, against a register of boxes or shapes at a time.
    [[gnu::noinline]] void walk_single(std::int32_t child, std::uint32_t offset) {
        using Boxes = Wide<S, kWidth>;
        const std::uint32_t i = rays_.row_of(offset) / Row::kColumns;
        const auto& hits = rays_.hits;
        const S* row = hits.rows[i].value;
        const Ray<S> ray{columns(row, Row::kOrigin), columns(row, Row::kDirection), row[Row::kTime]};
        const SpreadRay<Boxes> spread(ray, inverse_of_scale<S>(columns(row, Row::kScale)),
                                      static_cast<std::int32_t>(bits_of<S>(row[Row::kLeaving])));
        if constexpr (kIsShadow) {
            Occlusion<S> light{hits.distance[i], hits.primitive_id[i]};
            rays_.template walk_from<features, Boxes>(child, tree_, spread, light, work_);
            if (light.is_hidden) hits.hide(i);
        } else {
            Hit<S> hit{hits.distance[i], hits.primitive_id[i]};
            rays_.template walk_from<features, Boxes>(child, tree_, spread, hit, work_);
            hits.set(i, hit.t, static_cast<std::int32_t>(hit.primitive_id));
        }
        rays_.is_walked(offset);
    }

    const Tree& tree_;
    const Rays rays_;
    const StreamLists<S>& lists_;
    Intersection intersection_;
    Work& work_;
};

/// Takes the first `count` rays of `hits` down a tree. `lists` are for as many.
template <Features features, class Real, class Tree, class Hits, class Work>
void walk_stream(const Tree& tree, const Hits& hits, std::size_t count, const StreamLists<ScalarOf<Real>>& lists,
                 Intersection intersection, Work& work) {
    if (tree.nodes.empty() || count == 0) return;
    using S = ScalarOf<Real>;
    std::uint32_t* list = lists.data();
    for (std::size_t i = 0; i < count; ++i) list[i] = static_cast<std::uint32_t>(i * RayRow<S>::kColumns);
    StreamWalk<features, Real, Tree, StandingRays<Hits, S>, Work>(tree, {hits}, lists, intersection, work)
        .visit(0, list, count, list + count + kLanes<Real>);
}

}  // namespace detail

}  // namespace raypool::wavefront
