/// A ray against a sphere in 128-bit arithmetic: what single and double precision are judged by.
#pragma once

#include <cmath>

#include "core/math/vec.h"

namespace raypool::test {

#if __LDBL_MANT_DIG__ == 113  // on ARM
using Float128 = long double;
#else
__extension__ using Float128 = __float128;
#endif

inline Float128 square_root(Float128 x) {
    if (x <= 0) return 0;
    Float128 root = std::sqrt(static_cast<long double>(x));
    for (int i = 0; i < 2; ++i) root = (root + x / root) / 2;
    return root;
}

struct ExactVec {
    Float128 x, y, z;

    template <class Scalar>
    static ExactVec of(const Vec3<Scalar>& v) {
        return {v[0], v[1], v[2]};
    }
    friend ExactVec operator-(const ExactVec& a, const ExactVec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend ExactVec operator+(const ExactVec& a, const ExactVec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend ExactVec operator*(Float128 s, const ExactVec& v) { return {s * v.x, s * v.y, s * v.z}; }
    friend Float128 dot(const ExactVec& a, const ExactVec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    [[nodiscard]] Float128 norm() const { return square_root(dot(*this, *this)); }
};

/// The line of a ray and a sphere, for the numbers as they are stored: the direction need not be of length one.
struct ExactSphere {
    Float128 impact = 0;  ///< distance of the line from the centre over the radius; below one it meets the sphere
    Float128 first = 0;   ///< parameters of the two points, where they meet
    Float128 second = 0;

    template <class Scalar>
    ExactSphere(const Vec3<Scalar>& origin, const Vec3<Scalar>& direction, const Vec3<Scalar>& center, Scalar radius) {
        const ExactVec d = ExactVec::of<Scalar>(direction);
        const ExactVec f = ExactVec::of<Scalar>(origin) - ExactVec::of<Scalar>(center);
        const Float128 dd = dot(d, d);
        const Float128 b = -dot(f, d) / dd;
        const ExactVec closest = f + b * d;
        const Float128 rr = Float128{radius} * radius;
        const Float128 discriminant = rr - dot(closest, closest);
        impact = closest.norm() / radius;
        if (!is_met()) return;
        const Float128 half = square_root(discriminant / dd);
        first = b - half;
        second = b + half;
    }
    [[nodiscard]] bool is_met() const { return impact <= 1; }
};

}  // namespace raypool::test
