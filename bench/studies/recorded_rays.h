/// The rays of a render, recorded by how far their paths have come, for searches to be timed on the same rays.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/runtime/engine.h"
#include "wavefront/ray_columns.h"

namespace raypool::studies {

/// Rays of one kind, in the order of their paths, which go pixel by pixel: that in which a pool has them.
struct RecordedRays {
    /// Of the code that renders scenes with lights.
    using Records = wavefront::RayColumns<wavefront::record_features(kEverything), float>;

    const char* kind;
    bool are_camera;
    bool are_shadow;
    std::size_t count;
    Records records;                     ///< of each, ray and leaving_id are set
    std::vector<float> light_t;          ///< of shadow rays: how far their light is, ...
    std::vector<std::int32_t> light_id;  ///< and which it is; with room for a register behind the last
};

inline constexpr std::array<const char*, 4> kRayKinds{"camera", "first bounce", "fourth bounce", "shadow"};

/// Camera rays; rays that leave the first hit of their path, and the fourth; shadow rays of first hits, by
/// LightSampling::Mis. Of the samples, seed and sampler of the settings.
std::array<RecordedRays, kRayKinds.size()> record_rays(const CompiledScene<float>& scene, RenderSettings settings);

}  // namespace raypool::studies
