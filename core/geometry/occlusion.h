/// Whether anything lies between a point and a light: what walks of shadow rays look for.
#pragma once

#include <cstdint>

#include "core/math/vec.h"

namespace raypool {

/// Whether a light is hidden: by another shape that closest_hit() would prefer to a hit on it at distance t.
template <class Scalar>
struct Occlusion {
    Scalar t;               ///< of the light; infinity of what is behind all shapes
    std::int32_t light_id;  ///< kNoPrimitive of what is no shape
    bool is_hidden = false;

    [[nodiscard]] RAYPOOL_INLINE bool hides(Scalar distance, std::int32_t id) const {
        return id != light_id && (distance < t || (distance == t && id < light_id));
    }
    RAYPOOL_INLINE void keep_closer(Scalar distance, std::int32_t id) { is_hidden = is_hidden || hides(distance, id); }
};

template <class Scalar>
RAYPOOL_INLINE void count_ids_from(Occlusion<Scalar>& light, std::int32_t first) {
    light.light_id -= first;
}

}  // namespace raypool
