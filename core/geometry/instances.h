/// Instances: meshes that stand at many places and are in memory once.
///
/// A tree over the boxes of instances is above the trees of objects. A ray meets the boxes of an object in the object's
/// own space, where it is known but for rounding: boxes are tested with room for that. Triangles are met where they
/// stand: a test of some of them places their vertices, by the operations that shading places them by. So a hit is to
/// the last bit that on a mesh whose vertices were placed so beforehand, and needs no other bounds of error.
///
/// A hit on an instance counts where the ray is inside the triangle's own box as it stands (shapes.h), and inside its
/// own box in the object's space. The second follows from the first where the transform turns nothing, and is what
/// makes hits of all instances independent of the order in which trees are walked. Directions are not made unit in an
/// object's space, so that distances are the same in both.
#pragma once

#include "core/geometry/shapes.h"
#include "core/math/vec.h"

namespace raypool {

/// p -> matrix p + offset, with the matrix by rows. The identity and exact products and sums leave no rounding.
template <class Real>
struct Placing {
    Vec3<Real> row[3];
    Vec3<Real> offset;

    /// Of 12 scalars or registers: a row of the matrix and its part of the offset after another.
    template <class Value>
    RAYPOOL_INLINE static Placing of(const Value* value) {
        Placing placing;
        for (int i = 0; i < 3; ++i) {
            placing.row[i] = vec3<Real>(Real(value[4 * i]), Real(value[4 * i + 1]), Real(value[4 * i + 2]));
            placing.offset[i] = Real(value[4 * i + 3]);
        }
        return placing;
    }
    [[nodiscard]] RAYPOOL_INLINE Vec3<Real> point(const Vec3<Real>& p) const {
        const auto at = [&](int i) {
            return mad<Real>(row[i][0], p[0], mad<Real>(row[i][1], p[1], mad<Real>(row[i][2], p[2], offset[i])));
        };
        return vec3<Real>(at(0), at(1), at(2));
    }
    [[nodiscard]] RAYPOOL_INLINE std::array<Vec3<Real>, 3> points(const std::array<Vec3<Real>, 3>& p) const {
        return {point(p[0]), point(p[1]), point(p[2])};
    }
    [[nodiscard]] RAYPOOL_INLINE Vec3<Real> direction(const Vec3<Real>& d) const {
        return vec3<Real>(dot<Real>(row[0], d), dot<Real>(row[1], d), dot<Real>(row[2], d));
    }
    /// Of unit normals; of a transform that mirrors it is on the other side. What scales all axes alike keeps the bits.
    [[nodiscard]] RAYPOOL_INLINE Vec3<Real> normal(const Vec3<Real>& n) const {
        const auto column = [&](int i) { return vec3<Real>(row[0][i], row[1][i], row[2][i]); };
        const Vec3<Real> x = cross<Real>(column(1), column(2));
        const Vec3<Real> y = cross<Real>(column(2), column(0));
        const Vec3<Real> z = cross<Real>(column(0), column(1));
        const Vec3<Real> sum =
            along<Real>(along<Real>(vec3<Real>(n[2] * z[0], n[2] * z[1], n[2] * z[2]), n[1], y), n[0], x);
        const Real scale = Real(1) / max(max(abs(sum[0]), abs(sum[1])), abs(sum[2]));  // of any size, squared later
        const Vec3<Real> turned = unit<Real>(vec3<Real>(sum[0] * scale, sum[1] * scale, sum[2] * scale));
        const Real zero(0);
        Mask<Real> is_turned = row[0][0] != row[1][1] || row[0][0] != row[2][2];
        for (int i = 0; i < 3; ++i) is_turned = is_turned || row[i][(i + 1) % 3] != zero || row[i][(i + 2) % 3] != zero;
        return select<Real>(is_turned, turned, n);
    }
};

/// What kernels read of an instance. Its triangles have the ids from `first id` on, in the order of the object's.
template <class Scalar>
struct alignas(64) InstanceRow {
    enum Column {
        kInverse = 0,         ///< 12, of a Placing: from where the instance stands to the object's space
        kReach = 12,          ///< 4, of ObjectRay's room
        kTransform = 16,      ///< 12, of a Placing: to where it stands
        kFirstId = 28,        ///< the bits of whole numbers, as the rest
        kRoot = 29,           ///< of the object's tree: a node, or ~block
        kFirstTriangle = 30,  ///< the row of the object's first triangle
        kSurface = 31,        ///< the row of its material among the surfaces
        kColumns = 32
    };
    Scalar value[kColumns];

    [[nodiscard]] RAYPOOL_INLINE std::int32_t number(Column column) const {
        return static_cast<std::int32_t>(bits_of<Scalar>(value[column]));
    }
};
template <class Block>
concept IsInstance = requires {
    Block::kReach;
};

/// Rays in an object's space, as boxes see them.
///
/// Why no box is missed that a ray enters. Let T be the inverse as stored, o the ray's origin and p a point of the ray
/// in the box of the instance, no coordinate of which is beyond B. A coordinate has four terms, rounded at most four
/// times, and t |d| is at most |p| + |o|: so a point of the ray is off, along an axis of the object's space, by less
/// than 5 eps (|T| (2 |o| + |p|) + |offset|). To this come the room of a triangle's box as it stands, 8 eps of its
/// coordinates, and the rounding of its vertices, 2 eps of them: less than 10 eps (|T| B + |offset|). The room is twice
/// the sum and more, with the greatest of each column of |T|; and it has in it by how much, at most, T takes a vertex
/// that stands elsewhere than to where it was.
template <class Real>
struct ObjectRay {
    Vec3<Real> near_origin;  ///< moved by the room along the direction, and ...
    Vec3<Real> far_origin;   ///< ... against it
    Vec3<Real> scale;        ///< 1 / direction
    RayInverse<Real> inverse;

    /// A register of rays to one instance, or each of them a broadcast.
    RAYPOOL_INLINE static ObjectRay of(const InstanceRow<ScalarOf<Real>>& instance, const Vec3<Real>& origin,
                                       const Vec3<Real>& direction) {
        using Row = InstanceRow<ScalarOf<Real>>;
        const auto inverse = Placing<Real>::of(instance.value + Row::kInverse);
        const Vec3<Real> from = inverse.point(origin);
        const Vec3<Real> along = inverse.direction(direction);
        const auto reach = [&](int i) { return Real(instance.value[Row::kReach + i]); };
        const Real room = mad<Real>(reach(0), abs(origin[0]),
                                    mad<Real>(reach(1), abs(origin[1]), mad<Real>(reach(2), abs(origin[2]), reach(3))));
        ObjectRay ray;
        for (int i = 0; i < 3; ++i) {
            ray.scale[i] = Real(1) / along[i];
            const Real ahead = copysign(room, ray.scale[i]);
            ray.near_origin[i] = from[i] + ahead;
            ray.far_origin[i] = from[i] - ahead;
        }
        ray.inverse = inverse_of_scale<Real>(ray.scale);
        return ray;
    }
};

/// Rays as the triangles of an instance take them: where they stand, by ids that count from its first.
template <class Rays, class Real>
struct Placed : Rays {
    Placing<Real> placing;
    ObjectRay<Real> in_object;
};
template <class Rays>
concept IsPlaced = requires(Rays rays) {
    rays.placing;
};

/// Makes ids of a hit, or of what it is compared with, count from another one on.
template <class Real>
RAYPOOL_INLINE void count_ids_from(Hit<Real>& hit, std::int32_t first) {
    hit.primitive_id = hit.primitive_id - Int<Real>(first);
}

}  // namespace raypool
