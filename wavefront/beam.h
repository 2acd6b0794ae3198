/// A beam: some packets of camera rays as one interval, against a register of boxes or shapes at a time.
///
/// Rays through neighbouring film points differ little. An interval of origins and one of inverse directions hold all
/// of them, and what the interval misses every ray misses: so sixty-four rays cost one box test. After Reshetov,
/// Soupikov and Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005, with a tree in place of their entry points.
#pragma once

#include <bit>

#include "wavefront/packet.h"

namespace raypool::wavefront {

/// Rays of a beam.
inline constexpr int kBeamRays = 64;
template <class Real>
inline constexpr int kBeamPackets = kBeamRays / kLanes<Real>;

namespace detail {

/// Holds rays whose directions have, on each axis, one sign and no zero; is_coherent says whether they do.
///
/// Its distances bound those of box_interval() for each ray, to the last bit: the operations are the same, and rounding
/// is monotonic in every operand. So it needs no slack of its own.
template <class Boxes>
class Beam {
    using S = ScalarOf<Boxes>;

  public:
    template <class Real>
    RAYPOOL_INLINE Beam(const WideRays<Real>* rays, int packets) {
        for (int i = 0; i < 3; ++i) {
            Range<Real> origin(rays[0].ray.origin[i]);
            Range<Real> near(rays[0].inverse.near_scale[i]);
            Range<Real> far(rays[0].inverse.far_scale[i]);
            for (int p = 1; p < packets; ++p) {
                origin.extend(rays[p].ray.origin[i]);
                near.extend(rays[p].inverse.near_scale[i]);
                far.extend(rays[p].inverse.far_scale[i]);
            }
            const S origin_low = origin.least();
            const S origin_high = origin.greatest();
            const S near_low = near.least();
            const S near_high = near.greatest();
            const S far_low = far.least();
            const S far_high = far.greatest();
            sign_[i] = near_low < 0 ? 1 : 0;
            is_coherent_ =
                is_coherent_ && (near_low > 0 || near_high < 0) && far_low > -kInfinity<S> && far_high < kInfinity<S>;
            reach_ += max(abs(origin_low), abs(origin_high));
            near_origin_[i] = Boxes(sign_[i] == 0 ? origin_high : origin_low);
            far_origin_[i] = Boxes(sign_[i] == 0 ? origin_low : origin_high);
            near_scale_[i][0] = Boxes(near_low);
            near_scale_[i][1] = Boxes(near_high);
            far_scale_[i][0] = Boxes(far_low);
            far_scale_[i][1] = Boxes(far_high);
        }
    }

    [[nodiscard]] bool is_coherent() const { return is_coherent_; }

    /// Where the first of the rays enters and the last leaves boxes [low, high], before `limit`.
    RAYPOOL_INLINE Interval<Boxes> interval(const S (&low)[3][kLanes<Boxes>], const S (&high)[3][kLanes<Boxes>],
                                            S limit) const {
        return interval(raypool::detail::load<Boxes>(low), raypool::detail::load<Boxes>(high), limit);
    }
    template <class Node>
    RAYPOOL_INLINE Interval<Boxes> interval(const Node& node, S limit) const {
        Vec3<Boxes> low;
        Vec3<Boxes> high;
        for (int i = 0; i < 3; ++i) {
            low[i] = raypool::detail::load<Boxes>(node.bounds[i][0]);
            high[i] = raypool::detail::load<Boxes>(node.bounds[i][1]);
        }
        return interval(low, high, limit);
    }

    /// The shapes of a block of a tree whose own boxes a ray may enter before `limit`: a bit each.
    template <Features features, class Block>
    RAYPOOL_INLINE unsigned may_meet(const Block& block, S limit) const {
        if constexpr (requires { block.radius; }) {
            return may_meet<features>(block, raypool::detail::load<Boxes>(block.padded_radius), limit);
        } else if constexpr (IsTriangles<Block>) {
            std::array<Vec3<Boxes>, 3> vertex;
            for (int i = 0; i < 3; ++i) vertex[i] = raypool::detail::load<Boxes>(block.vertex[i]);
            Vec3<Boxes> low;
            Vec3<Boxes> high;
            triangle_box<Boxes>(vertex, low, high);
            const Interval<Boxes> inside = interval(low, high, limit);
            const Mask<Boxes> is_used = vertex[0][0] < Boxes(kInfinity<Boxes>);  // of an unused lane it is a NaN
            return mask_bits(inside.enter <= inside.exit && is_used);
        } else {
            const Interval<Boxes> inside = interval(block.low, block.high, limit);
            return mask_bits(inside.enter <= inside.exit);
        }
    }
    /// The same of spheres that are in no tree, whose hits no box bounds. A hit is off the sphere by less than the pad
    /// and 4 eps of the distance from the origin (may_meet_sphere() has the analysis).
    template <Features features, class Block>
    RAYPOOL_INLINE unsigned may_meet_anywhere(const Block& block) const {
        const Boxes radius = raypool::detail::load<Boxes>(block.radius);
        const Boxes pad = raypool::detail::load<Boxes>(block.padded_radius) - radius;
        const Boxes room(32 * std::numeric_limits<S>::epsilon() * reach_);
        return may_meet<features>(block, radius + Boxes(4) * pad + room, kInfinity<S>);
    }

  private:
    template <class Real>
    struct Range {
        Real low, high;
        RAYPOOL_INLINE explicit Range(const Real& value) : low(value), high(value) {}
        RAYPOOL_INLINE void extend(const Real& value) {
            low = min(low, value);
            high = max(high, value);
        }
        [[nodiscard]] RAYPOOL_INLINE S least() const { return -greatest_lane<Real>(-low); }
        [[nodiscard]] RAYPOOL_INLINE S greatest() const { return greatest_lane<Real>(high); }
    };

    RAYPOOL_INLINE Interval<Boxes> interval(const Vec3<Boxes>& low, const Vec3<Boxes>& high, S limit) const {
        Interval<Boxes> inside{Boxes(0), Boxes(limit)};
        for (int i = 0; i < 3; ++i) {
            const Boxes& near = sign_[i] == 0 ? low[i] : high[i];
            const Boxes& far = sign_[i] == 0 ? high[i] : low[i];
            const Boxes to_near = near - near_origin_[i];
            const Boxes to_far = far - far_origin_[i];
            inside.enter = max(min(to_near * near_scale_[i][0], to_near * near_scale_[i][1]), inside.enter);
            inside.exit = min(max(to_far * far_scale_[i][0], to_far * far_scale_[i][1]), inside.exit);
        }
        return inside;
    }

    /// Spheres in boxes of this half edge, over all times. An unused lane has a NaN radius.
    template <Features features, class Block>
    RAYPOOL_INLINE unsigned may_meet(const Block& block, const Boxes& half_edge, S limit) const {
        Vec3<Boxes> low;
        Vec3<Boxes> high;
        for (int i = 0; i < 3; ++i) {
            const Boxes from = raypool::detail::load<Boxes>(block.center[i]);
            low[i] = high[i] = from;
            if constexpr (features.motion) {
                const Boxes to = from + raypool::detail::load<Boxes>(block.motion[i]);
                low[i] = min(from, to);
                high[i] = max(from, to);
            }
            low[i] = low[i] - half_edge;
            high[i] = high[i] + half_edge;
        }
        const Interval<Boxes> inside = interval(low, high, limit);
        const Mask<Boxes> is_used = raypool::detail::load<Boxes>(block.radius) > Boxes(0);
        return mask_bits(inside.enter <= inside.exit && is_used);
    }

    Boxes near_origin_[3], far_origin_[3];
    Boxes near_scale_[3][2], far_scale_[3][2];
    S reach_ = 0;  ///< of origins: |x| + |y| + |z|
    int sign_[3];  ///< of directions: 1 where negative
    bool is_coherent_ = true;
};

template <Features features, class Real, class Tree, class Work>
RAYPOOL_INLINE void walk_beam(const Tree& tree, const Beam<Wide<ScalarOf<Real>, kTreeWidth<ScalarOf<Real>>>>& beam,
                              const WideRays<Real>* rays, Hit<Real>* hit, int packets, int count, Work& work) {
    if (tree.nodes.empty()) return;
    using S = ScalarOf<Real>;
    constexpr int kWidth = kTreeWidth<S>;
    const auto farthest = [&] {
        Real t = hit[0].t;
        for (int p = 1; p < packets; ++p) t = max(t, hit[p].t);
        return greatest_lane<Real>(t);
    };
    struct Entry {
        S enter;
        std::int32_t child;
    };
    Entry stack[kTraversalStack<kWidth>];
    Entry* top = stack;
    std::int32_t child = 0;
    const auto ready = [&] {
        if constexpr (IsTriangles<typename Tree::Block> || IsInstance<typename Tree::Block>) {
            std::array<Sheared<WideRays<Real>, Real>, kBeamPackets<Real>> all;
            for (int p = 0; p < packets; ++p) all[p] = ready_for<typename Tree::Block, Real>(rays[p]);
            return all;
        } else {
            return rays;
        }
    }();
    S limit = farthest();
    for (;;) {
        if (child >= 0) {
            const auto& node = tree.nodes[static_cast<std::size_t>(child)];
            work.count(node);
            const auto inside = beam.interval(node, limit);
            alignas(64) S enter[kWidth];
            inside.enter.copy_to(enter, stdx::vector_aligned);
            Entry* const bottom = top;
            for (unsigned bits = mask_bits(inside.enter <= inside.exit); bits != 0; bits &= bits - 1) {
                const int i = std::countr_zero(bits);
                Entry* place = top++;
                for (; place != bottom && place[-1].enter < enter[i]; --place) *place = place[-1];
                *place = {enter[i], node.child[i]};
            }
        } else {
            const auto& block = tree.blocks[static_cast<std::size_t>(~child)];
            bool is_improved = false;
            if constexpr (IsInstance<typename Tree::Block>) {  // whose space the beam is not in
                for (int p = 0; p < packets; ++p)
                    meet_instance<features, Real>(tree.objects, block, ready[p],
                                                  lanes_before<Real>(static_cast<std::size_t>(
                                                      std::clamp(count - p * kLanes<Real>, 0, kLanes<Real>))),
                                                  hit[p], work);
                is_improved = true;
            } else {
                for (unsigned bits = beam.template may_meet<features>(block, limit); bits != 0; bits &= bits - 1) {
                    const int i = std::countr_zero(bits);
                    work.count_primitives(count);
                    for (int p = 0; p < packets; ++p)
                        is_improved |= any(intersect_lane<features, InBox::Yes, Real>(block, i, ready[p], hit[p]));
                }
            }
            if (is_improved) limit = farthest();
        }
        do {
            if (top == stack) return;
            --top;
        } while (top->enter > limit);
        child = top->child;
    }
}

}  // namespace detail

/// The closest hits of packets of camera rays, which start on nothing. Every lane holds a ray, `count` of them are
/// wanted; rays that no beam holds go packet by packet.
template <Features features, Simd Real, class Work>
RAYPOOL_INLINE void closest_hits(const ShapeView<ScalarOf<Real>>& scene, const WideRays<Real>* rays, Hit<Real>* hit,
                                 int packets, int count, Work& work) {
    using S = ScalarOf<Real>;
    const detail::Beam<Wide<S, kTreeWidth<S>>> beam(rays, packets);
    if (!beam.is_coherent()) {
        for (int p = 0; p < packets; ++p)
            hit[p] = closest_hits<features, Real>(
                scene, rays[p], lanes_before<Real>(static_cast<std::size_t>(count - p * kLanes<Real>)), work);
        return;
    }
    for (const auto& block : scene.large_spheres) {
        for (unsigned bits = beam.template may_meet_anywhere<features>(block); bits != 0; bits &= bits - 1) {
            work.count_primitives(count);
            for (int p = 0; p < packets; ++p)
                intersect_lane<features, InBox::No, Real>(block, std::countr_zero(bits), rays[p], hit[p]);
        }
    }
    if constexpr (features.planar) {
        for (int p = 0; p < packets; ++p)
            intersect_all<features>(scene.planes, rays[p], std::min(count - p * kLanes<Real>, kLanes<Real>), hit[p],
                                    work);
        detail::walk_beam<features, Real>(scene.quad_tree, beam, rays, hit, packets, count, work);
    }
    if constexpr (features.triangles) {
        detail::walk_beam<features, Real>(scene.triangle_tree, beam, rays, hit, packets, count, work);
        detail::walk_beam<features, Real>(scene.instance_tree, beam, rays, hit, packets, count, work);
    }
    detail::walk_beam<features, Real>(scene.sphere_tree, beam, rays, hit, packets, count, work);
}

}  // namespace raypool::wavefront
