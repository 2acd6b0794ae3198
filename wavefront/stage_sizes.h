/// How much the stages of a thread hold between them: all of it is reserved when a session is made.
#pragma once

#include <algorithm>
#include <cstddef>

#include "wavefront/beam.h"
#include "wavefront/record_stages.h"
#include "wavefront/stream.h"

namespace raypool::wavefront {

struct StageSizes {
    /// Kept back in the fused camera stage; they fit into the first-level cache.
    static constexpr std::size_t kKeptContributions = 1024;

    std::size_t overflow;  ///< records that splitting adds
    std::size_t shadow_rays;
    std::size_t contributions;
    std::size_t list;  ///< rays of the longest stream
    StreamTrees trees;
};

/// For batches of at most `most_records`, of stages compiled for `features`.
template <Features features, class Real>
StageSizes stage_sizes(const RenderContext<ScalarOf<Real>>& context, std::size_t most_records) {
    const SceneView<ScalarOf<Real>>& scene = context.scene;
    StageSizes size{.overflow = 0, .shadow_rays = 0, .contributions = 0, .list = 0, .trees = StreamTrees(scene)};
    if (context.settings.split_depth > 0) size.overflow = most_records;
    if (features.lights && needed_features(scene.features, context.settings).lights)
        size.shadow_rays = std::min(most_records + kLanes<Real>, RayStream<ScalarOf<Real>>::kMostRays);
    size.contributions =
        std::max(most_records, StageSizes::kKeptContributions) + kBeamRays + kLanes<Real> + size.shadow_rays;
    size.list = std::max(most_records, size.shadow_rays);
    return size;
}

}  // namespace raypool::wavefront
