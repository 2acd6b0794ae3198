/// A generated scene with the rays of its render and what each meets, so that searches are timed and their answers
/// checked.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/studies/renders.h"
#include "bench/studies/traversal_searches.h"

namespace raypool::studies {

/// Rays, and what single rays of ours meet over the scene's own trees.
struct TracedRays {
    RecordedRays rays;
    RayAnswers answers;
};

struct TracedScene {
    std::shared_ptr<const StudyScene> scene;
    std::vector<TracedRays> kinds;  ///< as in kRayKinds

    /// Throws std::runtime_error where its render has no rays of a kind.
    TracedScene(const std::string& kind, std::int64_t triangles, std::int64_t width, const RenderSettings& settings);
};

/// Made when it is wanted.
using LazyTracedScene = std::shared_ptr<Lazy<TracedScene>>;

/// Calls visit(kind, triangles, scene) for each kind and size, but for the largest sizes of all kinds but the first:
/// all scenes are kept until the end, with the trees of them, which are gigabytes at ten million triangles.
void for_each_traced_scene(const std::vector<std::string>& kinds, const std::vector<std::int64_t>& sizes,
                           std::int64_t width, const RenderSettings& settings,
                           const std::function<void(const std::string&, std::int64_t, const LazyTracedScene&)>& visit);

/// What a search took, and answers that are not the expected ones.
struct TimedSearch {
    double seconds = 0;
    std::int64_t others = 0;
    std::int64_t far_apart = 0;  ///< of these, of closest hits: at distances that do not agree to 1/10,000

    [[nodiscard]] double mrays_per_s(const TracedRays& traced) const {
        return 1e-6 * static_cast<double>(traced.rays.count) / seconds;
    }
};

/// Traces the rays once. Throws std::runtime_error, naming `who`, where answers of ours are others by a bit, or more
/// than one in a thousand of Embree's are at another distance.
TimedSearch time_search(const RaySearch& search, const TracedRays& traced, bool is_ours, const std::string& who);

}  // namespace raypool::studies
