/// Boxes of a tree and of its shapes, for any number of rays: what block_tests.h and wide_rays.h share.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/geometry/instances.h"
#include "core/geometry/shape_tables.h"
#include "core/geometry/shapes.h"
#include "core/geometry/triangles.h"
#include "core/scene/features.h"

namespace raypool {

/// A ray or rays as the shapes of a block take them: with the shear that triangles need.
template <class Rays, class Real>
struct Sheared : Rays {
    RayShear<Real> shear;
};
template <class Block>
concept IsTriangles = requires(Block block) {
    block.vertex;
};

/// Where rays are between the near and far sides of boxes.
template <class Real, class Rays>
RAYPOOL_INLINE Interval<Real> ray_interval(const Vec3<Real>& near, const Vec3<Real>& far, const Rays& rays,
                                           const Real& limit) {
    if constexpr (requires { rays.near_origin; }) {
        return box_interval<Real>(near, far, rays.near_origin, rays.far_origin, rays.inverse, limit);
    } else {
        return box_interval<Real>(near, far, rays.origin, rays.inverse, limit);
    }
}

/// Whether a primitive's box is in a tree and so limits its hits.
enum class InBox : bool { No, Yes };

namespace detail {

template <class Real>
RAYPOOL_INLINE Real load(const ScalarOf<Real>* from) {
    return load_aligned<Real>(from);
}
template <class Real>
RAYPOOL_INLINE Vec3<Real> load(const ScalarOf<Real> (&from)[3][kLanes<Real>]) {
    return vec3<Real>(load<Real>(from[0]), load<Real>(from[1]), load<Real>(from[2]));
}

/// The bounds of children of nodes at the time of a ray: of side 0 the lower, of side 1 the upper.
template <Features features, class Tree>
class TreeBounds {
  public:
    RAYPOOL_INLINE explicit TreeBounds(const Tree& tree) : nodes_(tree.nodes.data()) {
        if constexpr (kCanMove) {
            for (int axis = 0; axis < 3; ++axis)
                motion_[axis] = tree.motion[axis].empty() ? nullptr : tree.motion[axis].data();
        }
    }
    /// Of all children of a node, along an axis on which the ray's direction has this sign.
    template <class Boxes>
    RAYPOOL_INLINE void children(std::size_t node, int axis, int sign, const Boxes& time, Boxes& near,
                                 Boxes& far) const {
        if constexpr (kCanMove) {
            if (motion_[axis] != nullptr) {
                const auto& motion = motion_[axis][node];
                near = mad<Boxes>(time, load<Boxes>(motion.change[sign]), load<Boxes>(motion.start[sign]));
                far = mad<Boxes>(time, load<Boxes>(motion.change[1 - sign]), load<Boxes>(motion.start[1 - sign]));
                return;
            }
        }
        near = load<Boxes>(nodes_[node].bounds[axis][sign]);
        far = load<Boxes>(nodes_[node].bounds[axis][1 - sign]);
    }
    /// Of one, for a register of rays.
    template <class Real>
    RAYPOOL_INLINE Real child(std::size_t node, int lane, int axis, int side, const Real& time) const {
        if constexpr (kCanMove) {
            if (motion_[axis] != nullptr) {
                const auto& motion = motion_[axis][node];
                return mad<Real>(time, Real(motion.change[side][lane]), Real(motion.start[side][lane]));
            }
        }
        return Real(nodes_[node].bounds[axis][side][lane]);
    }

  private:
    using Block = typename decltype(Tree::blocks)::value_type;
    using Motion = typename std::remove_cvref_t<decltype(Tree::motion[0])>::value_type;
    static constexpr bool kCanMove = features.motion && requires(Block block) { block.motion; };

    const typename decltype(Tree::nodes)::value_type* nodes_;
    const Motion* motion_[3];  ///< null along an axis on which nothing moves
};

/// Of a triangle met at t: whether the ray is there inside its own box, and so in those of the trees above it.
template <class Real, class Rays>
RAYPOOL_INLINE Mask<Real> is_inside_triangle_box(const std::array<Vec3<Real>, 3>& vertex, const Vec3<Real>& origin,
                                                 const Rays& rays, const Real& t) {
    Vec3<Real> low;
    Vec3<Real> high;
    triangle_box<Real>(vertex, low, high);
    return is_inside_box<Real>(low, high, origin, rays.inverse, t);
}
/// The same of an instance's, whose vertices are those of its object.
template <class Real>
RAYPOOL_INLINE Mask<Real> is_inside_object_box(const std::array<Vec3<Real>, 3>& vertex, const ObjectRay<Real>& ray,
                                               const Real& t) {
    Vec3<Real> low;
    Vec3<Real> high;
    triangle_box<Real>(vertex, low, high);
    return is_inside_box<Real>(low, high, ray.near_origin, ray.far_origin, ray.inverse, t);
}

}  // namespace detail

}  // namespace raypool
