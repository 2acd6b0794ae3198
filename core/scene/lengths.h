/// Positions and directions in a scene file, within the limits that keep float arithmetic well.
///
/// Called by what parses scenes alone.
#pragma once

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/scene/json_cursor.h"

namespace raypool {

/// Lengths within these limits can be squared, and three of them multiplied, within the range of float.
inline constexpr double kMaxLength = 1e12;
inline constexpr double kMinLength = 1e-12;

inline bool are_parallel(const Vector3d& a, const Vector3d& b) {
    constexpr double kMinSine = 1e-6;
    return a.normalized().cross(b.normalized()).norm() < kMinSine;
}

inline Vector3d position(const JsonCursor& place) {
    return place.vector3(-kMaxLength, kMaxLength);
}

inline Vector3d direction(const JsonCursor& place) {
    Vector3d value = position(place);
    if (value.norm() < kMinLength) place.refuse("not be a zero vector", fmt::format("a length of {:g}", value.norm()));
    return value;
}

}  // namespace raypool
