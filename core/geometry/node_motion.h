/// Boxes that move with the spheres in them.
///
/// Over the whole shutter, a sphere that moves by many radii fills a box in which it mostly is not. At a time within
/// [0, 1] its lower bound is linear, and the least of linear bounds is nowhere below the line through its values at
/// both ends. So a line for each side of a box holds whatever is in it. (Woop, Afra and Benthin, "STBVH: A
/// Spatial-Temporal BVH for Efficient Multi-Segment Motion Blur", HPG 2017, call these linear bounds.)
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/shape_tables.h"

namespace raypool {

namespace detail {

/// Lower and upper bounds along an axis, at times 0 and 1.
template <class Scalar>
struct EndBounds {
    Scalar low[2] = {kInfinity<Scalar>, kInfinity<Scalar>};
    Scalar high[2] = {-kInfinity<Scalar>, -kInfinity<Scalar>};

    void extend(const EndBounds& other) {
        for (int end = 0; end < 2; ++end) {
            low[end] = std::min(low[end], other.low[end]);
            high[end] = std::max(high[end], other.high[end]);
        }
    }
    [[nodiscard]] bool is_empty() const { return low[0] > high[0]; }
    [[nodiscard]] Scalar reach() const {
        return std::max(std::max(std::abs(low[0]), std::abs(low[1])), std::max(std::abs(high[0]), std::abs(high[1])));
    }
};

template <class Scalar, int lanes>
EndBounds<Scalar> end_bounds(const SphereBlock<Scalar, lanes>& block, int axis) {
    EndBounds<Scalar> bounds;
    for (int lane = 0; lane < lanes && block.id[lane] != kNoPrimitive; ++lane) {
        const Scalar from = block.center[axis][lane];
        const Scalar to = from + block.motion[axis][lane];
        const Scalar r = block.padded_radius[lane];
        bounds.extend({{from - r, to - r}, {from + r, to + r}});
    }
    return bounds;
}

}  // namespace detail

/// The motion of a tree's nodes along an axis; empty where none of its spheres moves along it.
///
/// What a kernel makes of it holds what it makes of each sphere's own box, to the last bit. Let A be the greatest
/// coordinate of a child's bounds, u = eps / 2. A sphere's box has three roundings: of the product, at most 2 A, of the
/// sum and of the difference: 4 u A. Of the line, each end has two, the room one, the change, at most 2 A, one, and
/// mad() one: 6 u A. That is 5 eps A in all, and 16 eps A are left as room.
template <class Scalar, int width>
std::vector<NodeMotion<Scalar, width>> node_motion(const BlockTree<SphereBlock<Scalar, width>, Scalar, width>& tree,
                                                   int axis) {
    const auto is_still = [&](const auto& block) {
        return std::all_of(block.motion[axis], block.motion[axis] + width, [](Scalar m) { return m == 0; });
    };
    if (std::all_of(tree.blocks.begin(), tree.blocks.end(), is_still)) return {};

    std::vector<NodeMotion<Scalar, width>> motion(tree.nodes.size());
    std::vector<detail::EndBounds<Scalar>> bounds(tree.nodes.size());
    for (std::size_t node = tree.nodes.size(); node-- > 0;) {  // children come behind their parents
        for (int lane = 0; lane < width; ++lane) {
            detail::EndBounds<Scalar> child;
            const std::int32_t index = tree.nodes[node].child[lane];
            if (index > 0) child = bounds[static_cast<std::size_t>(index)];
            if (index < 0) child = detail::end_bounds(tree.blocks[static_cast<std::size_t>(~index)], axis);
            bounds[node].extend(child);

            const Scalar room = child.is_empty() ? 0 : 16 * std::numeric_limits<Scalar>::epsilon() * child.reach();
            const Scalar low[2] = {child.low[0] - room, child.low[1] - room};
            const Scalar high[2] = {child.high[0] + room, child.high[1] + room};
            motion[node].start[0][lane] = low[0];
            motion[node].start[1][lane] = high[0];
            motion[node].change[0][lane] = child.is_empty() ? 0 : low[1] - low[0];
            motion[node].change[1][lane] = child.is_empty() ? 0 : high[1] - high[0];
        }
    }
    return motion;
}

}  // namespace raypool
