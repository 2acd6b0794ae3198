/// Searches for hits, to be timed on the same rays: those of our engines, and Embree's with triangles of its own.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/studies/recorded_rays.h"

#ifdef RAYPOOL_HAS_EMBREE
#include "bench/peers/embree_scene.h"
#endif

namespace raypool::studies {

/// What rays met.
struct RayAnswers {
    std::vector<float> distance;             ///< not used of shadow rays
    std::vector<std::int32_t> primitive_id;  ///< of shadow rays: 1 where anything lies before the light, else 0

    explicit RayAnswers(std::size_t count) : distance(count), primitive_id(count) {}
};

/// Traces all of the rays in the calling thread. The answers are of as many.
using RaySearch = std::function<void(const RecordedRays& rays, RayAnswers& answers)>;

struct NamedSearch {
    std::string name;
    bool is_ours;          ///< then all its answers are those of our single rays, to the bit
    bool has_shadow_rays;  ///< or else it only finds closest hits
    std::function<RaySearch(const CompiledScene<float>& scene)> make;  ///< the scene outlives what is made
};

inline constexpr const char* kSingleRays = "single rays";

/// Those of kSingleRays. The view outlives what is made, and may have other trees than its scene.
RaySearch single_rays(const SceneView<float>& scene);

/// The first is kSingleRays. Streams are as long as the capacities say; of registers there is one kind, the widest.
std::vector<NamedSearch> named_searches(const std::vector<std::size_t>& stream_capacities);

#ifdef RAYPOOL_HAS_EMBREE
/// The scene with triangles of Embree's own, for its single rays.
std::shared_ptr<const peers::EmbreeScene> embree_scene(const CompiledScene<float>& scene,
                                                       const peers::EmbreeBuild& build);
RaySearch embree_single_rays(const CompiledScene<float>& scene, std::shared_ptr<const peers::EmbreeScene> embree);
#endif

}  // namespace raypool::studies
