/// The ray record: what a path is between two segments.
///
/// The fields are listed once, in for_each_field(): what engines with pools store derives from that list. What a scene
/// does not need is not stored.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/math/path.h"
#include "core/math/vec.h"
#include "core/scene/features.h"

namespace raypool {

/// One record, or a register of them, a lane each.
template <class Real>
struct RayRecord {
    Ray<Real> ray;
    Vec3<Real> throughput;
    PathKey<Real> key;
    Uint32<Real> leaving_id;  ///< what the ray starts on (RayStart::leaving_id); kNoPrimitive as an unsigned number
    Uint32<Real> step;        ///< path_step: hits so far, and the branch
    Real density;             ///< of the direction, where lights were sampled too; else 0
};

/// The one list of fields.
template <Features features, class Record, class Visit>
RAYPOOL_INLINE void for_each_field(Record& record, Visit visit) {
    for (int i = 0; i < 3; ++i) visit(record.ray.origin[i]);
    for (int i = 0; i < 3; ++i) visit(record.ray.direction[i]);
    if constexpr (features.motion) visit(record.ray.time);
    for (int i = 0; i < 3; ++i) visit(record.throughput[i]);
    visit(record.key.pixel);
    visit(record.key.sample);
    visit(record.leaving_id);
    visit(record.step);
    if constexpr (features.lights) visit(record.density);
}

template <Features features, class Scalar>
constexpr std::size_t record_bytes() {
    std::size_t bytes = 0;
    RayRecord<Scalar> record{};
    for_each_field<features>(record, [&](const auto& field) { bytes += sizeof(field); });
    return bytes;
}

}  // namespace raypool
