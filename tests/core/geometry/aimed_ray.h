/// Rays aimed past a sphere at a known distance from its centre: what tests of spheres and the cases of stability
/// trace.
#pragma once

#include <cmath>

#include "core/geometry/traverse.h"
#include "tests/random_inputs.h"

namespace raypool::test {

template <class Scalar>
Vec3<double> wide(const Vec3<Scalar>& v) {
    return v.template cast<double>();
}
/// Not inlined: of float(x) turned back into double, three side by side, g++ 12 makes x (with -O2 and vectors), and so
/// aims at where the rounded point is not.
template <class Scalar>
[[gnu::noinline]] Vec3<Scalar> narrow(const Vec3<double>& v) {
    return v.cast<Scalar>();
}
inline Vec3<double> perpendicular(RandomInputs& random, const Vec3<double>& n) {
    const Vec3<double> v = random.direction<double>();
    return (v - v.dot(n) * n).normalized();
}

/// A ray from `distance` away whose line passes the centre at `impact` times the radius, as nearly as Scalar can say.
template <class Scalar>
Ray<Scalar> aimed(RandomInputs& random, const Vec3<Scalar>& center, double radius, double distance, double impact) {
    const Vec3<double> away = random.direction<double>();
    const Vec3<Scalar> origin = narrow<Scalar>(wide<Scalar>(center) + distance * away);
    const double sine = impact * radius / distance;
    const Vec3<double> aside = std::sqrt(1 - sine * sine) * perpendicular(random, away) + sine * away;
    const Vec3<double> target = wide<Scalar>(center) + impact * radius * aside;
    return {origin, narrow<Scalar>((target - wide<Scalar>(origin)).normalized()), 0};
}

}  // namespace raypool::test
