/// Ray against box as books have it. The box test of the engines is box_interval() (core/geometry/shapes.h).
#pragma once

#include <algorithm>
#include <cmath>

#include "core/geometry/shapes.h"

namespace raypool::naive {

/// Each tells whether a ray meets the closed box [low, high]; a component of the direction may be zero.
/// "Ray Tracing: The Next Week", chapter 3.5: an interval of length zero is a miss, so flat boxes and rays within a
/// face vanish; comparisons see NaN where a ray runs in a face.
template <class Scalar>
bool book_box(const Vec3<Scalar>& low, const Vec3<Scalar>& high, const Vec3<Scalar>& origin,
              const Vec3<Scalar>& direction) {
    Scalar enter = 0;
    Scalar exit = kInfinity<Scalar>;
    for (int i = 0; i < 3; ++i) {
        const Scalar inverse = 1 / direction[i];
        Scalar t0 = (low[i] - origin[i]) * inverse;
        Scalar t1 = (high[i] - origin[i]) * inverse;
        if (inverse < 0) std::swap(t0, t1);
        enter = t0 > enter ? t0 : enter;
        exit = t1 < exit ? t1 : exit;
        if (exit <= enter) return false;
    }
    return true;
}

/// Near and far by fmin and fmax, which drop a NaN and so turn "in the face" into "infinitely far".
template <class Scalar>
bool fmin_box(const Vec3<Scalar>& low, const Vec3<Scalar>& high, const Vec3<Scalar>& origin,
              const Vec3<Scalar>& direction) {
    Scalar enter = 0;
    Scalar exit = kInfinity<Scalar>;
    for (int i = 0; i < 3; ++i) {
        const Scalar inverse = 1 / direction[i];
        const Scalar t0 = (low[i] - origin[i]) * inverse;
        const Scalar t1 = (high[i] - origin[i]) * inverse;
        enter = std::fmax(enter, std::fmin(t0, t1));
        exit = std::fmin(exit, std::fmax(t0, t1));
    }
    return enter <= exit;
}

/// No division by zero: a small number in its place, which moves rays that run beside or in a face.
template <class Scalar>
bool clamped_box(const Vec3<Scalar>& low, const Vec3<Scalar>& high, const Vec3<Scalar>& origin,
                 const Vec3<Scalar>& direction) {
    Scalar enter = 0;
    Scalar exit = kInfinity<Scalar>;
    for (int i = 0; i < 3; ++i) {
        const Scalar d = std::abs(direction[i]) < Scalar(1e-8) ? Scalar(1e-8) : direction[i];
        const Scalar t0 = (low[i] - origin[i]) / d;
        const Scalar t1 = (high[i] - origin[i]) / d;
        enter = std::max(enter, std::min(t0, t1));
        exit = std::min(exit, std::max(t0, t1));
        if (exit <= enter) return false;
    }
    return true;
}

/// Near and far by the sign of the direction, as ours, but without slack for rounding.
template <class Scalar>
bool ordered_box(const Vec3<Scalar>& low, const Vec3<Scalar>& high, const Vec3<Scalar>& origin,
                 const Vec3<Scalar>& direction) {
    Scalar enter = 0;
    Scalar exit = kInfinity<Scalar>;
    for (int i = 0; i < 3; ++i) {
        const Scalar inverse = 1 / direction[i];
        const bool is_negative = std::signbit(direction[i]);
        enter = max(((is_negative ? high : low)[i] - origin[i]) * inverse, enter);
        exit = min(((is_negative ? low : high)[i] - origin[i]) * inverse, exit);
    }
    return enter <= exit;
}

/// The same with bound / d - origin / d in one fused operation: the rounded origin / d moves each plane.
template <class Scalar>
bool fused_box(const Vec3<Scalar>& low, const Vec3<Scalar>& high, const Vec3<Scalar>& origin,
               const Vec3<Scalar>& direction) {
    Scalar enter = 0;
    Scalar exit = kInfinity<Scalar>;
    for (int i = 0; i < 3; ++i) {
        const Scalar inverse = 1 / direction[i];
        const Scalar shift = -(origin[i] * inverse);
        const bool is_negative = std::signbit(direction[i]);
        enter = max(std::fma((is_negative ? high : low)[i], inverse, shift), enter);
        exit = min(std::fma((is_negative ? low : high)[i], inverse, shift), exit);
    }
    return enter <= exit;
}

}  // namespace raypool::naive
